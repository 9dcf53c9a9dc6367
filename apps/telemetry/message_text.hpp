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

// All messages of vdna_selectord.
const std::vector<View> &views();

} // namespace vdna::telemetry
