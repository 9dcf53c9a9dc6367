/* Private: the contents of a vdna_transport. */
#ifndef VDNA_CONNECTION_H
#define VDNA_CONNECTION_H

#include "network.h"

struct vdna_transport {
    vdna_network network;
    channel_name camera, command;
    vdna_transport_counters counters;

    /* Results of the current poll. */
    uint32_t events;
    uint32_t arrived;           /* messages on our channels */
    uint64_t unanswered;        /* frames dropped since the last one handed out */
    vdna_transport_frame frame; /* its picture is in `picture` */
    uint8_t *picture;
    size_t picture_size; /* bytes allocated */

    /* The message being published, encoded. */
    uint8_t *message;
    size_t message_size; /* bytes allocated */

    /* Other channels, see overhear.c. */
    lcm_subscription_t *overhearing; /* NULL = not now */
    vdna_transport_overheard overheard[VDNA_TRANSPORT_OVERHEARD_MAX];
    uint32_t overheard_count;
};

/* Messages of other channels that LCM queues. Few, because each may be as large as a picture;
 * enough while we are waiting and so take them at once. */
#define OVERHEARD_QUEUE 3u

/* Room for an encoded message. The block only ever grows, so that messages of similar size are
 * published without an allocation. */
vdna_status vdna_transport_reserve(vdna_transport *transport, size_t size);

/* Subscribe to the camera and command channels that are used. */
vdna_status vdna_transport_subscribe(vdna_transport *transport, vdna_error *error);

#endif
