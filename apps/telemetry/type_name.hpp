// The types of messages by their fingerprints.
#pragma once

#include <cstdint>

namespace vdna::telemetry
{

// "bot_core.image_t"; nullptr for a type that is not known. Besides those of vdna_messages.h,
// libbot's message of several pictures, which is easily taken for the one of a single picture.
const char *type_name(uint64_t fingerprint);

} // namespace vdna::telemetry
