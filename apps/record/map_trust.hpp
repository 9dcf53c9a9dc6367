// The file of what a map knows about itself: making it, and saying what it says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/map_trust.h>

namespace vdna::record
{

// Within which frames show one place unless something else is said: metres or place numbers.
constexpr double trust_tolerance_default = 5;

// Make the file, or renew it: rows and columns of experiences that it knows already are kept. The
// caller has opened an update of the map, so that nobody else changes it meanwhile.
// tolerance: none = that of the file, or trust_tolerance_default. Another one than the file's makes
// all of it anew.
// Throws Error, also after Ctrl-C; the file is as it was then.
void renew_map_trust(const std::string &map, std::optional<double> tolerance = {});

// What a map knows about itself.
struct SelfKnowledge {
    std::string sentence;            // for people: what it knows, or why it predicts nothing and
                                     // what would help
    std::optional<double> tolerance; // none = it knows nothing
    uint32_t labelled = 0;           // experiences
    double skill; // at 0 or below, distances say nothing about recall; NaN = not known
};

// experiences: of this map, at least one.
SelfKnowledge self_knowledge_of(const std::string &map,
                                const std::vector<vdna_experience> &experiences);

} // namespace vdna::record
