/* Private: a thread that takes messages off a udpm:// network into a queue, so that whoever reads
 * them may take his time. */
#ifndef VDNA_INBOX_H
#define VDNA_INBOX_H

#include "reassembly.h"

/* Bytes of messages that wait; more are dropped, the newest first. */
#define VDNA_INBOX_BYTES_MAX (64u << 20)

typedef struct vdna_inbox vdna_inbox;

/* A message that waits, allocated, with its bytes behind it. */
typedef struct vdna_inbox_message {
    struct vdna_inbox_message *next;
    uint32_t wanted; /* index of its channel */
    int64_t received_us;
    uint64_t total_size; /* bytes of the message */
    size_t size;         /* bytes there: all, or 0 if it was too large */
    uint8_t data[];
} vdna_inbox_message;

/* Begin. The names of the channels must stay valid; `queue_length` messages of each wait. */
vdna_status vdna_inbox_open(const char *url, const vdna_wanted_channel *channels, uint32_t count,
                            uint32_t queue_length, vdna_error *error, vdna_inbox **out_inbox);

/* Wait for the next message, to be freed by the caller. Returns 1; 0 if none came in time or a
 * signal did; -1 if the network is gone. */
int vdna_inbox_take(vdna_inbox *inbox, int32_t timeout_ms, vdna_inbox_message **out_message);

/* End it. NULL is allowed. */
void vdna_inbox_close(vdna_inbox *inbox);

#endif
