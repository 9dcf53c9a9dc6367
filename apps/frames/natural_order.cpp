#include "frames/natural_order.hpp"

#include <algorithm>

namespace vdna::frames
{

namespace
{

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

// The digits from `at` on, without leading zeros; moves `at` behind them.
std::string number_at(const std::string &text, size_t &at)
{
    const size_t end =
        std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), is_digit) -
        text.begin();
    const size_t begin = std::min(text.find_first_not_of('0', at), end);
    at = end;
    return text.substr(begin, end - begin);
}

// < 0, 0 or > 0: two numbers as text, without leading zeros.
int compare_numbers(const std::string &a, const std::string &b)
{
    if (a.size() != b.size())
        return a.size() < b.size() ? -1 : 1;
    return a.compare(b);
}

int compare(const std::string &a, const std::string &b)
{
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string number = number_at(a, i);
            if (const int order = compare_numbers(number, number_at(b, j)))
                return order;
        } else if (a[i] != b[j]) {
            return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]) ? -1 : 1;
        } else {
            i++;
            j++;
        }
    }
    return (i < a.size()) - (j < b.size());
}

} // namespace

bool comes_before(const std::string &a, const std::string &b)
{
    const int order = compare(a, b);
    return order != 0 ? order < 0 : a < b;
}

} // namespace vdna::frames
