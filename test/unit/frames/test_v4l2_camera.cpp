// V4L2 cameras, played by the test in place of a driver.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include <linux/videodev2.h>
#include <sys/mman.h>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "frames/v4l2_camera.hpp"

using vdna::frames::Camera;
using vdna::frames::Frame;
using vdna::frames::V4l2Settings;

namespace
{

constexpr int64_t second_us = 1000000;
constexpr int64_t wall_start_us = 1700000000 * second_us;
constexpr uint32_t monotonic_stamps = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;

const std::string jpeg = "\xFF\xD8 picture \xFF\xD9";

// What the driver does when a frame is asked for.
struct Event {
    int error = 0; // errno of VIDIOC_DQBUF; else a frame:
    std::string data;
    uint32_t sequence = 0;
    int64_t age_us = 0; // of its stamp
    uint32_t flags = monotonic_stamps;
};

// A camera of 4x2 pixels, with the faults that a test gives it.
class PlayedCamera : public vdna::frames::DeviceCalls
{
  public:
    std::vector<uint32_t> formats = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
    std::vector<uint32_t> rates_hz = {15, 30};
    uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    uint32_t row_padding = 0;
    std::deque<Event> events;
    int open_error = 0;
    unsigned long failing_request = 0; // with `error`
    int error = 0;
    int64_t now_us = 50 * second_us;

    // What the program did.
    bool is_open = false;
    std::vector<std::vector<uint8_t>> buffers;
    std::deque<uint32_t> queued;
    int mapped = 0;
    size_t queued_at_last_take = 0;
    v4l2_pix_format picture{};

    int open(const char *) override
    {
        errno = open_error;
        is_open = open_error == 0;
        return open_error == 0 ? 7 : -1;
    }
    int close(int) override
    {
        is_open = false;
        return 0;
    }
    void *mmap(int, size_t size, int64_t offset) override
    {
        mapped++;
        assert_int_equal(size, 4096);
        return buffers.at(static_cast<size_t>(offset)).data();
    }
    int munmap(void *, size_t) override
    {
        mapped--;
        return 0;
    }
    int poll(int, int timeout_ms) override
    {
        if (!events.empty())
            return 1;
        now_us += timeout_ms * 1000;
        return 0;
    }
    int64_t monotonic_us() override { return now_us; }
    int64_t wall_us() override { return wall_start_us + now_us; }

    int ioctl(int, unsigned long request, void *argument) override
    {
        errno = request == failing_request ? error : answer(request, argument);
        return errno == 0 ? 0 : -1;
    }

  private:
    // Returns 0 or errno.
    int answer(unsigned long request, void *argument)
    {
        switch (request) {
        case VIDIOC_QUERYCAP:
            return say_what_it_is(*static_cast<v4l2_capability *>(argument));
        case VIDIOC_ENUM_FMT:
            return list_format(*static_cast<v4l2_fmtdesc *>(argument));
        case VIDIOC_ENUM_FRAMESIZES:
            return list_size(*static_cast<v4l2_frmsizeenum *>(argument));
        case VIDIOC_G_FMT:
            static_cast<v4l2_format *>(argument)->fmt.pix.width = 4;
            static_cast<v4l2_format *>(argument)->fmt.pix.height = 2;
            return 0;
        case VIDIOC_S_FMT:
            return set_format(static_cast<v4l2_format *>(argument)->fmt.pix);
        case VIDIOC_G_PARM:
            static_cast<v4l2_streamparm *>(argument)->parm.capture.capability =
                rates_hz.empty() ? 0 : V4L2_CAP_TIMEPERFRAME;
            static_cast<v4l2_streamparm *>(argument)->parm.capture.timeperframe = {1, 30};
            return 0;
        case VIDIOC_S_PARM:
            return set_rate(static_cast<v4l2_streamparm *>(argument)->parm.capture.timeperframe);
        case VIDIOC_REQBUFS:
            buffers.assign(3, std::vector<uint8_t>(4096)); // it may give fewer than asked for
            static_cast<v4l2_requestbuffers *>(argument)->count = 3;
            return 0;
        case VIDIOC_QUERYBUF:
            static_cast<v4l2_buffer *>(argument)->length = 4096;
            static_cast<v4l2_buffer *>(argument)->m.offset =
                static_cast<v4l2_buffer *>(argument)->index;
            return 0;
        case VIDIOC_QBUF:
            queued.push_back(static_cast<v4l2_buffer *>(argument)->index);
            return 0;
        case VIDIOC_DQBUF:
            return give_frame(*static_cast<v4l2_buffer *>(argument));
        case VIDIOC_STREAMON:
            return 0;
        }
        return ENOTTY;
    }

