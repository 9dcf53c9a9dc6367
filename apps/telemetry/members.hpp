// Members of a message as View::json gives it. An older daemon may not send all of them.
#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

namespace vdna::telemetry
{

// "" where the member is missing or no text.
inline std::string text_of(const nlohmann::ordered_json &json, const char *name)
{
    return json.contains(name) && json[name].is_string() ? json[name].get<std::string>() : "";
}

// NaN where the member is missing, null, or no number.
inline double number_of(const nlohmann::ordered_json &json, const char *name)
{
    return json.contains(name) && json[name].is_number() ? json[name].get<double>() : NAN;
}

// False where the member is missing or no truth value.
inline bool is_true(const nlohmann::ordered_json &json, const char *name)
{
    return json.contains(name) && json[name].is_boolean() && json[name].get<bool>();
}

} // namespace vdna::telemetry
