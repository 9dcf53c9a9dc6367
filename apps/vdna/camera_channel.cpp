#include "vdna/camera_channel.hpp"

#include <random>

namespace vdna::tool
{

namespace
{

// A stream that no other start of any sender has, as good as certainly.
vdna_transport_stream new_stream()
{
    std::random_device random;
    return {uint64_t{random()} << 32 | random(), 0};
}

} // namespace

CameraChannel::CameraChannel(const std::string &url, const std::string &channel, bool is_protected)
    : is_protected_(is_protected), stream_(new_stream()), channel_(channel)
{
    vdna_error error{};
    require(vdna_transport_check_channel(channel.c_str(), &error), error);
    connection_ = connect_to_send(url);
}

vdna_status CameraChannel::publish(const vdna_image &image, int64_t utime)
{
    if (is_protected_)
        return vdna_transport_publish_protected_image(connection_.get(), channel_.c_str(), utime,
                                                      &image, &stream_);
    return vdna_transport_publish_image(connection_.get(), channel_.c_str(), utime, &image);
}

void CameraChannel::send(const vdna_image &image, int64_t utime, const std::string &name)
{
    const vdna_status status = publish(image, utime);
    if (status != VDNA_OK)
        throw Error(name + ": " + std::to_string(image.size) + " bytes cannot be sent: " +
                    vdna_status_text(status) + "; see to the network, or send smaller pictures");
}

} // namespace vdna::tool
