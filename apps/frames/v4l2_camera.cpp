#include "frames/v4l2_camera.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <linux/videodev2.h>
#include <sys/mman.h>

#include "program/interrupt.hpp"

namespace vdna::frames
{

namespace
{

// A format of V4L2 and its name in the message.
struct Format {
    uint32_t v4l2, pixelformat;
    // Rows of all planes, in halves of the height; 0 = JPEG, of any size.
    uint32_t half_rows;
};

// Compressed ones first, which cameras give at their full rate. V4L2's 32-bit formats are left out:
// they have the unused byte elsewhere.
constexpr std::array<Format, 9> known_formats = {{
    {V4L2_PIX_FMT_MJPEG, VDNA_PIXEL_MJPG, 0},
    {V4L2_PIX_FMT_JPEG, VDNA_PIXEL_MJPG, 0},
    {V4L2_PIX_FMT_YUYV, VDNA_PIXEL_YUYV, 2},
    {V4L2_PIX_FMT_UYVY, VDNA_PIXEL_UYVY, 2},
    {V4L2_PIX_FMT_NV12, VDNA_PIXEL_NV12, 3},
    {V4L2_PIX_FMT_YUV420, VDNA_PIXEL_YU12, 3},
    {V4L2_PIX_FMT_BGR24, VDNA_PIXEL_BGR3, 2},
    {V4L2_PIX_FMT_RGB24, VDNA_PIXEL_RGB3, 2},
    {V4L2_PIX_FMT_GREY, VDNA_PIXEL_GREY, 2},
}};

constexpr uint32_t buffers_wanted = 4;        // one is being sent, one filled, two are spare
constexpr int64_t patience_us = 5000000;      // without a frame
constexpr int64_t oldest_stamp_us = 10000000; // older ones are not believed

std::string text_of(uint32_t fourcc)
{
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const char c = static_cast<char>(fourcc >> shift & 0x7f);
        text += c >= ' ' && c <= '~' ? c : '?';
    }
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

std::string size_text(uint32_t width, uint32_t height)
{
    return std::to_string(width) + "x" + std::to_string(height);
}

// "30", "7.5".
std::string rate_text(double hz)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", hz);
    return text;
}

std::string joined(const std::vector<std::string> &words)
{
    std::string text;
    for (const std::string &word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text.empty() ? "nothing" : text;
}

// An open device; it closes itself.
class Device
{
  public:
    Device(const std::string &path, DeviceCalls &calls)
        : path_(path), calls_(calls), fd_(calls.open(path.c_str()))
    {
        if (fd_ < 0)
            fail_to_open(errno);
    }
    ~Device() { calls_.close(fd_); }
    Device(const Device &) = delete;
    Device &operator=(const Device &) = delete;

    const std::string &path() const { return path_; }
    DeviceCalls &calls() const { return calls_; }
    int fd() const { return fd_; }

    // Returns 0 or errno.
    template <typename Argument>
    int call(unsigned long request, Argument &argument) const
    {
        for (;;) {
            if (calls_.ioctl(fd_, request, &argument) >= 0)
                return 0;
            if (errno != EINTR)
                return errno;
            program::require_not_interrupted();
        }
    }

    [[noreturn]] void fail(const std::string &sentence) const
    {
        throw Error(path_ + ": " + sentence);
    }

    // task: "set the format". number: errno
    [[noreturn]] void fail(const std::string &task, int number) const
    {
        if (number == ENODEV || number == ENXIO)
            fail("the camera is gone; see to its plug and cable");
        if (number == EBUSY)
            fail("another program uses this camera (cannot " + task + "); end it; `fuser " + path_ +
                 "` tells which");
        if (number == ENOSPC)
            fail("the USB bus has no room for this camera's pictures; ask for a smaller --size or "
                 "--rate or --format MJPG, or plug it in elsewhere");
        fail("cannot " + task + ": " + std::strerror(number) + "; plug the camera in again");
    }

  private:
    [[noreturn]] void fail_to_open(int number) const
    {
        if (number == ENOENT)
            fail("no such device, expected a camera that is plugged in; `ls /dev/video*` lists "
                 "them");
        if (number == EACCES || number == EPERM)
            fail("no permission to use this camera, which the group video has; run `sudo usermod "
                 "-aG video $USER` and log in again");
        fail("open it", number);
    }

    std::string path_;
    DeviceCalls &calls_;
    int fd_;
};

// A buffer of the driver; it unmaps itself.
class Buffer
{
  public:
    Buffer(const Device &device, size_t size, int64_t offset)
        : calls_(&device.calls()), data_(calls_->mmap(device.fd(), size, offset)), size_(size)
    {
        if (data_ == MAP_FAILED)
            device.fail("map a buffer", errno);
    }
    ~Buffer()
    {
        if (data_)
            calls_->munmap(data_, size_);
    }
    Buffer(Buffer &&other) noexcept
        : calls_(other.calls_), data_(std::exchange(other.data_, nullptr)), size_(other.size_)
    {
    }
    Buffer(const Buffer &) = delete;
    Buffer &operator=(const Buffer &) = delete;
    Buffer &operator=(Buffer &&) = delete;

    const uint8_t *data() const { return static_cast<const uint8_t *>(data_); }
    size_t size() const { return size_; }

  private:
    DeviceCalls *calls_;
    void *data_;
    size_t size_; // bytes
};

// The camera's name.
std::string require_camera(const Device &device)
{
    v4l2_capability found{};
    const int number = device.call(VIDIOC_QUERYCAP, found);
    if (number == ENOTTY || number == EINVAL)
        device.fail("not a camera, expected a V4L2 device such as /dev/video0");
    if (number != 0)
        device.fail("ask what it is", number);
    const uint32_t can =
        found.capabilities & V4L2_CAP_DEVICE_CAPS ? found.device_caps : found.capabilities;
    const std::string name(reinterpret_cast<const char *>(found.card),
                           strnlen(reinterpret_cast<const char *>(found.card), sizeof found.card));
    if (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE && !(can & V4L2_CAP_VIDEO_CAPTURE))
        device.fail(name + " gives each plane of a picture in a buffer of its own, expected one "
                           "buffer; use a node of this camera that converts them");
    if (!(can & V4L2_CAP_VIDEO_CAPTURE))
        device.fail(name + " gives no pictures at this node, which is for metadata or output; try "
                           "the others of /dev/video*");
    if (!(can & V4L2_CAP_STREAMING))
        device.fail(name + " does not stream into buffers, which is the only way supported");
    return name;
}

std::vector<uint32_t> offered_formats(const Device &device)
{
    std::vector<uint32_t> offered;
    v4l2_fmtdesc format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (; device.call(VIDIOC_ENUM_FMT, format) == 0; format.index++)
        offered.push_back(format.pixelformat);
    return offered;
}

std::string offered_text(const std::vector<uint32_t> &offered)
{
    std::vector<std::string> names;
    std::transform(offered.begin(), offered.end(), std::back_inserter(names), text_of);
    return joined(names);
}

Format choose_format(const Device &device, const std::string &wanted)
{
    const std::vector<uint32_t> offered = offered_formats(device);
    for (const Format &format : known_formats)
        if ((wanted.empty() || wanted == text_of(format.v4l2)) &&
            std::find(offered.begin(), offered.end(), format.v4l2) != offered.end())
            return format;
    device.fail("offers " + offered_text(offered) + ", expected " +
                (wanted.empty() ? "one of " + joined(v4l2_formats())
                                : wanted + "; choose another --format"));
}

std::string offered_sizes(const Device &device, uint32_t v4l2)
{
    std::vector<std::string> sizes;
    v4l2_frmsizeenum size{};
    size.pixel_format = v4l2;
    for (; device.call(VIDIOC_ENUM_FRAMESIZES, size) == 0; size.index++) {
        if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE)
            return size_text(size.stepwise.min_width, size.stepwise.min_height) + " to " +
                   size_text(size.stepwise.max_width, size.stepwise.max_height);
        sizes.push_back(size_text(size.discrete.width, size.discrete.height));
    }
    return joined(sizes);
}

v4l2_pix_format set_format(const Device &device, const Format &format, const V4l2Settings &settings)
{
    v4l2_format request{};
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (const int number = device.call(VIDIOC_G_FMT, request))
        device.fail("ask for its format", number);
    v4l2_pix_format &picture = request.fmt.pix;
    if (settings.width != 0) {
        picture.width = settings.width;
        picture.height = settings.height;
    }
    picture.pixelformat = format.v4l2;
    picture.field = V4L2_FIELD_NONE;
    picture.bytesperline = picture.sizeimage = 0; // the driver's to say
    if (const int number = device.call(VIDIOC_S_FMT, request))
        device.fail("set the format", number);

    // A driver answers with the nearest that it can do.
    if (picture.pixelformat != format.v4l2)
        device.fail("gives " + text_of(picture.pixelformat) + ", expected " + text_of(format.v4l2) +
                    "; choose another --format");
    if (settings.width != 0 &&
        (picture.width != settings.width || picture.height != settings.height))
        device.fail("gives no " + size_text(settings.width, settings.height) + " as " +
                    text_of(format.v4l2) +
                    ", expected one of its sizes: " + offered_sizes(device, format.v4l2));
    return picture;
}

// The rate that the camera has then; 0 = its driver does not say.
double set_rate(const Device &device, double wanted_hz)
{
    v4l2_streamparm request{};
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_captureparm &capture = request.parm.capture;
    const bool can_set = device.call(VIDIOC_G_PARM, request) == 0 &&
                         (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0;
    if (can_set && wanted_hz > 0) {
        constexpr uint32_t thousandths = 1000;
        capture.timeperframe = {thousandths,
                                static_cast<uint32_t>(std::lround(wanted_hz * thousandths))};
        if (const int number = device.call(VIDIOC_S_PARM, request))
            device.fail("set the rate", number);
    }
    const v4l2_fract &period = capture.timeperframe;
    const double hz =
        can_set && period.numerator > 0 ? double(period.denominator) / period.numerator : 0;
    // 30 Hz may be 30000/1001.
    if (wanted_hz > 0 && std::abs(hz - wanted_hz) > 0.01 * wanted_hz)
        device.fail((hz > 0 ? "gives " + rate_text(hz) + " Hz" : "has no rate that can be set") +
                    ", expected " + rate_text(wanted_hz) +
                    " Hz; leave out --rate, or choose "
                    "another --size or --format");
    return hz;
}

// The buffer of this number, to ask the driver about.
v4l2_buffer buffer_of(uint32_t index)
{
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
}

std::vector<Buffer> map_buffers(const Device &device)
{
    v4l2_requestbuffers request{};
    request.count = buffers_wanted;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (const int number = device.call(VIDIOC_REQBUFS, request))
        device.fail("get buffers", number);
    std::vector<Buffer> buffers;
    for (uint32_t i = 0; i < request.count; i++) {
        v4l2_buffer buffer = buffer_of(i);
        if (const int number = device.call(VIDIOC_QUERYBUF, buffer))
            device.fail("get a buffer", number);
        buffers.emplace_back(device, buffer.length, buffer.m.offset);
    }
    return buffers;
}

bool is_whole_jpeg(const uint8_t *data, size_t size)
{
    // The end is not at the end: cameras pad. Within a picture these two bytes never follow each
    // other.
    const std::string_view bytes(reinterpret_cast<const char *>(data), size);
    return bytes.substr(0, 2) == "\xFF\xD8" && bytes.rfind("\xFF\xD9") != bytes.npos;
}

class V4l2Camera : public Camera
{
  public:
    V4l2Camera(const std::string &path, const V4l2Settings &settings, DeviceCalls &calls)
        : device_(path, calls), name_(require_camera(device_)),
          format_(choose_format(device_, settings.format)),
          picture_(set_format(device_, format_, settings)),
          rate_hz_(set_rate(device_, settings.rate_hz)), buffers_(map_buffers(device_))
    {
        for (uint32_t i = 0; i < buffers_.size(); i++)
            give_back(i);
        int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        if (const int number = device_.call(VIDIOC_STREAMON, type))
            device_.fail("start it", number);
    }

    bool read(Frame &out_frame) override
    {
        constexpr int moment_ms = 100;
        give_back_held();
        const int64_t deadline_us = device_.calls().monotonic_us() + patience_us;
        while (!program::interrupted()) {
            const int ready = device_.calls().poll(device_.fd(), moment_ms);
            if (ready < 0 && errno != EINTR)
                device_.fail("wait for a frame", errno);
            if (ready > 0 && take(out_frame))
                return true;
            if (device_.calls().monotonic_us() > deadline_us)
                device_.fail("no frame for " + std::to_string(patience_us / 1000000) +
                             " s; plug the camera in again, or end the program that holds it");
        }
        return false;
    }

    std::string description() const override
    {
        return name_ + ": " + size_text(picture_.width, picture_.height) + " " +
               text_of(format_.v4l2) + (rate_hz_ > 0 ? ", " + rate_text(rate_hz_) + " Hz" : "");
    }

    CameraLosses losses() const override { return losses_; }

  private:
    void give_back(uint32_t index)
    {
        v4l2_buffer buffer = buffer_of(index);
        if (const int number = device_.call(VIDIOC_QBUF, buffer))
            device_.fail("give a buffer back", number);
    }

    void give_back_held()
    {
        if (held_)
            give_back(*held_);
        held_.reset();
    }

    // Take a frame out of the driver's queue; false if there was none, or a damaged one.
    bool take(Frame &out_frame)
    {
        v4l2_buffer buffer{};
        buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        buffer.memory = V4L2_MEMORY_MMAP;
        const int number = device_.call(VIDIOC_DQBUF, buffer);
        if (number == EAGAIN)
            return false;
        if (number != 0)
            device_.fail("take a frame", number);
        if (buffer.index >= buffers_.size())
            device_.fail("its driver gives a buffer that does not exist; report this to its maker");
        held_ = buffer.index;
        count_dropped(buffer.sequence);
        if (!is_whole(buffer)) {
            losses_.damaged++;
            give_back_held();
            return false;
        }
        fill(out_frame, buffer);
        return true;
    }

    // Frames that the driver could not deliver leave a gap in the numbers.
    void count_dropped(uint32_t sequence)
    {
        const auto step = static_cast<int32_t>(sequence - sequence_);
        if (taken_ > 0 && step > 1)
            losses_.dropped += static_cast<uint64_t>(step) - 1;
        sequence_ = sequence;
        taken_++;
    }

    bool is_whole(const v4l2_buffer &buffer) const
    {
        const Buffer &mapped = buffers_[buffer.index];
        if (buffer.flags & V4L2_BUF_FLAG_ERROR || buffer.bytesused > mapped.size())
            return false;
        if (format_.half_rows == 0)
            return is_whole_jpeg(mapped.data(), buffer.bytesused);
        return buffer.bytesused >=
               uint64_t{picture_.bytesperline} * picture_.height * format_.half_rows / 2;
    }

    void fill(Frame &out_frame, const v4l2_buffer &buffer)
    {
        out_frame.index = frames_++;
        out_frame.name = device_.path() + ": frame " + std::to_string(out_frame.index);
        out_frame.utime = utime_of(buffer);
        out_frame.image = {buffers_[buffer.index].data(),
                           buffer.bytesused,
                           picture_.width,
                           picture_.height,
                           format_.half_rows > 0 ? picture_.bytesperline : 0,
                           format_.pixelformat};
    }

    // A driver stamps a frame by the monotonic clock; other stamps, and impossible ones, which some
    // USB cameras cause, are replaced by the time of arrival.
    int64_t utime_of(const v4l2_buffer &buffer) const
    {
        const int64_t wall_us = device_.calls().wall_us();
        if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
            return wall_us;
        const int64_t age_us =
            device_.calls().monotonic_us() -
            (int64_t{buffer.timestamp.tv_sec} * 1000000 + buffer.timestamp.tv_usec);
        return age_us >= 0 && age_us <= oldest_stamp_us ? wall_us - age_us : wall_us;
    }

    Device device_;
    std::string name_;
    Format format_;
    v4l2_pix_format picture_;
    double rate_hz_;
    std::vector<Buffer> buffers_;
    std::optional<uint32_t> held_; // the buffer of the frame that was handed out
    uint64_t taken_ = 0;           // frames, damaged ones included
    uint64_t frames_ = 0;          // handed out
    uint32_t sequence_ = 0;        // of the last one taken
    CameraLosses losses_;
};

} // namespace

std::vector<std::string> v4l2_formats()
{
    std::vector<std::string> names;
    for (const Format &format : known_formats)
        names.push_back(text_of(format.v4l2));
    return names;
}

std::unique_ptr<Camera> open_v4l2_camera(const std::string &path, const V4l2Settings &settings,
                                         DeviceCalls &calls)
{
    return std::make_unique<V4l2Camera>(path, settings, calls);
}

} // namespace vdna::frames