    int say_what_it_is(v4l2_capability &out) const
    {
        std::strcpy(reinterpret_cast<char *>(out.card), "Test Cam");
        out.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        out.device_caps = capabilities;
        return 0;
    }

    int list_format(v4l2_fmtdesc &out) const
    {
        if (out.index >= formats.size())
            return EINVAL;
        out.pixelformat = formats[out.index];
        return 0;
    }

    static int list_size(v4l2_frmsizeenum &out)
    {
        if (out.index >= 2)
            return EINVAL;
        out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        out.discrete = {4 + 4 * out.index, 2 + 2 * out.index};
        return 0;
    }

    // Sizes other than 4x2 and 8x4 become 4x2, as drivers do.
    int set_format(v4l2_pix_format &wanted)
    {
        if (wanted.width != 8 || wanted.height != 4) {
            wanted.width = 4;
            wanted.height = 2;
        }
        const bool is_grey = wanted.pixelformat == V4L2_PIX_FMT_GREY;
        const bool is_planar = wanted.pixelformat == V4L2_PIX_FMT_NV12;
        wanted.bytesperline = wanted.width * (is_grey || is_planar ? 1 : 2) + row_padding;
        picture = wanted;
        return 0;
    }

    int set_rate(v4l2_fract &period) const
    {
        const uint32_t wanted = period.denominator / period.numerator;
        const bool has_it = std::count(rates_hz.begin(), rates_hz.end(), wanted) > 0;
        period = {1, has_it ? wanted : rates_hz[0]};
        return 0;
    }

