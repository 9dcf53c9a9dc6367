// The world of `vdna simulate`: one route and its landmarks, all from a seed.
//
// Lengths are in metres. The world's x axis runs along the route and y to its left; a place is
// given in the world, or by its distance along the route and across (left of) its line.
//
// The world of a closed route is its endless unrolling, in which every lap looks like the first:
// pictures show the two ways through a crossing as different as they are, but neither from the
// other.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace vdna::simulate
{

enum class Kind {
    tree,
    conifer,
    bush,
    rock,
    bench,
    sign,
    lamp,
    hedge,
    fence,
    wall,
    house,
    tower,
};

// One thing beside the route. Its shape seed alone determines the details, so it is the same in
// every condition.
struct Landmark {
    Kind kind;
    double along;   // of its near end
    double across;  // of its side towards the path
    float length;   // extent along the route
    float width;    // extent across, away from the path
    float height;   // of the walls, if it has a roof
    float hue;      // 0..1: selects one of the colours of its kind
    uint64_t shape; // seed of everything else

    double outward(double metres) const { return across + (across < 0 ? -metres : metres); }
};

enum class Surface { asphalt, gravel, paving, earth };

constexpr float path_half_width = 1.3f;

// A route without end, or closed: a figure of eight of eight_length metres.
enum class Shape { line, eight };

constexpr double eight_length = 252;

class Route
{
  public:
    explicit Route(uint64_t seed, Shape shape = Shape::line);

    uint64_t seed() const { return seed_; }
    // The same place of the first lap.
    double first_lap(double along) const;
    // Where a place really is, for ground truth: in the world of a line; a figure of eight begins
    // in its crossing, the origin, where its ways are at right angles.
    cv::Point2d position(double along, double across) const;
    cv::Point2d at(double along, double across = 0) const; // in the world
    double slope(double along) const;                      // dy/dx of the route's line
    Surface surface(double along) const;
    float skyline(double azimuth) const; // elevation (tangent) of the hills in this direction
    // The landmarks that touch from..to, in painting order: outermost rows first, and the farthest
    // first within a row, so that nearer ones hide farther ones.
    std::vector<Landmark> landmarks(double from, double to) const;

  private:
    int64_t first_lap_cell(int64_t cell, double cell_length) const;
    void add_kerb(int64_t cell, std::vector<Landmark> &row) const;
    void add_yard(int64_t cell, std::vector<Landmark> &row) const;
    void add_backdrop(int64_t cell, std::vector<Landmark> &row) const;

    uint64_t seed_;
    Shape shape_;
    double backdrop_cell_;  // length of a cell of the skyline
    double bend_length_[2]; // of a wave of the route's line
    double phase_[4] = {};  // of the bends and of the hills
};

} // namespace vdna::simulate
