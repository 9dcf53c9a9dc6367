// The state of vdna_selectord in one sentence for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace vdna::telemetry
{

struct Headline {
    const char *tone; // "good", "wait", "doubt" or "bad"
    std::string text;
};

// status, ranking: the newest messages as View::json gives them, null if none has come; members
// that an older daemon does not send may be missing. silent_s: since the status came, or since the
// program listens. url: of the network
Headline headline(const nlohmann::ordered_json &status, const nlohmann::ordered_json &ranking,
                  double silent_s, const std::string &url);

// No status for longer means that the daemon or the network is gone.
constexpr double silence_max_s = 3;

} // namespace vdna::telemetry
