#include "program/notice.hpp"

#include <iostream>
#include <set>

namespace vdna::program
{

void tell_once(const std::string &sentence)
{
    static std::set<std::string> told;
    if (told.insert(sentence).second)
        std::cerr << "vdna: " << sentence << '\n';
}

} // namespace vdna::program
