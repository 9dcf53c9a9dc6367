#include "eval/conditions.hpp"

#include <algorithm>

namespace vdna::eval
{

namespace
{

std::string without_number(const std::string &name)
{
    const size_t end = name.find_last_not_of("0123456789");
    const size_t last = end == std::string::npos || end + 1 == name.size()
                            ? end
                            : name.find_last_not_of("_- ", end);
    return last == std::string::npos ? "" : name.substr(0, last + 1);
}

} // namespace

std::vector<std::string> conditions_of(const std::vector<std::string> &names)
{
    std::vector<std::string> conditions;
    for (const std::string &name : names)
        conditions.push_back(without_number(name));
    const bool tells = std::any_of(conditions.begin(), conditions.end(),
                                   [&](const std::string &c) { return c != conditions.front(); });
    const bool each = std::find(conditions.begin(), conditions.end(), "") == conditions.end();
    return tells && each ? conditions : names;
}

} // namespace vdna::eval
