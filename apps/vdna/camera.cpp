// vdna camera - sends the frames of a running camera over LCM.
#include <iostream>
#include <limits>
#include <memory>

#include "frames/camera_image.hpp"
#include "frames/file_camera.hpp"
#include "frames/stream_camera.hpp"
#include "frames/v4l2_camera.hpp"
#include "program/clock.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "vdna/camera_channel.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

struct CameraOptions {
    std::string source;
    std::string size;
    frames::V4l2Settings settings;
    std::string channel = VDNA_CHANNEL_CAMERA;
    std::string url;
    uint64_t frames = std::numeric_limits<uint64_t>::max(); // maximum to send
    bool reconnect = false;
    bool unprotected = false;
};

// What was sent, over all connections to the camera.
struct Tally {
    uint64_t sent = 0;
    frames::CameraLosses losses;
};

bool is_device(const std::string &source)
{
    std::error_code failure;
    return source.rfind("/dev/", 0) == 0 || std::filesystem::is_character_file(source, failure);
}

void require_device_for_settings(const CameraOptions &options)
{
    if (!options.size.empty() || options.settings.rate_hz > 0 || !options.settings.format.empty())
        throw program::UsageError(options.source +
                                  ": not a camera of this machine, so --size, --rate and --format "
                                  "cannot be set; set them where it is recorded or sent");
}

std::unique_ptr<frames::Camera> open_camera(const CameraOptions &options,
                                            frames::DeviceCalls &calls)
{
    if (is_device(options.source))
        return frames::open_v4l2_camera(options.source, options.settings, calls);
    require_device_for_settings(options);
    if (options.source.find("://") != std::string::npos)
        return frames::open_stream_camera(options.source);
    return frames::open_file_camera(options.source);
}

// Send frames until the camera ends, is lost (throws Error) or Ctrl-C.
void send_all(frames::Camera &camera, const CameraOptions &options, CameraChannel &channel,
              Tally &tally)
{
    picture::FileConverter converter;
    for (frames::Frame frame; tally.sent < options.frames && camera.read(frame); tally.sent++)
        channel.send(frames::camera_image(frame.image, frame.name, converter), frame.utime,
                     frame.name);
}

void run(const CameraOptions &options, CameraChannel &channel, Tally &tally)
{
    frames::DeviceCalls calls;
    const std::unique_ptr<frames::Camera> camera = open_camera(options, calls);
    std::cerr << "vdna camera: " << camera->description() << ", on channel " << options.channel
              << std::endl;
    const auto add_losses = [&] {
        tally.losses.dropped += camera->losses().dropped;
        tally.losses.damaged += camera->losses().damaged;
    };
    try {
        send_all(*camera, options, channel, tally);
    } catch (...) {
        add_losses();
        throw;
    }
    add_losses();
}

// As run(), but again after each loss of the camera.
void run_and_reconnect(const CameraOptions &options, CameraChannel &channel, Tally &tally)
{
    constexpr int64_t pause_us = 2000000;
    for (std::string last;;) {
        const uint64_t sent = tally.sent;
        try {
            return run(options, channel, tally);
        } catch (const program::UsageError &) {
            throw;
        } catch (const program::Interrupted &) {
            throw;
        } catch (const Error &error) {
            // A camera that stays away is told once.
            if (error.what() != last || tally.sent > sent)
                std::cerr << "vdna camera: " << error.what() << "; trying again every "
                          << pause_us / 1000000 << " s" << std::endl;
            last = error.what();
        }
        program::sleep_until(program::monotonic_us() + pause_us);
    }
}

void report(const CameraOptions &options, const Tally &tally)
{
    std::cout << "sent " << tally.sent << " frames on " << options.channel;
    if (is_device(options.source))
        std::cout << "; " << tally.losses.dropped << " dropped by the driver, "
                  << tally.losses.damaged << " damaged and left out";
    std::cout << std::endl;
}

void send_camera(CameraOptions options)
{
    if (!options.size.empty()) {
        const PictureSize size = parse_size(options.size, 1, VDNA_IMAGE_SIDE_MAX, "1280x720");
        options.settings.width = size.width;
        options.settings.height = size.height;
    }
    CameraChannel channel(options.url, options.channel, !options.unprotected);
    Tally tally;
    try {
        (options.reconnect ? run_and_reconnect : run)(options, channel, tally);
    } catch (const program::Interrupted &) { // NOLINT(bugprone-empty-catch): the usual end
    } catch (...) {
        if (tally.sent > 0)
            report(options, tally);
        throw;
    }
    report(options, tally);
}

void add_device_options(CLI::App &command, CameraOptions &options)
{
    const std::string as_set = " (default: as the driver has it set)";
    command.add_option("--size", options.size, "size of the pictures of a V4L2 camera" + as_set)
        ->type_name("WxH");
    command
        .add_option("--rate", options.settings.rate_hz,
                    "frames per second of a V4L2 camera" + as_set)
        ->check(program::within(0.01, 10000))
        ->type_name("HZ");
    command
        .add_option("--format", options.settings.format,
                    "pixel format of a V4L2 camera (default: the first of these that it offers)")
        ->check(CLI::IsMember(frames::v4l2_formats(), CLI::ignore_case));
}

} // namespace

void add_camera(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("camera", "Send the frames of a running camera over LCM");
    const auto options = std::make_shared<CameraOptions>();
    command
        ->add_option("SOURCE", options->source,
                     "V4L2 camera (/dev/video0), stream (rtsp://..., http://...), or video")
        ->required()
        ->type_name("PATH");
    add_device_options(*command, *options);
    command->add_option("--channel", options->channel, "channel to send on")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command->add_option("--frames", options->frames, "stop after N frames")
        ->type_name("N")
        ->check(CLI::Range(uint64_t{1}, std::numeric_limits<uint64_t>::max()).description(""));
    command->add_flag("--reconnect", options->reconnect,
                      "when the camera is lost or is not there, try again every two seconds; "
                      "without it, end with exit 1");
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->add_flag("--unprotected", options->unprotected,
                      "leave out the number and checksum by which a receiver tells lost, repeated "
                      "and corrupted frames");
    command->footer(
        "A V4L2 camera's pictures are sent as they are, stamped by its driver; those of a stream "
        "as BGR pixels, stamped when they arrive; a video's at the pace of its own times. Ends at "
        "Ctrl-C or the end of the video.\n\n"
        "Examples:\n"
        "  vdna camera /dev/video0 --size 1280x720 --rate 30 --format MJPG\n"
        "  vdna camera rtsp://192.168.1.10/stream1 --reconnect\n"
        "  vdna camera drive.mp4");
    command->callback([options] { send_camera(*options); });
}

} // namespace vdna::tool
