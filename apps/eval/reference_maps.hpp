// Several references made into one map.
#pragma once

#include <vector>

#include "record/localisation.hpp"

namespace vdna::eval
{

// A recording as a map to localise in; borrowed.
vdna_experience map_of(const record::Recording &recording, uint32_t dim);

// Append a frame of another recording: its label and its embedding.
void append(record::Recording &to, const record::Recording &from, uint32_t frame, uint32_t dim);

// All frames, concatenated.
record::Recording joined(const std::vector<const record::Recording *> &parts, uint32_t dim);

// Shift the embeddings of each part, so that their mean is the same in all parts: that of the
// parts' means.
void give_one_mean(std::vector<record::Recording> &parts, uint32_t dim);

// A frame for each place, whose embedding is the mean over the parts that have been there. The
// labelled frames of the first part are places; so are those of each further part that are farther
// than the tolerance from all places before it. A part's embedding of a place is that of its
// nearest frame (ties: the lowest index), if that is within tolerance.
// with_altitude: as for record::Truth. Throws Error.
record::Recording fused(const std::vector<const record::Recording *> &parts, uint32_t dim,
                        double tolerance, bool with_altitude);

// The frame of a part at each place of a fused map: its nearest within tolerance (ties: the lowest
// index); part.frames where it has not been. with_altitude: as for record::Truth. Throws Error.
std::vector<uint32_t> frames_at(const record::Recording &places, const record::Recording &part,
                                double tolerance, bool with_altitude);

} // namespace vdna::eval
