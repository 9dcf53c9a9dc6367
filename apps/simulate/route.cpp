#include "simulate/route.hpp"

#include <algorithm>
#include <cmath>

#include "simulate/chance.hpp"

namespace vdna::simulate
{

namespace
{

// The route is divided into cells, and the number of a cell determines its content: nothing is
// stored, and the route is endless. A lap of a closed route has a whole number of each.
constexpr double kerb_cell = 4.5; // close to the path: single small things
constexpr double yard_cell = 14;  // behind them: houses, walls, hedges
constexpr double district_length = 42;

struct Choice {
    Kind kind;
    float weight;
};

// A stretch of the route with its own character. Weights that add up to less than 1 leave the
// remaining cells empty.
struct District {
    Surface surface;
    std::vector<Choice> kerb, yard;
};

const std::vector<District> &districts()
{
    static const std::vector<District> all = {
        // park
        {Surface::gravel,
         {{Kind::tree, .34f}, {Kind::bench, .14f}, {Kind::bush, .18f}, {Kind::sign, .06f}},
         {{Kind::tree, .4f}, {Kind::hedge, .25f}, {Kind::fence, .2f}}},
        // street
        {Surface::asphalt,
         {{Kind::tree, .16f}, {Kind::sign, .26f}, {Kind::bush, .08f}, {Kind::bench, .06f}},
         {{Kind::house, .62f}, {Kind::wall, .25f}}},
        // woods
        {Surface::earth,
         {{Kind::tree, .3f}, {Kind::conifer, .28f}, {Kind::bush, .1f}, {Kind::rock, .16f}},
         {{Kind::conifer, .5f}, {Kind::tree, .45f}}},
        // gardens
        {Surface::paving,
         {{Kind::bush, .34f}, {Kind::tree, .14f}, {Kind::sign, .08f}, {Kind::rock, .06f}},
         {{Kind::hedge, .28f}, {Kind::fence, .26f}, {Kind::house, .32f}}},
    };
    return all;
}

const District &district_at(uint64_t seed, double along)
{
    const auto number = static_cast<int64_t>(std::floor(along / district_length));
    // Each lap of four has every district once, in its own order.
    const auto lap = static_cast<uint64_t>(number >> 2);
    const uint64_t turn = seed_of_part(seed, lap);
    return districts()[(static_cast<uint64_t>(number) * (turn & 1 ? 1u : 3u) + (turn >> 8)) % 4];
}

// -1 if the draw leaves the cell empty
int pick(const std::vector<Choice> &choices, Chance &chance)
{
    float draw = chance.unit();
    for (size_t i = 0; i < choices.size(); i++) {
        draw -= choices[i].weight;
        if (draw < 0)
            return static_cast<int>(choices[i].kind);
    }
    return -1;
}

// Smallest and largest length, width and height of each kind.
void give_size(Landmark &landmark, Chance &chance)
{
    struct Size {
        float length[2], width[2], height[2];
    };
    static const Size sizes[] = {
        /* tree */ {{0, 0}, {0, 0}, {3.8f, 8}},
        /* conifer */ {{0, 0}, {0, 0}, {4, 9}},
        /* bush */ {{0, 0}, {0, 0}, {.7f, 1.7f}},
        /* rock */ {{0, 0}, {0, 0}, {.4f, 1.1f}},
        /* bench */ {{1.5f, 2}, {.5f, .5f}, {.85f, .95f}},
        /* sign */ {{0, 0}, {0, 0}, {1.6f, 2.6f}},
        /* lamp */ {{0, 0}, {0, 0}, {3.6f, 4.4f}},
        /* hedge */ {{9, 13.5f}, {.8f, 1.2f}, {1, 2}},
        /* fence */ {{11, 13.5f}, {.1f, .1f}, {.9f, 1.5f}},
        /* wall */ {{10, 13.5f}, {.4f, .4f}, {1.4f, 2.6f}},
        /* house */ {{7, 12.5f}, {6, 8}, {2.9f, 6.2f}},
        /* tower */ {{4, 9}, {4, 9}, {16, 30}},
    };
    const Size &size = sizes[static_cast<size_t>(landmark.kind)];
    landmark.length = chance.between(size.length[0], size.length[1]);
    landmark.width = chance.between(size.width[0], size.width[1]);
    landmark.height = chance.between(size.height[0], size.height[1]);
}

Landmark make(Kind kind, double along, double across, Chance &chance)
{
    Landmark landmark{kind, along, across, 0, 0, 0, chance.unit(), chance.next()};
    give_size(landmark, chance);
    return landmark;
}

Chance chance_of_cell(uint64_t seed, uint64_t row, int64_t cell, float side)
{
    const uint64_t part = row << 56 ^ (static_cast<uint64_t>(cell) << 1 | (side > 0 ? 1u : 0u));
    return Chance(seed_of_part(seed, part));
}

cv::Point2d unit(double angle)
{
    return {std::cos(angle), std::sin(angle)};
}

} // namespace

Route::Route(uint64_t seed, Shape shape)
    : seed_(seed), shape_(shape), backdrop_cell_(shape == Shape::line ? 15 : 14),
      bend_length_{shape == Shape::line ? 210. : eight_length,
                   shape == Shape::line ? 83. : eight_length / 3}
{
    Chance chance(seed);
    for (double &phase : phase_)
        phase = chance.between(0, 2 * static_cast<float>(CV_PI));
}

cv::Point2d Route::at(double along, double across) const
{
    const double line = 4 * std::sin(2 * CV_PI * along / bend_length_[0] + phase_[0]) +
                        1.2 * std::sin(2 * CV_PI * along / bend_length_[1] + phase_[1]);
    return {along, line + across};
}

double Route::slope(double along) const
{
    const double turn[2] = {2 * CV_PI / bend_length_[0], 2 * CV_PI / bend_length_[1]};
    return 4 * turn[0] * std::cos(turn[0] * along + phase_[0]) +
           1.2 * turn[1] * std::cos(turn[1] * along + phase_[1]);
}

double Route::first_lap(double along) const
{
    return shape_ == Shape::line ? along : along - eight_length * std::floor(along / eight_length);
}

int64_t Route::first_lap_cell(int64_t cell, double cell_length) const
{
    return std::llround(first_lap(static_cast<double>(cell) * cell_length) / cell_length);
}

// Each half of the figure of eight is a straight of length r out of the crossing, three quarters of
// a circle of radius r, and the straight back; the second half is the mirror image of the first.
cv::Point2d Route::position(double along, double across) const
{
    if (shape_ == Shape::line)
        return at(along, across);
    constexpr double half = eight_length / 2, arc = 1.5 * CV_PI, r = half / (2 + arc);
    const bool mirrored = first_lap(along) >= half;
    const double left = mirrored ? -across : across, way = first_lap(along) - (mirrored ? half : 0);
    cv::Point2d line;
    double heading = -CV_PI / 4;
    if (way < r) {
        line = way * unit(heading);
    } else if (way < r + arc * r) {
        heading += (way - r) / r;
        line = cv::Point2d(std::sqrt(2) * r, 0) + r * unit(heading - CV_PI / 2);
    } else {
        heading += arc;
        line = (way - half) * unit(heading);
    }
    line += left * unit(heading + CV_PI / 2);
    return {mirrored ? -line.x : line.x, line.y};
}

Surface Route::surface(double along) const
{
    return district_at(seed_, first_lap(along)).surface;
}

float Route::skyline(double azimuth) const
{
    return static_cast<float>(.045 + .022 * std::sin(5 * azimuth + phase_[2]) +
                              .012 * std::sin(17 * azimuth + phase_[3]));
}

void Route::add_kerb(int64_t cell, std::vector<Landmark> &row) const
{
    const int64_t number = first_lap_cell(cell, kerb_cell);
    for (const float side : {-1.f, 1.f}) {
        Chance chance = chance_of_cell(seed_, 0, number, side);
        const double along = kerb_cell * (static_cast<double>(cell) + chance.between(.1f, .8f));
        // Lamps stand in a regular row, on alternating sides.
        const bool lamp = number % 4 == (side > 0 ? 0 : 2);
        const int kind = pick(district_at(seed_, first_lap(along)).kerb, chance);
        if (lamp)
            row.push_back(make(Kind::lamp, along, side * 2, chance));
        else if (kind >= 0)
            row.push_back(
                make(static_cast<Kind>(kind), along, side * chance.between(2.1f, 4.6f), chance));
    }
}

void Route::add_yard(int64_t cell, std::vector<Landmark> &row) const
{
    for (const float side : {-1.f, 1.f}) {
        Chance chance = chance_of_cell(seed_, 1, first_lap_cell(cell, yard_cell), side);
        const double along = yard_cell * static_cast<double>(cell);
        const int kind = pick(district_at(seed_, first_lap(along)).yard, chance);
        if (kind < 0)
            continue;
        const bool grows =
            kind == static_cast<int>(Kind::tree) || kind == static_cast<int>(Kind::conifer);
        // Trees stand in groups.
        for (int i = 0; i < (grows ? 4 : 1); i++)
            row.push_back(make(static_cast<Kind>(kind), along + (grows ? 3.4 * i : 0),
                               side * chance.between(6, grows ? 12.f : 8.f), chance));
    }
}

void Route::add_backdrop(int64_t cell, std::vector<Landmark> &row) const
{
    static const std::vector<Choice> kinds = {
        {Kind::tree, .38f}, {Kind::conifer, .22f}, {Kind::house, .16f}, {Kind::tower, .12f}};
    for (const float side : {-1.f, 1.f}) {
        Chance chance = chance_of_cell(seed_, 2, first_lap_cell(cell, backdrop_cell_), side);
        const double along = backdrop_cell_ * static_cast<double>(cell);
        const int kind = pick(kinds, chance);
        if (kind < 0)
            continue;
        row.push_back(make(static_cast<Kind>(kind), along, side * chance.between(18, 42), chance));
        row.back().height *= 1.5f;
    }
}

std::vector<Landmark> Route::landmarks(double from, double to) const
{
    std::vector<Landmark> all;
    const auto add_row = [&](double cell_length, auto add_cell) {
        const auto first = static_cast<int64_t>(std::floor(from / cell_length)) - 1;
        const auto last = static_cast<int64_t>(std::floor(to / cell_length));
        const size_t begin = all.size();
        for (int64_t cell = first; cell <= last; cell++)
            add_cell(cell);
        std::sort(all.begin() + static_cast<std::ptrdiff_t>(begin), all.end(),
                  [](const Landmark &a, const Landmark &b) { return a.along > b.along; });
    };
    add_row(backdrop_cell_, [&](int64_t cell) { add_backdrop(cell, all); });
    add_row(yard_cell, [&](int64_t cell) { add_yard(cell, all); });
    add_row(kerb_cell, [&](int64_t cell) { add_kerb(cell, all); });
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const Landmark &landmark) {
                                 return landmark.along + landmark.length < from ||
                                        landmark.along > to;
                             }),
              all.end());
    return all;
}

} // namespace vdna::simulate
