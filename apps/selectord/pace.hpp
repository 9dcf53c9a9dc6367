// What bounds the work while driving: frames a second, and metres between frames that go through
// the network. Times are arguments, in microseconds.
#pragma once

#include <cstdint>

#include <vdna/map.h>

namespace vdna::selectord
{

// At most so many frames a second, whatever their jitter.
class RateLimit
{
  public:
    // hz: 0 = no limit
    explicit RateLimit(double hz) : period_us_(hz > 0 ? static_cast<int64_t>(1e6 / hz) : 0) {}

    // Whether the frame of this time is to be taken. Time that steps back begins anew.
    bool takes(int64_t us);

  private:
    const int64_t period_us_;
    int64_t due_us_ = INT64_MIN / 2; // of the next frame
};

// Whether the robot is still near the place of its newest answer, by the speed at which the places
// of the last seconds advanced. At the latest a second after an answer it is not.
class Stride
{
  public:
    // every: metres if the map has positions, else place numbers, else frames of the map; 0 = the
    // robot is never near
    explicit Stride(double every) : every_(every) {}

    // The newest answer: frame `frame` of experience `index` of the map.
    void note(const vdna_experience &experience, uint32_t index, uint32_t frame, int64_t us);
    // The newest answer is no place to go by.
    void forget() { is_known_ = false; }

    bool is_near(int64_t us) const;

  private:
    const double every_;
    bool is_known_ = false;
    uint32_t index_ = 0, frame_ = 0; // where the measurement of the speed began ...
    int64_t begin_us_ = 0;           // ... and when
    int64_t newest_us_ = 0;          // of the newest answer
    double speed_ = 0;               // a microsecond; 0 = not known, or it stands
};

} // namespace vdna::selectord
