#include "simulate/grain.hpp"

#include <cmath>

#include "simulate/chance.hpp"

namespace vdna::simulate
{

namespace
{

constexpr int side = 256; // texels, a power of two
constexpr uint64_t grain_seed = 11;

// Random values on a lattice whose last row and column repeat the first.
cv::Mat1f make_lattice(int cells, Chance &chance)
{
    cv::Mat1f lattice(cells + 1, cells + 1);
    for (int row = 0; row < cells; row++)
        for (int column = 0; column < cells; column++)
            lattice(row, column) = chance.between(-1, 1);
    lattice.row(0).copyTo(lattice.row(cells));
    lattice.col(0).copyTo(lattice.col(cells));
    return lattice;
}

// The lattice at a texel, interpolated between its four neighbours.
float interpolated(const cv::Mat1f &lattice, int texels, int row, int column)
{
    const int r = row / texels, c = column / texels;
    const float y = static_cast<float>(row % texels) / static_cast<float>(texels);
    const float x = static_cast<float>(column % texels) / static_cast<float>(texels);
    const float top = lattice(r, c) * (1 - x) + lattice(r, c + 1) * x;
    const float low = lattice(r + 1, c) * (1 - x) + lattice(r + 1, c + 1) * x;
    return top * (1 - y) + low * y;
}

} // namespace

Grain::Grain() : tile_(side, side, 0.f)
{
    Chance chance(grain_seed);
    float weight = .5f;
    for (int cells = 8; cells <= side; cells *= 2, weight *= .75f) {
        const cv::Mat1f lattice = make_lattice(cells, chance);
        for (int row = 0; row < side; row++)
            for (int column = 0; column < side; column++)
                tile_(row, column) += weight * interpolated(lattice, side / cells, row, column);
    }
}

float Grain::at(double x, double y) const
{
    const int column = static_cast<int>(std::floor(x * side)) & (side - 1);
    const int row = static_cast<int>(std::floor(y * side)) & (side - 1);
    return tile_(row, column);
}

} // namespace vdna::simulate
