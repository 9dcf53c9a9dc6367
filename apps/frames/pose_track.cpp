#include "frames/pose_track.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <set>

#include <bot_core_gps_data_t.h>
#include <bot_core_pose_t.h>
#include <vdna_messages.h>

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>
#include <vdna/transport.h>

#include "frames/log_events.hpp"
#include "program/notice.hpp"

namespace vdna::frames
{

namespace
{

using Message = std::vector<uint8_t>;

std::vector<Message> messages_of(const std::string &log, const std::vector<LogEvent> &events)
{
    std::ifstream stream(log, std::ios::binary);
    std::vector<Message> messages;
    for (const LogEvent &event : events)
        read_message(stream, event, log, messages.emplace_back());
    return messages;
}

// Plausible enough to compute with.
bool is_usable(int64_t utime, const double *numbers, size_t count, double limit)
{
    constexpr int64_t furthest_us = 4000000000000000000; // differences fit
    return utime >= -furthest_us && utime <= furthest_us &&
           std::all_of(numbers, numbers + count,
                       [=](double number) { return std::abs(number) <= limit; });
}

// Nothing if there is no position that can be used.
std::optional<Track::Point> point_of(const bot_core_pose_t &pose)
{
    constexpr double furthest_m = 1e9;
    if (!is_usable(pose.utime, pose.pos, 3, furthest_m))
        return {};
    return Track::Point{pose.utime, {{pose.pos[0], pose.pos[1], pose.pos[2]}}};
}

std::optional<Fix> fix_of(const bot_core_gps_data_t &fix)
{
    const double numbers[] = {fix.latitude, fix.longitude, fix.elev};
    if (fix.gps_lock == 0 || !is_usable(fix.utime, numbers, 3, 1e6))
        return {};
    return Fix{fix.utime, fix.latitude, fix.longitude, fix.elev};
}

// The message has been checked and holds no pointers, so there is nothing to free.
template <typename Struct>
Struct decoded(const vdna_message_type &type, const Message &message)
{
    Struct out{};
    type.decode(message.data(), static_cast<int32_t>(message.size()), &out);
    return out;
}

// Take a message whose type nobody has said: that of those before it, if there are any.
bool take(const Message &message, Poses &poses)
{
    const auto is_of = [&](const vdna_message_type &type) {
        return vdna_transport_check(&type, message.data(), message.size()) == VDNA_OK;
    };
    if (is_of(vdna_message_pose)) {
        const auto pose = decoded<bot_core_pose_t>(vdna_message_pose, message);
        return poses.take(vdna_message_pose, &pose);
    }
    if (is_of(vdna_message_gps_data)) {
        const auto fix = decoded<bot_core_gps_data_t>(vdna_message_gps_data, message);
        return poses.take(vdna_message_gps_data, &fix);
    }
    return false;
}

// The messages of one log.
void read_poses(const std::string &log, const std::string &channel, Poses &poses,
                std::set<std::string> &channels)
{
    const LogContents contents = read_log(log, channel);
    channels.insert(contents.channels.begin(), contents.channels.end());
    size_t number = 0;
    for (const Message &message : messages_of(log, contents.events)) {
        const std::string name = log + ": message " + std::to_string(number++) + " on " + channel;
        if (!take(message, poses))
            throw Error(name + " has fingerprint " + fingerprint_text(fingerprint_of(message)) +
                        " and " + std::to_string(message.size()) + " bytes, expected " +
                        (poses.type() ? poses.type()->name + std::string(" as before it")
                                      : "bot_core.pose_t or bot_core.gps_data_t") +
                        "; set --pose-channel to a channel of that type");
    }
}

// Keep the positions next to a frame, and the newest ones. utimes: of the frames, ascending.
template <typename Position>
void keep_needed(std::vector<Position> &positions, const std::vector<int64_t> &utimes,
                 size_t newest)
{
    std::stable_sort(positions.begin(), positions.end(),
                     [](const Position &a, const Position &b) { return a.utime < b.utime; });
    const size_t old = positions.size() - std::min(newest, positions.size());
    size_t kept = 0;
    int64_t before = std::numeric_limits<int64_t>::min(); // of the position before, kept or not
    for (size_t i = 0; i < positions.size(); i++) {
        const int64_t utime = positions[i].utime;
        const auto frame = std::upper_bound(utimes.begin(), utimes.end(), before);
        if (i >= old || (frame != utimes.end() && *frame < positions[i + 1].utime))
            positions[kept++] = positions[i];
        before = utime;
    }
    positions.resize(kept);
}

} // namespace

bool Poses::take(const vdna_message_type &type, const void *message)
{
    if (type_ && type_ != &type)
        return false;
    type_ = &type;
    const bool is_gps = type_ == &vdna_message_gps_data;
    const std::optional<Fix> fix =
        is_gps ? fix_of(*static_cast<const bot_core_gps_data_t *>(message)) : std::nullopt;
    const std::optional<Track::Point> point =
        is_gps ? std::nullopt : point_of(*static_cast<const bot_core_pose_t *>(message));
    if (fix)
        fixes_.fixes.push_back(*fix);
    if (point)
        points_.push_back(*point);
    if (!fix && !point)
        fixes_.unplaced++;
    else
        newest_utime_ = std::max(newest_utime_, fix ? fix->utime : point->utime);
    return true;
}

void Poses::reserve(size_t positions)
{
    points_.reserve(positions);
    fixes_.fixes.reserve(positions);
}

void Poses::thin(const std::vector<int64_t> &utimes, size_t newest)
{
    std::vector<int64_t> sorted = utimes;
    std::sort(sorted.begin(), sorted.end());
    keep_needed(points_, sorted, newest);
    keep_needed(fixes_.fixes, sorted, newest);
}

std::string Poses::frame() const
{
    return !type_ ? "" : type_ == &vdna_message_gps_data ? VDNA_FRAME_WGS84 : local_;
}

Track Poses::track(const std::string &name, int64_t gap_us) const
{
    if (type_ == &vdna_message_gps_data)
        return Track::of_fixes(name, fixes_, gap_us);
    if (points_.empty())
        throw Error(name + ": none of its poses has a finite position");
    if (fixes_.unplaced > 0)
        program::tell_once(name + ": " + std::to_string(fixes_.unplaced) +
                           " poses without a finite position left out");
    return Track(name, local_, points_, gap_us);
}

Track read_pose_track(const std::vector<std::string> &logs, const std::string &channel,
                      const std::string &local, int64_t gap_us)
{
    Poses poses(local);
    std::set<std::string> channels;
    for (const std::string &log : logs)
        read_poses(log, channel, poses, channels);
    if (!poses.type())
        throw Error(logs.front() + ": no message on channel " + channel +
                    ", expected poses; set --pose-channel to one of:" + listed(channels));
    return poses.track(logs.front(), gap_us);
}

} // namespace vdna::frames
