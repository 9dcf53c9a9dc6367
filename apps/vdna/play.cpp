// vdna play - sends the frames of a recording over LCM, like a camera driver.
#include <cerrno>
#include <chrono>
#include <iostream>
#include <limits>

#include <time.h>

#include <vdna/cpp/connection.hpp>

#include "frames/camera_image.hpp"
#include "frames/source.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"
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
};

// A regular beat for sending frames; a late beat does not delay later ones.
class Beat
{
  public:
    explicit Beat(double rate_hz) : period_us_(1e6 / rate_hz) {}

    // Throws Error on Ctrl-C.
    void wait()
    {
        const int64_t due_us = begin_us_ + static_cast<int64_t>(beats_++ * period_us_);
        const timespec due{due_us / 1000000, due_us % 1000000 * 1000};
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR)
            program::require_not_interrupted();
        program::require_not_interrupted();
    }

  private:
    static int64_t monotonic_us()
    {
        timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        return int64_t{now.tv_sec} * 1000000 + now.tv_nsec / 1000;
    }

    double period_us_;
    int64_t begin_us_ = monotonic_us();
    double beats_ = 0;
};

int64_t wall_us()
{
    using namespace std::chrono;
    return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

void send(vdna_transport *transport, const PlayOptions &options, const frames::Frame &frame,
          picture::FileConverter &converter)
{
    const vdna_image image = frames::camera_image(frame.image, frame.name, converter);
    const int64_t utime = options.stamp == "recorded" ? frame.utime : wall_us();
    const vdna_status status =
        vdna_transport_publish_image(transport, options.reading.camera.c_str(), utime, &image);
    if (status != VDNA_OK)
        throw Error(frame.name + ": " + std::to_string(image.size) + " bytes cannot be sent: " +
                    vdna_status_text(status) + "; see to the network, or play smaller pictures");
}

// Send the source once, at most `limit` frames; returns the number sent.
uint64_t play_once(vdna_transport *transport, const PlayOptions &options, uint64_t limit,
                   Beat &beat)
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
            send(transport, options, frame, converter);
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
    vdna_error error{};
    require(vdna_transport_check_channel(options.reading.camera.c_str(), &error), error);
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = options.url.empty() ? nullptr : options.url.c_str();
    const Connection connection = connect(config);

    Beat beat(options.reading.rate_hz);
    uint64_t sent = 0;
    do {
        const uint64_t now = play_once(connection.get(), options, options.frames - sent, beat);
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
    command->add_option("source", options->source, "folder of pictures, video or LCM log")
        ->required()
        ->type_name("SOURCE");
    command->add_option("--rate", options->reading.rate_hz, "frames per second")
        ->type_name("HZ")
        ->check(CLI::Range(0.01, 10000.0))
        ->capture_default_str();
    command->add_option("--channel", options->reading.camera, "channel to send on")
        ->capture_default_str();
    command->add_option("--skip", options->reading.skip, "leave out the first N frames")
        ->type_name("N");
    command->add_option("--frames", options->frames, "stop after N frames")
        ->type_name("N")
        ->check(CLI::Range(uint64_t{1}, std::numeric_limits<uint64_t>::max()));
    command->add_flag("--loop", options->loop, "start again at the end, until Ctrl-C");
    command
        ->add_option("--stamp", options->stamp,
                     "camera time of a frame: time of sending, or as recorded")
        ->check(CLI::IsMember({"now", "recorded"}))
        ->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network; default: $LCM_DEFAULT_URL, else LCM's")
        ->type_name("URL");
    command->footer(
        "JPEG files are sent as they are, other pictures as BGR pixels, turned upright.");
    command->callback([options] {
        options->reading.labelled = options->stamp == "recorded";
        play(*options);
    });
}

} // namespace vdna::tool
