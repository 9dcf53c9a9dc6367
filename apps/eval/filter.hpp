// Localisers about the means of map and drive, of vdna/localise.h.
#pragma once

#include <functional>
#include <vector>

#include <vdna/localise.h>

#include "eval/localisers.hpp"

namespace vdna::eval
{

// A map that was not read from a file, which does not say how its embeddings are made.
vdna_experience about_its_mean(vdna_experience map);

// Follow every frame of the drive, those of the warmup for its mean alone.
// take: gets the answer to each frame of drive.live, and its distances about the means, [map
// frames], borrowed until it returns. Throws Error.
void follow(const Drive &drive, const vdna_experience &map,
            const std::function<void(const vdna_localise_answer &, const float *)> &take);

// The map frame of least distance.
std::vector<Answer> centred(const Drive &drive, const vdna_experience &map);

// The place filter, with its confidence.
std::vector<Answer> filter(const Drive &drive, const vdna_experience &map);

} // namespace vdna::eval
