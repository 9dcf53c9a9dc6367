// Frames of a video file.
#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "frames/ffmpeg_errors.hpp"
#include "frames/opencv_image.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

// Frames by which the header of a sound video may be wrong: some containers only know a duration.
constexpr uint64_t count_tolerance = 1;

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
        if (!video_.open(path, cv::CAP_FFMPEG))
            throw Error(path +
                        ": neither a folder, nor an LCM log, nor an MCAP file, nor a video that "
                        "OpenCV can read; expected one of these");
        collect_ffmpeg_errors(); // opening a video sets OpenCV's own
        // Streams, and recordings whose writer could not go back, do not say how many they hold.
        const double count = video_.get(cv::CAP_PROP_FRAME_COUNT);
        const double fps = video_.get(cv::CAP_PROP_FPS);
        if (count >= 1 && fps > 0) {
            size_ = static_cast<uint64_t>(count);
            duration_us_ = count / fps * 1e6;
        }
        upside_down_ = comes_upside_down(video_);
    }

    bool read(Frame &out_frame) override
    {
        if (!grab() || !video_.retrieve(picture_))
            return end();
        if (upside_down_)
            cv::flip(picture_, picture_, -1);
        out_frame.index = next_ - 1;
        out_frame.name = path_ + ": frame " + std::to_string(out_frame.index);
        out_frame.utime = utime_;
        reason_ = take_ffmpeg_error();
        // If no frame follows, the video breaks off behind this one.
        is_ahead_ = !reason_.empty() && advance();
        if (is_ahead_)
            throw BadFrame(out_frame.name + ": damaged: " + reason_);
        out_frame.image = image_of(picture_, out_frame.name);
        return true;
    }

    bool skip() override { return grab() || end(); }

    uint64_t size() const override { return size_; }

    void describe(Account &account) const override
    {
        account.order = "video";
        if (!has_times_)
            account.notes.push_back("its pictures have no times: taken to be " +
                                    program::fixed(rate_hz_, 1) + " a second (--rate)");
    }

  private:
    bool grab() { return std::exchange(is_ahead_, false) || advance(); }

    // Go to the next frame and find out its time: the container's, or without one that of a regular
    // beat. What FFmpeg says of the rate then is often a guess.
    bool advance()
    {
        // After its end OpenCV would hand out the last frame again.
        has_ended_ = has_ended_ || !video_.grab();
        if (has_ended_)
            return false;
        // The first frame is at 0. OpenCV also gives 0 for the last frames, those that come out of
        // the decoder when the file has ended, and 0 or less where the container has no times.
        const double container_ms = video_.get(cv::CAP_PROP_POS_MSEC);
        if (next_ == 1)
            has_times_ = container_ms > 0;
        if (!has_times_)
            size_ = 0; // bare pictures in a row: FFmpeg guesses their number from the bit rate
        const int64_t before = utime_;
        if (has_times_ && (container_ms > 0 || next_ == 0))
            utime_ = std::llround(std::max(container_ms, 0.0) * 1e3);
        else if (has_times_)
            utime_ += spacing_;
        else
            utime_ = std::llround(static_cast<double>(next_) * 1e6 / rate_hz_);
        spacing_ = utime_ - before;
        next_++;
        return true;
    }

    // Whether frames are missing by their number and by the time they would take: of a video whose
    // frames come irregularly, FFmpeg only knows how long it is.
    bool is_short() const
    {
        const double end_us = static_cast<double>(utime_ + 2 * spacing_);
        return size_ > next_ + count_tolerance && end_us < duration_us_;
    }

    // False; complains once if the video ends too early.
    bool end()
    {
        if (std::exchange(has_complained_, true))
            return false;
        const uint64_t missing = is_short() ? size_ - next_ : 0;
        if (missing == 0 && size_ > 0)
            size_ = next_; // no longer an estimate
        const std::string last = take_ffmpeg_error();
        const std::string &reason = last.empty() ? reason_ : last;
        if (missing == 0 && reason.empty())
            return false;
        const std::string sentence = path_ + ": ends after " + std::to_string(next_) +
                                     (size_ > 0 ? " of " + std::to_string(size_) : "") + " frames" +
                                     (reason.empty() ? "" : " (" + reason + ")") +
                                     ": cut short or damaged";
        throw BadFrame(sentence, std::max<uint64_t>(missing, 1));
    }

    std::string path_;
    double rate_hz_;
    uint64_t size_ = 0;      // 0 = unknown; may be an estimate
    double duration_us_ = 0; // while the size is known
    std::string reason_;     // FFmpeg's complaint about the frame read last
    bool is_ahead_ = false;  // a frame beyond it was grabbed already
    bool has_times_ = true;
    cv::VideoCapture video_;
    cv::Mat picture_;
    bool upside_down_ = false;
    bool has_ended_ = false;
    bool has_complained_ = false; // of the end, if there was anything to complain of
    uint64_t next_ = 0;
    int64_t utime_ = 0;   // of the frame grabbed last
    int64_t spacing_ = 0; // between this one and the one before it
};

} // namespace

std::unique_ptr<Reader> open_video(const std::string &path, double rate_hz)
{
    return std::make_unique<VideoReader>(path, rate_hz);
}

} // namespace vdna::frames
