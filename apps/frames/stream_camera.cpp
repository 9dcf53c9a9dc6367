#include "frames/stream_camera.hpp"

#include <vector>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "frames/opencv_image.hpp"
#include "program/clock.hpp"
#include "program/interrupt.hpp"

namespace vdna::frames
{

namespace
{

constexpr int patience_ms = 5000; // without a frame

// What people and logs may see of rtsp://user:password@host/path.
std::string without_password(const std::string &url)
{
    const size_t begin = url.find("://") + 3;
    const size_t end = url.find('/', begin), at = url.rfind('@', end);
    return at == url.npos || at < begin ? url : url.substr(0, begin) + url.substr(at + 1);
}

class StreamCamera : public Camera
{
  public:
    explicit StreamCamera(const std::string &url) : name_(without_password(url))
    {
        // OpenCV would log each failure in words of its own.
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        if (!video_.open(url, cv::CAP_FFMPEG,
                         {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, patience_ms,
                          cv::CAP_PROP_READ_TIMEOUT_MSEC, patience_ms}))
            throw Error(name_ + ": no video is received, expected a stream that FFmpeg reads; see "
                                "to the address, the password and the network");
    }

    bool read(Frame &out_frame) override
    {
        if (program::interrupted())
            return false;
        const int64_t begin_us = program::monotonic_us();
        if (!video_.read(picture_)) {
            if (program::interrupted())
                return false;
            fail_to_read(program::monotonic_us() - begin_us);
        }
        out_frame.utime = program::wall_us();
        out_frame.index = frames_++;
        out_frame.name = name_ + ": frame " + std::to_string(out_frame.index);
        out_frame.image = image_of(picture_, out_frame.name);
        return true;
    }

    std::string description() const override
    {
        const auto pixels = [this](int side) {
            return std::to_string(static_cast<int>(video_.get(side)));
        };
        return "stream: " + pixels(cv::CAP_PROP_FRAME_WIDTH) + "x" +
               pixels(cv::CAP_PROP_FRAME_HEIGHT) + " BGR3";
    }

  private:
    [[noreturn]] void fail_to_read(int64_t waited_us) const
    {
        const std::string after = " after " + std::to_string(frames_) + " frames";
        if (waited_us >= int64_t{patience_ms} * 1000)
            throw Error(name_ + ": no frame for " + std::to_string(patience_ms / 1000) + " s" +
                        after + "; see to the camera and the network, or set --reconnect");
        throw Error(name_ + ": the stream ended" + after +
                    "; see to the camera, or set --reconnect");
    }

    std::string name_;
    cv::VideoCapture video_;
    cv::Mat picture_;
    uint64_t frames_ = 0;
};

} // namespace

std::unique_ptr<Camera> open_stream_camera(const std::string &url)
{
    return std::make_unique<StreamCamera>(url);
}

} // namespace vdna::frames
