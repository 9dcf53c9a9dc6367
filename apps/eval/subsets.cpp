#include "eval/subsets.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace vdna::eval
{

namespace
{

// Whether there are at most `most` choices.
bool are_few(uint32_t count, uint32_t size, size_t most)
{
    double choices = 1;
    for (uint32_t i = 0; i < size; i++)
        choices *= static_cast<double>(count - i) / (i + 1);
    return choices < static_cast<double>(most) + 0.5;
}

std::vector<std::vector<uint32_t>> all_subsets(uint32_t count, uint32_t size)
{
    std::vector<bool> taken(count, false);
    std::fill_n(taken.begin(), size, true);
    std::vector<std::vector<uint32_t>> subsets;
    do {
        std::vector<uint32_t> &subset = subsets.emplace_back();
        for (uint32_t i = 0; i < count; i++)
            if (taken[i])
                subset.push_back(i);
    } while (std::prev_permutation(taken.begin(), taken.end()));
    return subsets;
}

// Its own shuffle: that of the standard library differs between its makers.
std::vector<uint32_t> drawn(uint32_t count, uint32_t size, std::mt19937 &random)
{
    std::vector<uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0);
    for (uint32_t i = 0; i < size; i++)
        std::swap(numbers[i], numbers[i + random() % (count - i)]);
    numbers.resize(size);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

} // namespace

std::vector<std::vector<uint32_t>> subsets_of(uint32_t count, uint32_t size, size_t most,
                                              std::mt19937 &random)
{
    if (are_few(count, size, most))
        return all_subsets(count, size);
    std::set<std::vector<uint32_t>> subsets;
    while (subsets.size() < most)
        subsets.insert(drawn(count, size, random));
    return {subsets.begin(), subsets.end()};
}

} // namespace vdna::eval
