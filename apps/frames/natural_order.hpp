// The order that people expect of numbered names: 2 before 10.
#pragma once

#include <string>

namespace vdna::frames
{

// Whether `a` comes before `b`: runs of digits compare by value, of any length, and everything else
// byte by byte. Names that differ only in leading zeros compare byte by byte, so that this is a
// total order.
bool comes_before(const std::string &a, const std::string &b);

} // namespace vdna::frames
