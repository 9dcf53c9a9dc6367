#include "frames/live.hpp"

#include <vdna_messages.h>

#include <vdna/cpp/error.hpp>

#include "program/notice.hpp"

namespace vdna::frames
{

namespace
{

constexpr int32_t moment_ms = 50;

vdna_transport_config camera_config(const LiveOptions &options)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url_or_default(options.url);
    config.camera_channel = options.camera.c_str();
    return config;
}

Listener listen_to_poses(const LiveOptions &options)
{
    if (options.pose_channel.empty())
        return {};
    const vdna_listener_channel channels[] = {
        {options.pose_channel.c_str(), &vdna_message_pose},
        {options.pose_channel.c_str(), &vdna_message_gps_data}};
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = url_or_default(options.url);
    config.channels = channels;
    config.channel_count = 2;
    return open_listener(config);
}

} // namespace

Live::Live(const LiveOptions &options)
    : options_(options), is_log_(vdna_transport_is_log(url_or_default(options.url)) != 0),
      connection_(connect(camera_config(options))), listener_(listen_to_poses(options)),
      poses_(options.local_frame)
{
    vdna_camera_time_init(&time_, options.time_unit, static_cast<int64_t>(options.late_s * 1e6));
}

bool Live::next(Frame &out_frame)
{
    uint32_t events = 0;
    vdna_transport_frame camera;
    if (vdna_transport_poll(connection_.get(), moment_ms, &events, &camera) != VDNA_OK) {
        has_ended_ = true;
        return false;
    }
    if (!(events & VDNA_TRANSPORT_FRAME))
        return false;
    out_frame = {};
    out_frame.index = frames_++;
    out_frame.name = options_.camera + ": frame " + std::to_string(out_frame.index);
    out_frame.image = camera.image;
    order_ = vdna_camera_time_take(&time_, camera.utime, &out_frame.utime);
    return order_ != VDNA_TIME_LATE;
}

bool Live::take_pose(int32_t timeout_ms)
{
    if (poses_have_ended())
        return false;
    vdna_listener_message message;
    if (vdna_listener_poll(listener_.get(), timeout_ms, &message) != VDNA_OK) {
        poses_ended_ = true;
        return false;
    }
    if (!message.type)
        return false;
    // Each message comes once as a pose and once as a fix.
    refusals_ = message.data ? 0 : refusals_ + 1;
    const bool is_taken = message.data && poses_.take(*message.type, message.data);
    if (refusals_ > 1 || (message.data && !is_taken))
        program::tell_once(options_.pose_channel + ": a message of " +
                           std::to_string(message.size) + " bytes is left out, expected " +
                           (poses_.type() ? poses_.type()->name + std::string(" as before it")
                                          : "bot_core.pose_t or bot_core.gps_data_t") +
                           "; set --pose-channel to a channel of that type");
    return true;
}

void Live::begin_counting()
{
    before_ = *vdna_transport_count(connection_.get());
}

LiveCounts Live::counts() const
{
    const vdna_transport_counters &now = *vdna_transport_count(connection_.get());
    LiveCounts counts;
    counts.received = now.received - before_.received;
    counts.skipped = now.skipped - before_.skipped + now.oversized - before_.oversized;
    // Numbers of the camera's own tell more than those of all its messages.
    counts.lost =
        now.stream_count > 0 ? now.lost_frames - before_.lost_frames : now.lost - before_.lost;
    counts.rejected = now.camera_rejected - before_.camera_rejected;
    counts.late = time_.late;
    counts.backwards = time_.backwards;
    return counts;
}

uint64_t Live::memory_bytes() const
{
    const vdna_transport_config config = camera_config(options_);
    vdna_transport_memory memory{};
    vdna_transport_memory_of(&config, &memory);
    return memory.own_bytes + memory.lcm_bytes;
}

} // namespace vdna::frames
