// The middle of many numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vdna::program
{

// The median, of an even number of values the upper one; 0 if there are none.
template <typename Number>
Number median_of(std::vector<Number> values)
{
    if (values.empty())
        return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace vdna::program
