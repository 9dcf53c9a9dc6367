// receive_frames ours|lcm URL MAX_BYTES WORK_MS [SOURCE...]: receives on CAMERA until its standard
// input ends, and works for WORK_MS after each frame. Prints READY, for each frame its stamp, its
// age in microseconds (-1 if unknown) and 1 if its bytes are right, and at last the counters. `lcm`
// is liblcm's own receiver, for comparison.
#include <inttypes.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <vdna/transport.h>

#include "frames.h"

static int64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static int input_has_ended(void)
{
    struct pollfd input = {.fd = 0, .events = POLLIN};
    return poll(&input, 1, 0) != 0;
}

static void print_frame(const vdna_transport_frame *frame, int64_t age_us)
{
    printf("%" PRId64 " %" PRId64 " %d\n", frame->utime, age_us,
           frame_is_right(frame->image.data, frame->image.size, frame->utime));
    fflush(stdout);
}

static void print_counters(const vdna_transport_counters *c)
{
    printf("{\"received\": %" PRIu64 ", \"skipped\": %" PRIu64 ", \"oversized\": %" PRIu64
           ", \"rejected\": %" PRIu64 ", \"commands\": %" PRIu64 ", \"lost\": %" PRIu64
           ", \"incomplete\": %" PRIu64 ", \"dropped\": %" PRIu64 ", \"malformed\": %" PRIu64
           ", \"repeated\": %" PRIu64 ", \"foreign\": %" PRIu64 ", \"unprotected_frames\": %" PRIu64
           ", \"corrupted_frames\": %" PRIu64 ", \"repeated_frames\": %" PRIu64
           ", \"reordered_frames\": %" PRIu64 ", \"lost_frames\": %" PRIu64
           ", \"stream_count\": %" PRIu64 ", \"other_sender_frames\": %" PRIu64 "}\n",
           c->received, c->skipped, c->oversized, c->rejected, c->commands, c->lost, c->incomplete,
           c->dropped_datagrams, c->malformed_datagrams, c->repeated_datagrams,
           c->foreign_datagrams, c->unprotected_frames, c->corrupted_frames, c->repeated_frames,
           c->reordered_frames, c->lost_frames, c->stream_count, c->other_sender_frames);
}

static int receive_ours(const vdna_transport_config *config, int work_ms)
{
    vdna_transport *transport;
    vdna_error error;
    if (vdna_transport_open(config, &error, &transport) != VDNA_OK)
        return fprintf(stderr, "receive_frames: %s\n", error.text), 1;
    puts("READY");
    fflush(stdout);
    while (!input_has_ended()) {
        vdna_transport_frame frame;
        uint32_t events;
        if (vdna_transport_poll(transport, 50, &events, &frame) != VDNA_OK)
            return fprintf(stderr, "receive_frames: the connection is gone\n"), 1;
        if (!(events & VDNA_TRANSPORT_FRAME))
            continue;
        print_frame(&frame, monotonic_us() - frame.received_us);
        if (work_ms > 0)
            poll(NULL, 0, work_ms);
        if (!frame_is_right(frame.image.data, frame.image.size, frame.utime))
            puts("# the frame changed or was wrong");
    }
    print_counters(vdna_transport_count(transport));
    vdna_transport_close(transport);
    return 0;
}

static void on_message(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    vdna_transport_counters *counters = context;
    vdna_transport_frame frame;
    if (vdna_transport_parse_image(message->data, message->data_size, &frame) != VDNA_OK) {
        counters->rejected++;
        return;
    }
    counters->received++;
    print_frame(&frame, -1);
}

static int receive_lcm(const vdna_transport_config *config)
{
    vdna_transport_counters counters = {.received = 0};
    lcm_t *lcm = lcm_create(config->url);
    if (!lcm || !lcm_subscribe(lcm, "CAMERA", on_message, &counters))
        return 1;
    puts("READY");
    fflush(stdout);
    while (!input_has_ended())
        lcm_handle_timeout(lcm, 50);
    print_counters(&counters);
    lcm_destroy(lcm);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc < 5)
        return fprintf(stderr,
                       "usage: receive_frames ours|lcm URL MAX_BYTES WORK_MS [SOURCE...]\n"),
               2;
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = argv[2];
    config.max_image_bytes = (uint32_t)atoi(argv[3]);
    config.camera_channel = "CAMERA";
    config.command_channel = "VDNA_COMMAND";
    config.sources = (const char *const *)argv + 5;
    config.source_count = (uint64_t)argc - 5;
    return strcmp(argv[1], "lcm") == 0 ? receive_lcm(&config)
                                       : receive_ours(&config, atoi(argv[4]));
}
