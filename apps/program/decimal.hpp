// Numbers on command lines.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace vdna::program
{

// A finite number in decimals, as 2.5 or 1e-3, which is all of the text. Nothing for nan, inf and
// 0x1p3, which C's own conversion takes.
inline std::optional<double> decimal(const std::string &text)
{
    double value = 0;
    const char *const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value))
        return {};
    return value;
}

// What an option that is a floating-point number must be.
inline CLI::Validator within(double least, double most)
{
    const auto check = [least, most](const std::string &text) -> std::string {
        const std::optional<double> value = decimal(text);
        if (value && *value >= least && *value <= most)
            return "";
        char expected[80];
        std::snprintf(expected, sizeof expected, ", expected a number from %g to %g", least, most);
        return "found '" + text + "'" + expected;
    };
    return CLI::Validator(check, "");
}

} // namespace vdna::program
