// Fusing the references of a place by their likelihoods, in place of choosing one: after Molloy,
// Fischer, Milford and Nair, "Intelligent Reference Curation for Visual Place Recognition via
// Bayesian Selective Fusion", RA-L 2021, with a likelihood of our own. Our own code;
// docs/internals/DESIGN.md, Metrics, has the definition.
#pragma once

#include <vector>

#include "eval/localisers.hpp"

namespace vdna::eval
{

struct Reference {
    vdna_experience map;
    std::vector<uint32_t> frame_at; // [places], of the map; map.frames = it has not been there
};

// How much likelier a live frame is at each frame of a reference than anywhere else, as a
// logarithm: distances of other places are taken to be normal, those of the same place to be
// uniform. distances: of one live frame to all frames, at least one.
std::vector<double> log_odds(const float *distances, uint32_t frames);

// The place of most log odds, summed over the references that have been there, for each frame of
// drive.live. Distances are about the means. The first of equals. Throws Error.
std::vector<Answer> most_likely(const Drive &drive, const std::vector<Reference> &references);

} // namespace vdna::eval
