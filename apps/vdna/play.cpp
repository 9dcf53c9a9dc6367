// vdna play - sends the frames of a recording over LCM, like a camera driver.
#include <iostream>
#include <limits>

#include "frames/camera_image.hpp"
#include "frames/source.hpp"
#include "program/clock.hpp"
#include "program/decimal.hpp"
#include "program/progress.hpp"
#include "vdna/camera_channel.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct PlayOptions {
    std::string source;
    frames::SourceOptions reading;
    uint64_t frames = std::numeric_limits<uint64_t>::max(); // maximum to send
    bool loop = false;
    std::string stamp = "now";
    std::string url;
    bool unprotected = false;
};

// A regular beat for sending frames; a late beat does not delay later ones.
class Beat
{
  public:
    explicit Beat(double rate_hz) : period_us_(1e6 / rate_hz) {}

    // Throws Error on Ctrl-C.
    void wait() { program::sleep_until(begin_us_ + static_cast<int64_t>(beats_++ * period_us_)); }

  private:
    double period_us_;
    int64_t begin_us_ = program::monotonic_us();
    double beats_ = 0;
};

void send(CameraChannel &channel, const PlayOptions &options, const frames::Frame &frame,
          picture::FileConverter &converter)
{
    const vdna_image image = frames::camera_image(frame.image, frame.name, converter);
    channel.send(image, options.stamp == "recorded" ? frame.utime : program::wall_us(), frame.name);
}

// Send the source once, at most `limit` frames; returns the number sent.
uint64_t play_once(CameraChannel &channel, const PlayOptions &options, uint64_t limit, Beat &beat)
{
    frames::Source source(options.source, options.reading);
    program::Progress bar("playing " + options.source, std::min(limit, source.size()));
    picture::FileConverter converter;
    uint64_t sent = 0;
    for (bool more = true; more && sent < limit;) {
        try {
            frames::Frame frame;
            more = source.next(frame);
            if (!more)
                break;
            beat.wait();
            send(channel, options, frame, converter);
            sent++;
            bar.advance();
        } catch (const frames::BadFrame &bad) {
            std::cerr << "vdna play: " << bad.what() << "; left out\n";
        }
    }
    return sent;
}

void play(const PlayOptions &options)
{
    CameraChannel channel(options.url, options.reading.camera, !options.unprotected);
    Beat beat(options.reading.rate_hz);
    uint64_t sent = 0;
    do {
        const uint64_t now = play_once(channel, options, options.frames - sent, beat);
        if (now == 0)
            throw Error(options.source + ": no frame of it could be sent");
        sent += now;
    } while (options.loop && sent < options.frames);
    std::cout << "played " << sent << " frames on " << options.reading.camera << std::endl;
}

} // namespace

void add_play(CLI::App &app)
{
    CLI::App *command = app.add_subcommand("play", "Send a recording over LCM, as a camera would");
    const auto options = std::make_shared<PlayOptions>();
    command
        ->add_option("SOURCE", options->source, "folder of pictures, video, LCM log or MCAP file")
        ->required()
        ->type_name("PATH");
    command->add_option("--rate", options->reading.rate_hz, "frames per second")
        ->type_name("HZ")
        ->check(program::within(0.01, 10000))
        ->capture_default_str();
    command->add_option("--channel", options->reading.camera, "channel to send on")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command->add_option("--skip", options->reading.skip, "leave out the first N frames")
        ->type_name("N");
    command->add_option("--frames", options->frames, "stop after N frames")
        ->type_name("N")
        ->check(CLI::Range(uint64_t{1}, std::numeric_limits<uint64_t>::max()).description(""));
    command->add_flag("--loop", options->loop, "start again at the end, until Ctrl-C");
    command
        ->add_option("--stamp", options->stamp,
                     "camera time of a frame: time of sending, or as recorded")
        ->check(CLI::IsMember({"now", "recorded"}))
        ->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->add_flag("--unprotected", options->unprotected,
                      "leave out the number and checksum by which a receiver tells lost, repeated "
                      "and corrupted frames");
    command->footer(
        "JPEG files are sent as they are, other pictures as BGR pixels, turned upright.\n\n"
        "Examples:\n"
        "  vdna play drive.mp4 --rate 10\n"
        "  vdna play winter/ --loop --stamp recorded");
    command->callback([options] {
        options->reading.camera_option = "--channel";
        options->reading.labelled = options->stamp == "recorded";
        play(*options);
    });
}

} // namespace vdna::tool
