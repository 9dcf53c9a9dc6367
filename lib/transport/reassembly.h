/* Private: from LCM's datagrams to its messages. No sockets, no clock, no allocation: the caller
 * provides the memory, hands in one datagram after another, and is told what each one completes.
 * Nothing in a datagram is trusted.
 *
 * A short message is one datagram: magic "LC02", sequence, channel, NUL, data. A longer one comes
 * in fragments: magic "LC03", sequence, bytes of data, offset of the fragment in them, its number,
 * number of fragments, then its data; the channel and a NUL precede those of fragment 0. Fragments
 * may come in any order, more than once, and mixed with those of other messages. A message is
 * complete if all its fragments have come and each begins where the one before it ends, so that
 * there is no hole.
 *
 * Messages are kept in a few slots. Complete ones stay there while the caller holds them. */
#ifndef VDNA_REASSEMBLY_H
#define VDNA_REASSEMBLY_H

#include <stddef.h>
#include <stdint.h>

#include <vdna/status.h>

/* Most messages at a time, of which the caller may hold all but two. */
#define VDNA_REASSEMBLY_SLOTS 4u
/* Most messages half received from one sender. */
#define VDNA_REASSEMBLY_SLOTS_PER_SOURCE 3u
/* Messages that are remembered once they are settled, so that what comes of them again is ignored.
 */
#define VDNA_REASSEMBLY_SETTLED 256u
/* How long they are, and how long a message may pause; microseconds. */
#define VDNA_REASSEMBLY_PATIENCE_US 1000000
/* Senders on the first channel whose sequence numbers are followed. */
#define VDNA_REASSEMBLY_STREAMS 4u
/* Most channels that are wanted. */
#define VDNA_REASSEMBLY_CHANNELS 256u

typedef struct vdna_reassembly vdna_reassembly;

/* A channel whose messages are wanted. */
typedef struct vdna_wanted_channel {
    const char *name;  /* 1..VDNA_CHANNEL_BYTES_MAX bytes; must stay valid */
    uint32_t size_max; /* bytes of its largest message, at most VDNA_MESSAGE_BYTES_MAX */
} vdna_wanted_channel;

/* One datagram off the network. */
typedef struct vdna_datagram {
    const uint8_t *data;
    size_t size;     /* bytes */
    uint64_t source; /* identifies the sender: its address and port */
    int64_t time_us; /* when it came; time that runs backwards is taken for none */
} vdna_datagram;

/* What a datagram amounts to. */
typedef enum vdna_arrival_kind {
    VDNA_ARRIVAL_NOTHING,   /* no message yet, or none any more */
    VDNA_ARRIVAL_MESSAGE,   /* completes a message on a wanted channel */
    VDNA_ARRIVAL_TOO_LARGE, /* begins a message that is too large for its wanted channel */
    VDNA_ARRIVAL_OTHER      /* begins a message on another channel */
} vdna_arrival_kind;

typedef struct vdna_arrival {
    vdna_arrival_kind kind;
    uint32_t wanted;     /* index of the wanted channel; undefined for OTHER */
    uint32_t slot;       /* where a MESSAGE is; VDNA_REASSEMBLY_SLOTS = in the datagram */
    uint32_t sequence;   /* the sender's number of the message */
    uint64_t source;     /* as in the datagram */
    const char *channel; /* of the message; borrowed like `data` */
    const uint8_t *data; /* MESSAGE: all of it; otherwise its first bytes. Borrowed until the next
                            datagram is accepted; from the datagram or a slot */
    size_t size;         /* bytes there */
    uint64_t total_size; /* bytes of the message */
} vdna_arrival;

typedef struct vdna_reassembly_counters {
    uint64_t malformed; /* datagrams that break the format or contradict others of their message */
    uint64_t repeated;  /* datagrams that bring nothing new: duplicates, and fragments of messages
                           that  were complete, given up, too large or not wanted before */
    uint64_t
        incomplete; /* messages given up for others, or because the rest did not come in time */
} vdna_reassembly_counters;

/* Bytes that vdna_reassembly_init() needs. 0 = the channels are invalid: there must be
 * 1..VDNA_REASSEMBLY_CHANNELS. */
size_t vdna_reassembly_mem_size(const vdna_wanted_channel *channels, uint32_t count);

/* Begin, with no message. The first channel is the one whose losses are counted.
 * @param mem  aligned for uint64_t; not NULL; only the pages that messages fill are touched
 * @return the object at the beginning of `mem`; NULL if the channels or the memory do not do */
vdna_reassembly *vdna_reassembly_init(const vdna_wanted_channel *channels, uint32_t count,
                                      void *mem, size_t mem_size);

/* Take a datagram. */
vdna_arrival vdna_reassembly_accept(vdna_reassembly *r, const vdna_datagram *datagram);

/* Keep the MESSAGE that arrived last, until it is released. The caller may hold all slots but two.
 * @return its slot; its bytes are at vdna_reassembly_held() */
uint32_t vdna_reassembly_hold(vdna_reassembly *r, const vdna_arrival *message);
const uint8_t *vdna_reassembly_held(const vdna_reassembly *r, uint32_t slot);
void vdna_reassembly_release(vdna_reassembly *r, uint32_t slot);

const vdna_reassembly_counters *vdna_reassembly_count(const vdna_reassembly *r);

/* Messages that senders on the first channel numbered, and that never came whole; those that are
 * half received do not count yet. A sender's messages on other channels are among them. */
uint64_t vdna_reassembly_lost(const vdna_reassembly *r);

#endif
