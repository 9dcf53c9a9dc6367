// Picture of the differences between live frames and map frames.
#pragma once

#include <string>
#include <vector>

#include "record/localisation.hpp"

namespace vdna::report
{

// Throw Error if the matrices would be larger than what is drawn. png: for the error.
void require_drawable(const record::Recording &live,
                      const std::vector<const vdna_experience *> &experiences,
                      const std::string &png);

// Draw the difference matrices of several experiences side by side into a PNG file: live frames
// downwards, map frames to the right, near = black, far = white on one scale for all. The nearest
// frames are dotted in blue if they are good and in orange otherwise, and with_filter over them
// those of the place filter, smaller, in green or red. followed: with distances. Throws Error.
void draw_difference_matrices(const std::vector<record::Followed> &followed, bool with_filter,
                              const std::string &png);

} // namespace vdna::report