    int give_frame(v4l2_buffer &out)
    {
        if (events.empty())
            return EAGAIN;
        const Event event = events.front();
        events.pop_front();
        if (event.error != 0)
            return event.error;
        queued_at_last_take = queued.size();
        out.index = queued.front();
        queued.pop_front();
        std::copy(event.data.begin(), event.data.end(), buffers[out.index].begin());
        out.bytesused = static_cast<uint32_t>(event.data.size());
        out.sequence = event.sequence;
        out.flags = event.flags;
        const int64_t stamp_us = now_us - event.age_us;
        out.timestamp = {stamp_us / second_us, stamp_us % second_us};
        return 0;
    }
};

Event frame(const std::string &data, uint32_t sequence, int64_t age_us = 0)
{
    Event event;
    event.data = data;
    event.sequence = sequence;
    event.age_us = age_us;
    return event;
}

Event failure(int error)
{
    Event event;
    event.error = error;
    return event;
}

V4l2Settings in_format(const std::string &format)
{
    V4l2Settings settings;
    settings.format = format;
    return settings;
}

std::unique_ptr<Camera> open(PlayedCamera &played, const V4l2Settings &settings = {})
{
    return vdna::frames::open_v4l2_camera("/dev/video9", settings, played);
}

// The complaint, without the device's name; "" if it opens.
std::string refusal_of(PlayedCamera &played, const V4l2Settings &settings = {})
{
    try {
        open(played, settings);
    } catch (const vdna::Error &e) {
        assert_false(played.is_open);
        assert_int_equal(played.mapped, 0);
        return std::string(e.what()).substr(std::strlen("/dev/video9: "));
    }
    return "";
}

void assert_begins(const std::string &text, const std::string &begin)
{
    assert_string_equal(text.substr(0, begin.size()).c_str(), begin.c_str());
}

std::string bytes_of(const Frame &frame)
{
    return {frame.image.data, frame.image.data + frame.image.size};
}

// The complaint of the next read.
std::string loss_of(Camera &camera)
{
    try {
        Frame out;
        camera.read(out);
    } catch (const vdna::Error &e) {
        return e.what();
    }
    return "";
}

void a_jpeg_passes_untouched_with_its_padding(void **)
{
    PlayedCamera played;
    const std::string padded = jpeg + std::string(20, '\0');
    played.events = {frame(padded, 0)};
    const auto camera = open(played);
    Frame out;
    assert_true(camera->read(out));
    assert_int_equal(out.image.pixelformat, VDNA_PIXEL_MJPG);
    assert_int_equal(out.image.width, 4);
    assert_int_equal(out.image.height, 2);
    assert_int_equal(out.image.row_stride, 0);
    assert_true(bytes_of(out) == padded);
    assert_string_equal(out.name.c_str(), "/dev/video9: frame 0");
    assert_string_equal(camera->description().c_str(), "Test Cam: 4x2 MJPG, 30 Hz");
}

void raw_pictures_keep_their_format_and_row_stride(void **)
{
    const struct {
        const char *name;
        uint32_t v4l2, pixelformat, stride;
        size_t size;
    } cases[] = {
        {"YUYV", V4L2_PIX_FMT_YUYV, VDNA_PIXEL_YUYV, 8, 16},
        {"GREY", V4L2_PIX_FMT_GREY, VDNA_PIXEL_GREY, 4, 8},
        {"NV12", V4L2_PIX_FMT_NV12, VDNA_PIXEL_NV12, 4, 12},
    };
    for (const auto &c : cases) {
        for (const uint32_t padding : {0u, 12u}) {
            PlayedCamera played;
            played.formats = {c.v4l2};
            played.row_padding = padding;
            const size_t size = c.size / c.stride * (c.stride + padding);
            played.events = {frame(std::string(size, 'x'), 0)};
            const auto camera = open(played, in_format(c.name));
            Frame out;
            assert_true(camera->read(out));
            assert_int_equal(out.image.pixelformat, c.pixelformat);
            assert_int_equal(out.image.row_stride, c.stride + padding);
            assert_int_equal(out.image.size, size);
        }
    }
}

void the_first_offered_format_of_our_list_is_chosen(void **)
{
    PlayedCamera played;
    played.formats = {V4L2_PIX_FMT_H264, V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV};
    assert_string_equal(open(played)->description().c_str(), "Test Cam: 4x2 YUYV, 30 Hz");
}

void size_and_rate_are_set(void **)
{
    PlayedCamera played;
    V4l2Settings settings;
    settings.width = 8;
    settings.height = 4;
    settings.rate_hz = 15;
    assert_string_equal(open(played, settings)->description().c_str(), "Test Cam: 8x4 MJPG, 15 Hz");
}

void a_buffer_is_the_drivers_again_when_the_next_frame_is_read(void **)
{
    PlayedCamera played;
    for (uint32_t i = 0; i < 20; i++)
        played.events.push_back(frame(jpeg, i));
    {
        const auto camera = open(played);
        assert_int_equal(played.mapped, 3);
        for (Frame out; !played.events.empty();) {
            assert_true(camera->read(out));
            assert_int_equal(played.queued_at_last_take, 3);
            assert_int_equal(played.queued.size(), 2);
        }
    }
    assert_int_equal(played.mapped, 0);
    assert_false(played.is_open);
}

void an_early_wake_up_is_no_frame(void **)
{
    PlayedCamera played;
    played.events = {failure(EAGAIN), failure(EINTR), failure(EAGAIN), frame(jpeg, 0)};
    Frame out;
    assert_true(open(played)->read(out));
    assert_int_equal(out.index, 0);
}

void gaps_in_the_numbers_are_counted_as_dropped_frames(void **)
{
    PlayedCamera played;
    for (const uint32_t sequence : {5u, 6u, 9u, 10u, 3u, 4u, 7u})
        played.events.push_back(frame(jpeg, sequence));
    const auto camera = open(played);
    for (Frame out; !played.events.empty();)
        camera->read(out);
    assert_int_equal(camera->losses().dropped, 2 + 2); // 7, 8 and 5, 6; a restart is no gap
}

void numbers_may_wrap_around(void **)
{
    PlayedCamera played;
    for (const uint32_t sequence : {UINT32_MAX - 1, UINT32_MAX, 1u})
        played.events.push_back(frame(jpeg, sequence));
    const auto camera = open(played);
    for (Frame out; !played.events.empty();)
        camera->read(out);
    assert_int_equal(camera->losses().dropped, 1);
}

void damaged_frames_are_left_out_and_counted(void **)
{
    PlayedCamera played;
    Event marked = frame(jpeg, 1);
    marked.flags |= V4L2_BUF_FLAG_ERROR;
    played.events = {
        frame(jpeg, 0),           marked,       frame(jpeg.substr(0, jpeg.size() - 1), 2),
        frame(jpeg.substr(1), 3), frame("", 4), frame(jpeg, 5)};
    const auto camera = open(played);
    Frame out;
    assert_true(camera->read(out));
    assert_true(camera->read(out));
    assert_int_equal(out.index, 1);
    assert_int_equal(camera->losses().damaged, 4);
    assert_int_equal(camera->losses().dropped, 0);
    assert_int_equal(played.queued.size(), 2);
}

void a_raw_picture_that_was_cut_short_is_damaged(void **)
{
    for (const char *format : {"YUYV", "NV12"}) {
        PlayedCamera played;
        played.formats = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_NV12};
        const size_t whole = std::strcmp(format, "YUYV") == 0 ? 16 : 12;
        played.events = {frame(std::string(whole - 1, 'x'), 0), frame(std::string(whole, 'x'), 1)};
        const auto camera = open(played, in_format(format));
        Frame out;
        assert_true(camera->read(out));
        assert_int_equal(out.image.size, whole);
        assert_int_equal(camera->losses().damaged, 1);
    }
}

