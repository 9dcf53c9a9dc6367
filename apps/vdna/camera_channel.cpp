#include "vdna/camera_channel.hpp"

namespace vdna::tool
{

namespace
{

Connection connect_to(const std::string &url)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url.empty() ? nullptr : url.c_str();
    return connect(config);
}

} // namespace

CameraChannel::CameraChannel(const std::string &url, const std::string &channel) : channel_(channel)
{
    vdna_error error{};
    require(vdna_transport_check_channel(channel.c_str(), &error), error);
    connection_ = connect_to(url);
}

void CameraChannel::send(const vdna_image &image, int64_t utime, const std::string &name)
{
    const vdna_status status =
        vdna_transport_publish_image(connection_.get(), channel_.c_str(), utime, &image);
    if (status != VDNA_OK)
        throw Error(name + ": " + std::to_string(image.size) + " bytes cannot be sent: " +
                    vdna_status_text(status) + "; see to the network, or send smaller pictures");
}

} // namespace vdna::tool
