// Picture of the differences between live frames and map frames.
#pragma once

#include <string>
#include <vector>

#include "record/localisation.hpp"

namespace vdna::report
{

// Throw Error if the matrices would be larger than what is drawn, or if `file` is neither a .png
// nor a .svg nor a .pdf.
void require_drawable(const record::Recording &live,
                      const std::vector<const vdna_experience *> &experiences,
                      const std::string &file);

// Draw the difference matrices of several experiences into a PNG, SVG or PDF file, by its ending:
// the most recall first, or where that is unknown the nearest on average. The matches are the
// nearest frames, or with_filter those of the place filter with the nearest frames small below
// them. followed: with distances. Throws Error.
void draw_difference_matrices(const record::Recording &live,
                              const std::vector<record::Followed> &followed, bool with_filter,
                              const std::string &file);

} // namespace vdna::report
