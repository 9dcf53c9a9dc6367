// An LCM channel to which the program sends camera frames, as a driver would.
#pragma once

#include <string>

#include <vdna/cpp/connection.hpp>

namespace vdna::tool
{

class CameraChannel
{
  public:
    // url: "" = LCM's default; is_protected: frames carry a number and a checksum. Throws Error.
    CameraChannel(const std::string &url, const std::string &channel, bool is_protected);

    // utime: microseconds; name: of the frame, for complaints. Throws Error.
    void send(const vdna_image &image, int64_t utime, const std::string &name);

  private:
    vdna_status publish(const vdna_image &image, int64_t utime);

    bool is_protected_;
    vdna_transport_stream stream_{};
    Connection connection_;
    std::string channel_;
};

} // namespace vdna::tool
