// The messages of vdna_selectord as text for people, and as JSON for programs.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <vdna/message.h>

namespace vdna::telemetry
{

// One kind of message, and how it is shown. `message` is the struct that lcm-gen declares for the
// type.
struct View {
    const vdna_message_type *type;
    const char *name;    // as in the JSON, and of the option that names its channel
    const char *channel; // default
    // One line or several, without the end of the last.
    std::string (*text)(const void *message);
    // The members by their names in lcmtypes/; what is not valid is null.
    nlohmann::ordered_json (*json)(const void *message);
};

// All that vdna_selectord says.
const std::vector<View> &views();

} // namespace vdna::telemetry