void a_driver_that_claims_more_than_its_buffer_has_is_not_believed(void **)
{
    class Liar : public PlayedCamera
    {
        int ioctl(int fd, unsigned long request, void *argument) override
        {
            const int result = PlayedCamera::ioctl(fd, request, argument);
            if (request == VIDIOC_DQBUF && result == 0 && lies-- > 0)
                static_cast<v4l2_buffer *>(argument)->bytesused = 4097;
            return result;
        }
        int lies = 1;
    } played;
    played.events = {frame(jpeg, 0), frame(jpeg, 1)};
    const auto camera = open(played);
    Frame out;
    assert_true(camera->read(out));
    assert_true(bytes_of(out) == jpeg);
    assert_int_equal(camera->losses().damaged, 1);
}

void the_drivers_stamp_becomes_a_time_of_day(void **)
{
    PlayedCamera played;
    played.events = {frame(jpeg, 0, 30000)};
    Frame out;
    assert_true(open(played)->read(out));
    assert_true(out.utime == wall_start_us + played.now_us - 30000);
}

void stamps_that_cannot_be_are_replaced_by_the_time_of_arrival(void **)
{
    PlayedCamera played;
    Event unknown = frame(jpeg, 0, 30000);
    unknown.flags = 0;
    const int64_t too_old_us = 10 * second_us + 1;
    played.events = {unknown, frame(jpeg, 1, -1), frame(jpeg, 2, too_old_us)};
    const auto camera = open(played);
    for (Frame out; !played.events.empty();) {
        assert_true(camera->read(out));
        assert_true(out.utime == wall_start_us + played.now_us);
    }
}

void an_unplugged_camera_is_told(void **)
{
    PlayedCamera played;
    played.events = {frame(jpeg, 0), failure(ENODEV)};
    const auto camera = open(played);
    Frame out;
    assert_true(camera->read(out));
    assert_string_equal(loss_of(*camera).c_str(),
                        "/dev/video9: the camera is gone; see to its plug and cable");
}

void a_camera_that_gives_nothing_for_five_seconds_is_told(void **)
{
    PlayedCamera played;
    const auto camera = open(played);
    assert_begins(loss_of(*camera), "/dev/video9: no frame for 5 s; ");
    assert_in_range(played.now_us, 55 * second_us, 56 * second_us);
}

void a_driver_that_fails_is_told(void **)
{
    PlayedCamera played;
    played.events = {failure(EIO)};
    const auto camera = open(played);
    assert_begins(loss_of(*camera), "/dev/video9: cannot take a frame: Input/output error; ");
}

void devices_that_are_no_cameras_are_refused(void **)
{
    PlayedCamera played;
    played.failing_request = VIDIOC_QUERYCAP;
    played.error = ENOTTY;
    assert_string_equal(refusal_of(played).c_str(),
                        "not a camera, expected a V4L2 device such as /dev/video0");

    PlayedCamera metadata;
    metadata.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
    assert_begins(refusal_of(metadata), "Test Cam gives no pictures at this node, ");

    PlayedCamera planes;
    planes.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
    assert_begins(refusal_of(planes), "Test Cam gives each plane of a picture in a buffer of its");

    PlayedCamera without_buffers;
    without_buffers.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_READWRITE;
    assert_begins(refusal_of(without_buffers), "Test Cam does not stream into buffers");
}

