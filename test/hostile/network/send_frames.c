// send_frames URL COUNT BYTES INTERVAL_US [PID]: publishes frames 0 .. COUNT-1, as a driver would;
// with PID when the process has read the frame before from its packet socket.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <vdna/transport.h>

#include "frames.h"
#include "unread.h"

int main(int argc, char **argv)
{
    if (argc < 5)
        return fprintf(stderr, "usage: send_frames URL COUNT BYTES INTERVAL_US [PID]\n"), 2;
    char path[64];
    snprintf(path, sizeof path, "/proc/%s/net/packet", argc > 5 ? argv[5] : "none");
    const int64_t count = atoll(argv[2]);
    const size_t size = (size_t)atoll(argv[3]);
    const struct timespec interval = {.tv_nsec = 1000 * atol(argv[4])};
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = argv[1];
    vdna_transport *transport;
    vdna_error error;
    if (vdna_transport_open(&config, &error, &transport) != VDNA_OK)
        return fprintf(stderr, "send_frames: %s\n", error.text), 1;
    uint8_t *bytes = malloc(size);
    for (int64_t utime = 0; bytes && utime < count; utime++) {
        frame_fill(bytes, size, utime);
        const vdna_image image = {bytes, size, (uint32_t)size, 1, 0, VDNA_PIXEL_GREY};
        if (vdna_transport_publish_image(transport, "CAMERA", utime, &image) != VDNA_OK)
            return fprintf(stderr, "send_frames: frame %lld was not sent\n", (long long)utime), 1;
        nanosleep(&interval, NULL);
        wait_until_read(path, 0);
    }
    free(bytes);
    vdna_transport_close(transport);
    return 0;
}
