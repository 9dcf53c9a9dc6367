/* Private: the receiving end of a udpm:// network, in place of LCM's own: a socket, who may send,
 * and the messages of its datagrams. */
#ifndef VDNA_MULTICAST_H
#define VDNA_MULTICAST_H

#include <stdbool.h>

#include <vdna/transport.h>

#include "reassembly.h"

/* Own addresses that are known; a machine with more of them ignores senders on the others. */
#define VDNA_MULTICAST_OWN_MAX 64u
/* Bytes of the largest datagram, and some. */
#define VDNA_MULTICAST_DATAGRAM_MAX 65536u

/* Addresses are as inet_pton() writes them. */
typedef struct vdna_multicast {
    int socket;
    bool from_anywhere;                                          /* whether any machine may send */
    uint32_t allowed[VDNA_TRANSPORT_SOURCES_MAX], allowed_count; /* other machines that may */
    uint32_t own[VDNA_MULTICAST_OWN_MAX], own_count;
    int64_t own_read_us; /* when these were read */
    uint64_t foreign;    /* datagrams of senders that may not */
    uint64_t dropped;    /* datagrams that the system dropped: no room, or a false checksum */
    uint32_t dropped_mark;
    vdna_reassembly *messages;
    uint8_t datagram[VDNA_MULTICAST_DATAGRAM_MAX];
} vdna_multicast;

/* Bytes that a receiver of these channels takes. */
size_t vdna_multicast_mem_size(const vdna_wanted_channel *channels, uint32_t count);

/* Whether a text is an IPv4 address. */
bool vdna_multicast_is_source(const char *text);

/* Join the network of a udpm:// URL on the interface that its route names. Only this machine may
 * send if the URL's ttl is 0, or there are sources; these may then, too.
 * @param sources  [source_count], at most VDNA_TRANSPORT_SOURCES_MAX; each passes
 *                 vdna_multicast_is_source()
 * @param out_receiver  allocated; to be closed */
vdna_status vdna_multicast_open(const char *url, const char *const *sources, uint32_t source_count,
                                const vdna_wanted_channel *channels, uint32_t count,
                                vdna_error *error, vdna_multicast **out_receiver);

/* Leave it. NULL is allowed. */
void vdna_multicast_close(vdna_multicast *m);

/* Wait until datagrams have come. Returns 1; 0 if none came in time or a signal did; -1 if the
 * socket is gone. */
int vdna_multicast_wait(const vdna_multicast *m, int timeout_ms);

/* Count what the system has dropped. Returns how many datagrams since the call before. */
uint32_t vdna_multicast_count_dropped(vdna_multicast *m);

/* Take one datagram if there is one; out_arrival says what it amounts to, out_received_us when it
 * came, by CLOCK_MONOTONIC. Returns 1, 0 if there is none, -1 if the socket is gone. */
int vdna_multicast_take(vdna_multicast *m, vdna_arrival *out_arrival, int64_t *out_received_us);

#endif
