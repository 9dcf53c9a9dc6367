#include "frames/pose_track.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <bot_core_gps_data_t.h>
#include <bot_core_pose_t.h>
#include <vdna_messages.h>

#include <vdna/cpp/error.hpp>
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

class PoseReader
{
  public:
    PoseReader(const std::string &channel) : channel_(channel) {}

    void read(const std::string &log)
    {
        const LogContents contents = read_log(log, channel_);
        channels_.insert(contents.channels.begin(), contents.channels.end());
        size_t number = 0;
        for (const Message &message : messages_of(log, contents.events))
            take(message, log + ": message " + std::to_string(number++) + " on " + channel_);
    }

    Track track(const std::string &name, const std::string &local, int64_t gap_us) const
    {
        if (!type_)
            throw Error(name + ": no message on channel " + channel_ +
                        ", expected poses; set --pose-channel to one of:" + listed(channels_));
        if (type_ == &vdna_message_gps_data)
            return Track::of_fixes(name, fixes_, gap_us);
        if (points_.empty())
            throw Error(name + ": none of its poses has a finite position");
        if (fixes_.unplaced > 0)
            program::tell_once(name + ": " + std::to_string(fixes_.unplaced) +
                               " poses without a finite position left out");
        return Track(name, local, points_, gap_us);
    }

  private:
    // The first message decides which type all have.
    void take(const Message &message, const std::string &name)
    {
        const auto is_of = [&](const vdna_message_type &type) {
            return (!type_ || type_ == &type) &&
                   vdna_transport_check(&type, message.data(), message.size()) == VDNA_OK;
        };
        if (is_of(vdna_message_pose))
            take_pose(message);
        else if (is_of(vdna_message_gps_data))
            take_fix(message);
        else
            throw Error(name + " has fingerprint " + fingerprint_text(fingerprint_of(message)) +
                        " and " + std::to_string(message.size()) + " bytes, expected " +
                        (type_ ? type_->name + std::string(" as before it")
                               : "bot_core.pose_t or bot_core.gps_data_t") +
                        "; set --pose-channel to a channel of that type");
    }

    void take_pose(const Message &message)
    {
        type_ = &vdna_message_pose;
        constexpr double furthest_m = 1e9;
        bot_core_pose_t pose{};
        decode(message, pose);
        if (is_usable(pose.utime, pose.pos, 3, furthest_m))
            points_.push_back({pose.utime, {{pose.pos[0], pose.pos[1], pose.pos[2]}}});
        else
            fixes_.unplaced++;
    }

    void take_fix(const Message &message)
    {
        type_ = &vdna_message_gps_data;
        bot_core_gps_data_t fix{};
        decode(message, fix);
        const double numbers[] = {fix.latitude, fix.longitude, fix.elev};
        if (fix.gps_lock != 0 && is_usable(fix.utime, numbers, 3, 1e6))
            fixes_.fixes.push_back({fix.utime, fix.latitude, fix.longitude, fix.elev});
        else
            fixes_.unplaced++;
    }

    // The message has been checked and holds no pointers, so there is nothing to free.
    template <typename Struct>
    void decode(const Message &message, Struct &out) const
    {
        type_->decode(message.data(), static_cast<int32_t>(message.size()), &out);
    }

    std::string channel_;
    std::set<std::string> channels_;
    const vdna_message_type *type_ = nullptr;
    std::vector<Track::Point> points_; // of poses
    TrackFile fixes_;                  // of GPS; its count of unplaced ones for both
};

} // namespace

Track read_pose_track(const std::vector<std::string> &logs, const std::string &channel,
                      const std::string &local, int64_t gap_us)
{
    PoseReader reader(channel);
    for (const std::string &log : logs)
        reader.read(log);
    return reader.track(logs.front(), local, gap_us);
}

} // namespace vdna::frames
