// The LCM network that is meant, for people.
#pragma once

#include <cstdlib>
#include <string>

#include <vdna/transport.h>

namespace vdna::telemetry
{

// By LCM's own rule: the given one, $LCM_DEFAULT_URL or LCM's default.
inline std::string network_url(const std::string &given)
{
    if (!given.empty())
        return given;
    const char *const url = std::getenv("LCM_DEFAULT_URL");
    return url && *url ? url : VDNA_LCM_URL;
}

} // namespace vdna::telemetry
