// The messages of vdna_selectord as text for people, and as JSON for programs.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <vdna/message.h>

namespace vdna::telemetry
{

// One kind of message and its views. `message` is the struct that lcm-gen declares for the type.
struct View {
    const vdna_message_type *type;
    const char *name;    // in the JSON, and of the option for its channel
    const char *channel; // default
    // One or more lines, without the final newline.
    std::string (*text)(const void *message);
    // The members by their names in lcmtypes/; invalid ones are null.
    nlohmann::ordered_json (*json)(const void *message);
};

// The position of an answer with its unit, of a localisation as View::json gives it, or else its
// place;
// "" if it has neither.
std::string position_of(const nlohmann::ordered_json &localisation);

// All messages of vdna_selectord.
const std::vector<View> &views();

// The view of a type; it must be one of views().
const View &view_of(const vdna_message_type &type);

// One JSON object on one line, without the newline: the view's members after the channel. A name
// with invalid UTF-8 has replacement characters.
std::string json_line(const View &view, const std::string &channel, const void *message);

} // namespace vdna::telemetry
