#include "frames/track_join.hpp"

#include <algorithm>
#include <cstdio>

#include <vdna/cpp/error.hpp>

#include "frames/creation_time.hpp"
#include "frames/iso_time.hpp"

namespace vdna::frames
{

namespace
{

// By more than the longest drive, a day. As numbers of floating point, which do not overflow.
bool is_long_before(int64_t utime, int64_t other)
{
    return static_cast<double>(other) - static_cast<double>(utime) > 86400e6;
}

std::string seconds(int64_t us)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.3g s", static_cast<double>(us) / 1e6);
    return text;
}

} // namespace

TrackJoin::TrackJoin(Track track, const std::string &source)
    : track_(std::move(track)), source_(source)
{
}

void TrackJoin::label_next(int64_t utime, Label &label)
{
    begin_utime_ = frames_ == 0 ? utime : std::min(begin_utime_, utime);
    end_utime_ = frames_ == 0 ? utime : std::max(end_utime_, utime);
    // Better told now than after all frames went through the network.
    if (frames_++ == 0 &&
        (utime > track_.end_utime() || is_long_before(utime, track_.begin_utime())))
        fail_without_overlap();
    label.place.reset();
    label.position = track_.at(utime);
    label.position_frame = label.position ? track_.frame() : "";
    label.lacks_truth = !label.position;
    placed_ += label.position ? 1 : 0;
}

void TrackJoin::finish() const
{
    if (frames_ == 0 || placed_ > 0)
        return;
    if (end_utime_ < track_.begin_utime() || begin_utime_ > track_.end_utime())
        fail_without_overlap();
    throw Error(track_.name() + ": its fixes are " + seconds(track_.spacing_us()) +
                " apart, so no frame of " + source_ + " lies between two of them that are within " +
                seconds(track_.gap_us()) + "; set a longer --gps-gap");
}

void TrackJoin::fail_without_overlap() const
{
    const std::optional<int64_t> made = creation_time_of(source_);
    throw Error(track_.name() + ": the track is from " + iso_of(track_.begin_utime()) + " to " +
                iso_of(track_.end_utime()) + ", but the frames of " + source_ + " " +
                (frames_ > 1 ? "are from " + iso_of(begin_utime_) + " to " + iso_of(end_utime_)
                             : "begin at " + iso_of(begin_utime_)) +
                "; set --time-offset to the seconds to add to the frames' times or, if these count "
                "from 0, to the time of the first frame" +
                (made ? " (the file says that it was made at " + iso_of(*made) + ")" : ""));
}

} // namespace vdna::frames
