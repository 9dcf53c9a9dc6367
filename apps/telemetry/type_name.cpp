#include "telemetry/type_name.hpp"

#include <vdna_messages.h>

namespace vdna::telemetry
{

const char *type_name(uint64_t fingerprint)
{
    constexpr uint64_t images_fingerprint = 0x20ba4f05e8f5e33a;
    for (const vdna_message_type *type : vdna_message_types)
        if (type->fingerprint == fingerprint)
            return type->name;
    return fingerprint == images_fingerprint ? "bot_core.images_t" : nullptr;
}

} // namespace vdna::telemetry
