#include "record/live_recorder.hpp"

#include <algorithm>
#include <new>

#include "program/clock.hpp"
#include "program/interrupt.hpp"
#include "program/notice.hpp"
#include "program/progress.hpp"

namespace vdna::record
{

namespace
{

// Positions that have room: more than a pose and a fix need that come as often as frames. When it
// is full, those go that no frame lies next to; the newest are kept for frames to come.
constexpr size_t positions_per_frame = 4, positions_more = 4096, positions_newest = 1024;
// What becomes of a position in the end: the track, and for a moment the search for jumps.
constexpr size_t position_bytes = 384;

constexpr int64_t poses_wait_us = 2000000;

size_t positions_max(const LiveLimits &limits)
{
    return positions_per_frame * limits.frames_max + positions_more;
}

} // namespace

LiveRecorder::LiveRecorder(Maker &maker, Backbone &backbone, frames::Live &live,
                           const LiveLimits &limits, std::string frame)
    : maker_(maker), backbone_(backbone), live_(live), limits_(limits), frame_(std::move(frame))
{
    vdna_health_init(&health_, nullptr); // cannot fail: the defaults are valid
}

uint64_t LiveRecorder::memory_bytes() const
{
    const uint64_t frames = uint64_t{maker_.frame_bytes()} * limits_.frames_max;
    const uint64_t counts =
        uint64_t{maker_.blank().identity.neurons} * maker_.bins() * sizeof(uint32_t);
    return frames + counts + (live_.has_poses() ? positions_max(limits_) * position_bytes : 0);
}

void LiveRecorder::begin(Draft &draft)
try {
    maker_.begin(draft, limits_.frames_max);
    if (live_.has_poses())
        live_.poses().reserve(positions_max(limits_));
} catch (const std::bad_alloc &) {
    throw Error("no memory for " + std::to_string(limits_.frames_max) + " frames, which need " +
                std::to_string(memory_bytes() >> 20) + " MiB; set a smaller --frames-max");
}

LiveEnd LiveRecorder::record(Draft &draft)
{
    program::Progress progress("recording " + draft.name, limits_.frames_max);
    const int64_t begin_us = program::monotonic_us();
    const auto is_over = [&] {
        return limits_.seconds > 0 &&
               static_cast<double>(program::monotonic_us() - begin_us) >= 1e6 * limits_.seconds;
    };
    for (frames::Frame frame;;) {
        if (program::interrupted())
            return LiveEnd::interrupted;
        if (draft.recording.frames == limits_.frames_max)
            return LiveEnd::full;
        if (is_over())
            return LiveEnd::time;
        if (live_.has_ended())
            return live_.is_log() ? LiveEnd::log : LiveEnd::network;
        const uint32_t before = draft.recording.frames;
        if (live_.next(frame))
            take(draft, frame);
        progress.advance(draft.recording.frames - before);
        // A log has its own pace; its poses wait until all frames are there.
        if (!live_.is_log())
            take_poses(draft);
    }
}

void LiveRecorder::take(Draft &draft, frames::Frame &frame)
{
    Recording &recording = draft.recording;
    if (live_.has_recognised_unit())
        for (int64_t &utime : recording.utime)
            utime = vdna_time_us(live_.time_unit(), utime);
    const double since_us = recording.frames == 0 ? 0
                                                  : static_cast<double>(frame.utime) -
                                                        static_cast<double>(recording.utime.back());
    if (recording.frames > 0 && since_us >= 0 && since_us < 1e6 * limits_.interval_s) {
        between_++;
        return;
    }
    try {
        const vdna_backbone_frame output = run_network(backbone_, frame);
        uint32_t verdict = VDNA_HEALTH_OK;
        if (output.health.width > 0)
            verdict = vdna_health_take(&health_, &output.health);
        if (verdict == VDNA_HEALTH_OK)
            return maker_.add(draft, frame, output);
        verdicts_[verdict]++;
    } catch (const frames::BadFrame &bad) {
        if (verdicts_[VDNA_HEALTH_OK]++ == 0)
            program::tell_once(bad.what() + std::string("; left out"));
    }
    unusable_++;
}

void LiveRecorder::take_poses(const Draft &draft)
{
    while (take_pose(draft, 0))
        ;
}

bool LiveRecorder::take_pose(const Draft &draft, int32_t timeout_ms)
{
    if (!live_.take_pose(timeout_ms))
        return false;
    frames::Poses &poses = live_.poses();
    if (poses.size() == positions_max(limits_))
        poses.thin(draft.recording.utime, positions_newest);
    if (!is_in_frame(poses))
        program::tell_once(other_frame(poses) + "; the recording will have no labels");
    return true;
}

bool LiveRecorder::is_in_frame(const frames::Poses &poses) const
{
    return frame_.empty() || !poses.type() || poses.frame() == frame_;
}

std::string LiveRecorder::other_frame(const frames::Poses &poses) const
{
    return "the poses are in frame " + poses.frame() + ", the map's positions in " + frame_;
}

// The newest frame lies before a pose that may still come.
void LiveRecorder::await_poses(const Draft &draft)
{
    const std::vector<int64_t> &utimes = draft.recording.utime;
    const int64_t newest = *std::max_element(utimes.begin(), utimes.end());
    const int64_t due_us = program::monotonic_us() + poses_wait_us;
    const auto is_missing = [&] {
        return live_.is_log() ||
               (live_.poses().newest_utime() < newest && program::monotonic_us() < due_us);
    };
    constexpr int32_t moment_ms = 50;
    while (!live_.poses_have_ended() && is_missing())
        take_pose(draft, moment_ms);
}

void LiveRecorder::label(Draft &draft, double gap_s)
try {
    if (!live_.has_poses())
        return;
    await_poses(draft);
    const frames::Poses &poses = live_.poses();
    if (!poses.type())
        throw Error("no pose came");
    if (!is_in_frame(poses))
        throw Error(other_frame(poses));
    const frames::Track track = poses.track("poses", static_cast<int64_t>(1e6 * gap_s));
    const auto [first, last] =
        std::minmax_element(draft.recording.utime.begin(), draft.recording.utime.end());
    if (*first > track.end_utime() || *last < track.begin_utime())
        throw Error("poses and frames are of different times: the poses are from " +
                    std::to_string(track.begin_utime()) + " to " +
                    std::to_string(track.end_utime()) + " us, the frames from " +
                    std::to_string(*first) + " to " + std::to_string(*last) +
                    "; have both stamped by one clock");
    draft.recording.label_by(frames::TrackJoin(track, draft.source));
} catch (const Error &error) {
    program::tell_once(std::string(error.what()) + "; recorded without labels");
}

} // namespace vdna::record
