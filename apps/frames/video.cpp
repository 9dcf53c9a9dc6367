// Frames of a video file.
#include <cmath>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

// OpenCV turns a video as its container says, but 4.6 turns a quarter the wrong way round
// (https://github.com/opencv/opencv/issues/22088).
bool comes_upside_down(const cv::VideoCapture &video)
{
    const double degrees = video.get(cv::CAP_PROP_ORIENTATION_META);
    return cv::getVersionMajor() == 4 && cv::getVersionMinor() == 6 &&
           (degrees == 90 || degrees == 270);
}

class VideoReader : public Reader
{
  public:
    VideoReader(const std::string &path, double rate_hz) : path_(path), rate_hz_(rate_hz)
    {
        // OpenCV would log each backend that cannot read the file; our error says so once.
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        // FFmpeg only: other backends look for cameras, load plug-ins, or treat a picture as the
        // first of a sequence.
        if (!video_.open(path, cv::CAP_FFMPEG) || video_.get(cv::CAP_PROP_FRAME_COUNT) < 1)
            throw Error(path + ": neither a folder, nor an LCM log, nor a video that OpenCV can "
                               "read; expected one of these");
        const double fps = video_.get(cv::CAP_PROP_FPS);
        if (std::isfinite(fps) && fps > 0)
            rate_hz_ = fps;
        upside_down_ = comes_upside_down(video_);
    }

    bool read(Frame &out_frame) override
    {
        if (!video_.read(picture_))
            return false;
        if (upside_down_)
            cv::flip(picture_, picture_, -1);
        out_frame.index = next_++;
        out_frame.name = path_ + ": frame " + std::to_string(out_frame.index);
        out_frame.utime = std::llround(static_cast<double>(out_frame.index) * 1e6 / rate_hz_);
        if (picture_.type() != CV_8UC3)
            throw BadFrame(out_frame.name +
                           ": not 8-bit colour, which OpenCV was expected to give");
        out_frame.image = {picture_.data,
                           picture_.step * static_cast<size_t>(picture_.rows),
                           static_cast<uint32_t>(picture_.cols),
                           static_cast<uint32_t>(picture_.rows),
                           static_cast<uint32_t>(picture_.step),
                           VDNA_PIXEL_BGR3};
        return true;
    }

    bool skip() override
    {
        next_++;
        return video_.grab();
    }

    uint64_t size() const override
    {
        return static_cast<uint64_t>(video_.get(cv::CAP_PROP_FRAME_COUNT));
    }

  private:
    std::string path_;
    double rate_hz_;
    cv::VideoCapture video_;
    cv::Mat picture_;
    bool upside_down_ = false;
    uint64_t next_ = 0;
};

} // namespace

std::unique_ptr<Reader> open_video(const std::string &path, double rate_hz)
{
    return std::make_unique<VideoReader>(path, rate_hz);
}

} // namespace vdna::frames
