/* Private: an LCM network, as the transport and the listener use it. */
#ifndef VDNA_NETWORK_H
#define VDNA_NETWORK_H

#include <lcm/lcm.h>
#include <stdbool.h>

#include <vdna/transport.h>

#include "log.h"

typedef struct vdna_network {
    lcm_t *lcm;    /* NULL = not connected */
    vdna_log *log; /* whose events go through `lcm`, which is memq:// then; NULL = a live network */
} vdna_network;

/* A literal channel name; empty = not used. */
typedef char channel_name[VDNA_CHANNEL_BYTES_MAX + 1];

/* The URL that is meant, by LCM's own rule: the given one, $LCM_DEFAULT_URL or LCM's default. */
const char *vdna_network_url(const char *url);

/* Connect. url: as in vdna_transport_config. */
vdna_status vdna_network_open(vdna_network *out_network, const char *url, vdna_error *error);

/* Disconnect, if connected. */
void vdna_network_close(vdna_network *network);

/* Have `handler` called for each message of a channel, of which LCM queues `queue_length`. */
vdna_status vdna_network_subscribe(const vdna_network *network, const char *channel,
                                   uint32_t queue_length, lcm_msg_handler_t handler, void *context,
                                   vdna_error *error);

/* Have `handler` called for each message of every channel; out_subscription is for
 * vdna_network_unsubscribe(). */
vdna_status vdna_network_subscribe_all(const vdna_network *network, uint32_t queue_length,
                                       lcm_msg_handler_t handler, void *context,
                                       lcm_subscription_t **out_subscription);

/* End it. */
void vdna_network_unsubscribe(const vdna_network *network, lcm_subscription_t *subscription);

/* Take one message, if one comes in time, and call the handlers of its channel. Returns 1 if a
 * message was taken, 0 if none came or a signal did, -1 if the connection is gone or the log has
 * ended.
 */
int vdna_network_take_one(const vdna_network *network, int32_t timeout_ms);

/* What a poll returns after that. */
vdna_status vdna_network_end(const vdna_network *network);

/* A stamp of the wall clock, in microseconds, by CLOCK_MONOTONIC. The present if it is no recent
 * one. */
int64_t vdna_network_monotonic_us(int64_t stamp_us);

/* When a message came off the socket, by CLOCK_MONOTONIC in microseconds; of a log, when it was
 * read. */
int64_t vdna_network_received_us(const vdna_network *network, const lcm_recv_buf_t *message);

#endif
