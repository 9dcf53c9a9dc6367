#include "grid_means.hpp"

#include "failure.hpp"

namespace vdna::backbone
{

namespace
{

std::vector<size_t> edges(size_t pixels, size_t cells)
{
    std::vector<size_t> edges;
    for (size_t i = 0; i <= cells; i++)
        edges.push_back((2 * i * pixels + cells) / (2 * cells));
    return edges;
}

std::string sides(size_t rows, size_t columns)
{
    return std::to_string(rows) + "x" + std::to_string(columns);
}

} // namespace

GridMeans::GridMeans(const Output &map, const Grid &grid, const std::string &called)
{
    if (map.shape.size() != 3)
        throw fail::Failure(VDNA_ERR_MISMATCH,
                            called + " has " + std::to_string(map.shape.size()) +
                                " dimensions and no rows and columns; expected a feature map, "
                                "1xCHANNELSxHEIGHTxWIDTH; tap one, or leave out 'grid'");
    channels_ = static_cast<size_t>(map.shape[0]);
    height_ = static_cast<size_t>(map.shape[1]);
    width_ = static_cast<size_t>(map.shape[2]);
    if (grid.rows > height_ || grid.columns > width_)
        throw fail::Failure(VDNA_ERR_MISMATCH, called + " has " + sides(height_, width_) +
                                                   " pixels, which 'grid' cannot divide into " +
                                                   sides(grid.rows, grid.columns) +
                                                   " cells; expected at most one cell a pixel");
    row_edges_ = edges(height_, grid.rows);
    column_edges_ = edges(width_, grid.columns);
}

size_t GridMeans::size() const
{
    return channels_ * (row_edges_.size() - 1) * (column_edges_.size() - 1);
}

void GridMeans::run(const float *map, float *out_means) const
{
    for (size_t c = 0; c < channels_; c++, map += height_ * width_)
        for (size_t r = 0; r + 1 < row_edges_.size(); r++)
            for (size_t k = 0; k + 1 < column_edges_.size(); k++) {
                const size_t top = row_edges_[r], bottom = row_edges_[r + 1];
                const size_t left = column_edges_[k], right = column_edges_[k + 1];
                double sum = 0.0;
                for (size_t y = top; y < bottom; y++)
                    for (size_t x = left; x < right; x++)
                        sum += static_cast<double>(map[y * width_ + x]);
                *out_means++ =
                    static_cast<float>(sum / static_cast<double>((bottom - top) * (right - left)));
            }
}

} // namespace vdna::backbone
