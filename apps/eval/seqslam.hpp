// SeqSLAM: Milford and Wyeth, "SeqSLAM: Visual route-based navigation for sunny summer days and
// stormy winter nights", ICRA 2012, on distances of embeddings instead of pixels. Our own code;
// docs/internals/DESIGN.md, Metrics, has the definition.
#pragma once

#include <array>

#include "eval/localisers.hpp"

namespace vdna::eval
{

constexpr uint32_t seqslam_frames = 10;    // the live frame and those before it
constexpr uint32_t seqslam_neighbours = 5; // map frames on each side, for the local contrast
// Map frames per live frame, in tenths: integers, so that every machine rounds them alike.
constexpr std::array<uint32_t, 5> seqslam_velocity_tenths = {8, 9, 10, 11, 12};

// Each distance less the mean of those around it, in their standard deviations; 0 if they are all
// equal. distances: of one live frame to each map frame.
std::vector<double> local_contrast(const std::vector<double> &distances);

// The map frame at the end of the line with the least sum. rows: local contrasts of the live frame
// and of those before it, newest first.
uint32_t best_line_end(const std::vector<std::vector<double>> &rows);

std::vector<Answer> seqslam(const Drive &drive, const vdna_experience &map);

} // namespace vdna::eval
