// The ground truth of a drive's frames from its track, by time.
#pragma once

#include <cstdint>
#include <string>

#include "frames/labels.hpp"
#include "frames/track.hpp"

namespace vdna::frames
{

class TrackJoin
{
  public:
    // source: the frames' path, for complaints.
    TrackJoin(Track track, const std::string &source);

    // Give the next frame the position that the track has for its time, if any, in place of all
    // other truth. Throws Error if the first frame shows that track and frames are of different
    // times.
    void label_next(int64_t utime, Label &label);

    // At the end of the frames. Throws Error if none of them had a position.
    void finish() const;

  private:
    [[noreturn]] void fail_without_overlap() const;

    Track track_;
    std::string source_;
    uint64_t frames_ = 0, placed_ = 0;
    int64_t begin_utime_ = 0, end_utime_ = 0; // of the frames
};

} // namespace vdna::frames
