// many_frames MAP COUNT: the daemon's own loop over COUNT frames through the stub backbone, on LCM
// within the process. Each frame sends the next one; every 100,000th also sends a reset, so that
// warming up, ranking and localising repeat. Prints the resident size, in bytes, after the first
// 100 frames and at the end.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include <vdna/cpp/connection.hpp>

#include "selectord/daemon.hpp"

namespace
{

using namespace vdna;
using namespace vdna::selectord;

constexpr uint8_t pixels[64] = {};
constexpr uint64_t settled = 100, reset_every = 100000;

struct Run {
    vdna_transport *transport = nullptr;
    uint64_t wanted = 0, done = 0;
    std::atomic<bool> stop{false};
    ResidentMemory memory;
    Resident early;
} run;

void send_frame()
{
    const vdna_image image{pixels, sizeof pixels, 8, 8, 0, VDNA_PIXEL_GREY};
    vdna_transport_publish_image(run.transport, VDNA_CHANNEL_CAMERA, static_cast<int64_t>(run.done),
                                 &image);
}

void send_reset()
{
    char nothing[] = "";
    vdna_msg_command_t command{};
    command.command = VDNA_MSG_COMMAND_T_RESET;
    command.argument = nothing;
    vdna_transport_publish(run.transport, VDNA_CHANNEL_COMMAND, &vdna_message_command, &command);
}

void frame_done()
{
    run.done++;
    if (run.done == settled)
        run.early = run.memory.read();
    if (run.done % reset_every == 0)
        send_reset();
    if (run.done == run.wanted)
        run.stop = true;
    send_frame();
}

// The stub's run, and what follows from it.
vdna_status run_and_go_on(void *state, const vdna_image *image, vdna_error *error,
                          vdna_backbone_frame *out_frame)
{
    const vdna_status status = vdna_backbone_plugin()->run(state, image, error, out_frame);
    frame_done();
    return status;
}

void process(const char *map_directory, uint64_t frames)
{
    Config config;
    config.map_directory = map_directory;
    config.warmup_frames = 50;
    vdna_backbone_operations operations = *vdna_backbone_plugin();
    operations.run = run_and_go_on;
    const Backbone backbone(operations);
    Daemon daemon(config, open_map(config), backbone);

    vdna_transport_config transport;
    vdna_transport_config_init(&transport);
    transport.url = "memq://";
    transport.max_image_bytes = sizeof pixels;
    transport.max_message_bytes = daemon.message_size_max();
    transport.camera_channel = VDNA_CHANNEL_CAMERA;
    transport.command_channel = VDNA_CHANNEL_COMMAND;
    const Connection connection = connect(transport);

    run.transport = connection.get();
    run.wanted = frames;
    send_frame();
    daemon.run(connection.get(), run.stop, ServiceManager(nullptr));
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3)
        return std::fprintf(stderr, "usage: many_frames MAP COUNT\n"), 2;
    try {
        process(argv[1], std::strtoull(argv[2], nullptr, 10));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "many_frames: %s\n", error.what());
        return 1;
    }
    std::printf("%" PRIu64 " %" PRId64 " %" PRId64 "\n", run.done, run.early.now,
                run.memory.read().now);
    return 0;
}
