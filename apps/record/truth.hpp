// Ground truth: how far apart the places of a live frame and a map frame are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "record/recording.hpp"

namespace vdna::record
{

// Unit of the distance between two frames: the kind of label that both sides have.
enum class Unit { none, places, metres };

// "places", "metres" or "".
const char *name_of(Unit unit);

// Positions at height 0, so that their straight distance is horizontal (docs/reference/SPEC-map.md,
// Positions).
// position: [frames][3], metres, NaN = this frame has none, and then it still has none.
// is_global: in VDNA_FRAME_WGS84.
std::vector<double> on_the_ground(const double *position, size_t frames, bool is_global);

// The labels of live frames and of an experience, ready to be compared. Positions are preferred to
// place numbers if both sides have both.
class Truth
{
  public:
    // Distances are horizontal (docs/reference/SPEC-map.md, Positions), or straight through space
    // with_altitude. live, map: places are borrowed. Throws Error if with_altitude and only one
    // side has altitudes.
    Truth(const Recording &live, const vdna_experience &map, bool with_altitude = false);

    // none = not labelled alike.
    Unit unit() const { return unit_; }
    // Why there is no unit: "live in frame wgs84, map in local"; "" if there is one.
    const std::string &difference() const { return difference_; }
    // Whether a live frame has a label of this unit.
    bool knows(size_t live) const;
    // NaN if one of the frames has no label.
    double apart(size_t live, size_t map) const;

  private:
    Unit unit_ = Unit::none;
    std::string difference_;
    const int64_t *live_place_ = nullptr, *map_place_ = nullptr;
    std::vector<double> live_m_, map_m_; // [frames][3]
};

} // namespace vdna::record
