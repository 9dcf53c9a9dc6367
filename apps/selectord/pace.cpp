#include "selectord/pace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace vdna::selectord
{

namespace
{

constexpr int64_t measured_us = 2000000; // long enough to pass several frames of a map
constexpr int64_t near_us = 1000000;     // a robot may speed up meanwhile

// Between two frames of an experience, in the unit of Stride's `every`.
double distance_in(const vdna_experience &map, uint32_t a, uint32_t b)
{
    if (map.frame_position) {
        const double *const from = map.frame_position + size_t{3} * a;
        const double *const to = map.frame_position + size_t{3} * b;
        return std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    }
    const bool has_places = map.frame_place && map.frame_place[a] != VDNA_PLACE_NONE &&
                            map.frame_place[b] != VDNA_PLACE_NONE;
    const int64_t from = has_places ? map.frame_place[a] : a;
    const int64_t to = has_places ? map.frame_place[b] : b;
    return static_cast<double>(std::abs(to - from));
}

} // namespace

// Each frame taken moves the next one by a period, so the rate holds; a quarter of it is jitter.
bool RateLimit::takes(int64_t us)
{
    const bool is_early = us < due_us_ - period_us_ / 4;
    if (is_early && us > due_us_ - 2 * period_us_)
        return false;
    due_us_ = (is_early ? us : std::max(due_us_, us - period_us_ / 2)) + period_us_;
    return true;
}

void Stride::note(const vdna_experience &experience, uint32_t index, uint32_t frame, int64_t us)
{
    const bool goes_on = is_known_ && index == index_ && us >= newest_us_;
    newest_us_ = us;
    if (goes_on && us - begin_us_ < measured_us)
        return;
    // A position that is not known makes no speed: NaN is not above 0.
    speed_ =
        goes_on ? distance_in(experience, frame_, frame) / static_cast<double>(us - begin_us_) : 0;
    is_known_ = true;
    index_ = index;
    frame_ = frame;
    begin_us_ = us;
}

bool Stride::is_near(int64_t us) const
{
    const int64_t elapsed_us = us - newest_us_;
    return is_known_ && speed_ > 0 && elapsed_us >= 0 && elapsed_us < near_us &&
           speed_ * static_cast<double>(elapsed_us) < every_;
}

} // namespace vdna::selectord
