// Picture of the differences between live frames and map frames.
#pragma once

#include <string>
#include <vector>

#include "record/localisation.hpp"

namespace vdna::report
{

// Draw the difference matrices of several experiences side by side into a PNG file: live frames
// downwards, map frames to the right, near = black, far = white on one scale for all, matches
// dotted in blue if they are good and in orange otherwise. Throws Error.
void draw_difference_matrices(const record::Recording &live,
                              const std::vector<const vdna_experience *> &experiences,
                              const std::vector<record::Localisation> &localisations,
                              const std::string &png);

} // namespace vdna::report
