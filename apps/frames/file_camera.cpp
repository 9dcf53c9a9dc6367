#include "frames/file_camera.hpp"

#include "program/clock.hpp"

namespace vdna::frames
{

namespace
{

class FileCamera : public Camera
{
  public:
    explicit FileCamera(const std::string &path) : source_(path, options()) {}

    bool read(Frame &out_frame) override
    {
        Frame frame;
        if (!source_.next(frame))
            return false;
        if (frames_++ == 0)
            lag_us_ = program::monotonic_us() - frame.utime;
        program::sleep_until(frame.utime + lag_us_);
        frame.utime = program::wall_us();
        out_frame = frame;
        return true;
    }

    std::string description() const override
    {
        return "recording: " + std::to_string(source_.size()) + " frames";
    }

  private:
    static SourceOptions options()
    {
        SourceOptions options;
        options.labelled = false;
        return options;
    }

    Source source_;
    uint64_t frames_ = 0;
    int64_t lag_us_ = 0; // from the recording's time to the monotonic clock
};

} // namespace

std::unique_ptr<Camera> open_file_camera(const std::string &path)
{
    return std::make_unique<FileCamera>(path);
}

} // namespace vdna::frames
