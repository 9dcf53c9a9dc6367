// Results on standard output.
#pragma once

#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

namespace vdna::program
{

using Json = nlohmann::ordered_json;

// File names need not be UTF-8, but JSON must be: invalid bytes are replaced.
inline void print_json(const Json &json)
{
    std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

// null for NaN, which JSON does not have.
inline Json known(double number)
{
    return std::isnan(number) ? Json() : Json(number);
}

// A number with `digits` digits after the point.
inline std::string fixed(double value, int digits)
{
    char text[400]; // the longest double has 309 digits before the point
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

} // namespace vdna::program