void errors_of_opening_name_the_remedy(void **)
{
    PlayedCamera played;
    played.open_error = EACCES;
    assert_begins(refusal_of(played), "no permission to use this camera, which the group video "
                                      "has; run `sudo usermod -aG video $USER`");
    played.open_error = ENOENT;
    assert_begins(refusal_of(played), "no such device, ");
    played.open_error = EBUSY;
    assert_begins(refusal_of(played), "another program uses this camera");
}

void a_camera_in_use_is_told_whichever_call_says_so(void **)
{
    for (const unsigned long request : {VIDIOC_S_FMT, VIDIOC_S_PARM, VIDIOC_REQBUFS}) {
        PlayedCamera played;
        played.failing_request = request;
        played.error = EBUSY;
        V4l2Settings settings;
        settings.rate_hz = 30;
        assert_begins(refusal_of(played, settings), "another program uses this camera");
    }
}

void a_full_usb_bus_is_told(void **)
{
    PlayedCamera played;
    played.failing_request = VIDIOC_STREAMON;
    played.error = ENOSPC;
    assert_begins(refusal_of(played), "the USB bus has no room for this camera's pictures; ask "
                                      "for a smaller --size");
}

void a_format_that_is_not_offered_is_refused_with_those_that_are(void **)
{
    PlayedCamera played;
    assert_string_equal(refusal_of(played, in_format("NV12")).c_str(),
                        "offers YUYV, MJPG, expected NV12; choose another --format");
    played.formats = {V4L2_PIX_FMT_H264, V4L2_PIX_FMT_Z16};
    assert_string_equal(refusal_of(played).c_str(),
                        "offers H264, Z16, expected one of MJPG, JPEG, YUYV, UYVY, NV12, YU12, "
                        "BGR3, RGB3, GREY");
    played.formats = {};
    assert_begins(refusal_of(played), "offers nothing, ");
}

void a_size_that_is_not_offered_is_refused_with_those_that_are(void **)
{
    PlayedCamera played;
    V4l2Settings settings;
    settings.width = 640;
    settings.height = 480;
    assert_string_equal(refusal_of(played, settings).c_str(),
                        "gives no 640x480 as MJPG, expected one of its sizes: 4x2, 8x4");
}

void a_rate_that_is_not_offered_is_refused(void **)
{
    PlayedCamera played;
    V4l2Settings settings;
    settings.rate_hz = 20;
    assert_begins(refusal_of(played, settings), "gives 15 Hz, expected 20 Hz; ");
    played.rates_hz = {};
    assert_begins(refusal_of(played, settings), "has no rate that can be set, expected 20 Hz; ");
    settings.rate_hz = 0;
    assert_string_equal(open(played, settings)->description().c_str(), "Test Cam: 4x2 MJPG");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_jpeg_passes_untouched_with_its_padding),
        cmocka_unit_test(raw_pictures_keep_their_format_and_row_stride),
        cmocka_unit_test(the_first_offered_format_of_our_list_is_chosen),
        cmocka_unit_test(size_and_rate_are_set),
        cmocka_unit_test(a_buffer_is_the_drivers_again_when_the_next_frame_is_read),
        cmocka_unit_test(an_early_wake_up_is_no_frame),
        cmocka_unit_test(gaps_in_the_numbers_are_counted_as_dropped_frames),
        cmocka_unit_test(numbers_may_wrap_around),
        cmocka_unit_test(damaged_frames_are_left_out_and_counted),
        cmocka_unit_test(a_raw_picture_that_was_cut_short_is_damaged),
        cmocka_unit_test(a_driver_that_claims_more_than_its_buffer_has_is_not_believed),
        cmocka_unit_test(the_drivers_stamp_becomes_a_time_of_day),
        cmocka_unit_test(stamps_that_cannot_be_are_replaced_by_the_time_of_arrival),
        cmocka_unit_test(an_unplugged_camera_is_told),
        cmocka_unit_test(a_camera_that_gives_nothing_for_five_seconds_is_told),
        cmocka_unit_test(a_driver_that_fails_is_told),
        cmocka_unit_test(devices_that_are_no_cameras_are_refused),
        cmocka_unit_test(errors_of_opening_name_the_remedy),
        cmocka_unit_test(a_camera_in_use_is_told_whichever_call_says_so),
        cmocka_unit_test(a_full_usb_bus_is_told),
        cmocka_unit_test(a_format_that_is_not_offered_is_refused_with_those_that_are),
        cmocka_unit_test(a_size_that_is_not_offered_is_refused_with_those_that_are),
        cmocka_unit_test(a_rate_that_is_not_offered_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
