/* Private: the contents of a vdna_transport. */
#ifndef VDNA_CONNECTION_H
#define VDNA_CONNECTION_H

#include "multicast.h"
#include "network.h"
#include "streams.h"

/* Senders whose newest frames are kept apart, so that none drowns another: the one that has been
 * there longest, and all others together. */
#define VDNA_TRANSPORT_LANES 2u

/* The newest frame of a lane. */
typedef struct vdna_transport_lane {
    bool is_waiting;
    uint64_t source;            /* who sent it, and under which number */
    uint32_t sequence;          /* both 0 if it came through LCM */
    uint32_t slot;              /* where its bytes are held, if it came through our receiver */
    vdna_transport_frame frame; /* its picture is there, or in `picture` */
} vdna_transport_lane;

struct vdna_transport {
    vdna_network network;
    vdna_multicast *receiver; /* NULL = messages come through LCM */
    channel_name camera, command, peer;
    vdna_transport_counters counters;
    bool require_protection;
    vdna_streams streams;

    /* Results of the current poll. */
    uint32_t events;
    uint32_t arrived;    /* messages on our channels */
    uint64_t unanswered; /* frames dropped since the last one handed out */
    vdna_transport_command commands[VDNA_TRANSPORT_COMMANDS_MAX];
    uint32_t command_count;

    /* Frames. */
    vdna_transport_lane lanes[VDNA_TRANSPORT_LANES];
    uint64_t first_source;     /* whose the first lane is */
    int64_t first_received_us; /* its newest message */
    uint32_t served;           /* the lane handed out last */
    uint32_t lent_slot;        /* of its frame; VDNA_REASSEMBLY_SLOTS = none */
    uint32_t picture_max;      /* max_image_bytes */
    uint8_t *picture;          /* [picture_max]; NULL = frames stay in the receiver's slots */

    /* The message being published, encoded. */
    uint8_t *message;
    size_t message_size; /* bytes allocated */

    /* Statuses of daemons, see peers.c. */
    vdna_transport_peer peers[VDNA_TRANSPORT_PEERS_MAX];
    uint32_t peer_count;

    /* Other channels, see overhear.c. */
    bool is_overhearing;
    lcm_subscription_t *overhearing; /* NULL = not now, or not through LCM */
    vdna_transport_overheard overheard[VDNA_TRANSPORT_OVERHEARD_MAX];
    uint32_t overheard_count;
};

/* A message that came in, of whatever way. */
typedef struct vdna_transport_incoming {
    const uint8_t *data;
    size_t size; /* bytes there */
    int64_t received_us;
    const vdna_arrival *arrival; /* NULL = through LCM */
} vdna_transport_incoming;

/* Messages of other channels that LCM queues. Few, because each may be as large as a picture;
 * enough while we are waiting and so take them at once. */
#define OVERHEARD_QUEUE 3u

/* Room for an encoded message. The block only ever grows, so that messages of similar size are
 * published without an allocation. */
vdna_status vdna_transport_reserve(vdna_transport *transport, size_t size);

/* Subscribe to the camera, command and peer channels that are used. */
vdna_status vdna_transport_subscribe(vdna_transport *transport, vdna_error *error);

/* Take a message of the command channel. */
void vdna_transport_take_command(vdna_transport *transport, const vdna_transport_incoming *message);

/* Take a message of the peer channel. Returns whether it is a status. */
bool vdna_transport_take_peer(vdna_transport *transport, const vdna_transport_incoming *message);

/* Note the beginning of a message on another channel, if that is wanted. */
void vdna_transport_note(vdna_transport *transport, const char *channel,
                         const vdna_transport_incoming *message);

#endif
