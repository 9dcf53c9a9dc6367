#include "record/candidates.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>

namespace vdna::record
{

namespace
{

void require_known(const Map &map, const std::vector<std::string> &names)
{
    std::string known;
    for (const vdna_experience &experience : map.experiences())
        known += std::string(" ") + experience.name;
    for (const std::string &name : names) {
        const auto is_it = [&](const vdna_experience &e) { return e.name == name; };
        if (std::none_of(map.experiences().begin(), map.experiences().end(), is_it))
            throw Error(name + ": no such experience in the map, expected one of:" + known);
    }
}

std::vector<size_t> pick(const Map &map, const std::vector<std::string> &names, bool named)
{
    require_known(map, names);
    std::vector<size_t> picked;
    for (size_t i = 0; i < map.experiences().size(); i++) {
        const char *name = map.experiences()[i].name;
        if ((std::find(names.begin(), names.end(), name) != names.end()) == named)
            picked.push_back(i);
    }
    return picked;
}

} // namespace

std::vector<size_t> named_in(const Map &map, const std::vector<std::string> &names)
{
    return pick(map, names, true);
}

std::vector<size_t> all_but(const Map &map, const std::vector<std::string> &names)
{
    return pick(map, names, false);
}

} // namespace vdna::record
