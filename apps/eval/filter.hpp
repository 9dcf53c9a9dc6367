// Localisers about the means of map and drive, of vdna/localise.h.
#pragma once

#include <vector>

#include "eval/localisers.hpp"

namespace vdna::eval
{

// A map that was not read from a file, which does not say how its embeddings are made.
vdna_experience about_its_mean(vdna_experience map);

// The map frame of least distance.
std::vector<Answer> centred(const Drive &drive, const vdna_experience &map);

// The place filter, with its confidence. It follows every frame of the drive, those of the warmup
// for its mean alone.
std::vector<Answer> filter(const Drive &drive, const vdna_experience &map);

} // namespace vdna::eval
