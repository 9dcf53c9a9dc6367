// Means of a feature map over the cells of a grid: where something is, roughly, and not what only.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "manifest.hpp"
#include "session.hpp"

namespace vdna::backbone
{

class GridMeans
{
  public:
    // map: [channels][height][width]; called: its output, for the error. Throws Failure
    // (VDNA_ERR_MISMATCH) for an output that is no feature map, or has fewer pixels than cells.
    GridMeans(const Output &map, const Grid &grid, const std::string &called);

    // Numbers that run() writes: channels x rows x columns, in this order.
    size_t size() const;

    // Cell i of g covers the pixels edge(i) to edge(i+1)-1 of h, edge(i) = floor((2ih+g) / (2g)).
    // Its pixels are added up row by row in double precision, divided by their number, and rounded.
    void run(const float *map, float *out_means) const;

  private:
    size_t channels_, height_, width_;
    std::vector<size_t> row_edges_, column_edges_;
};

} // namespace vdna::backbone
