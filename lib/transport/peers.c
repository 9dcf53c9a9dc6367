#include <string.h>
#include <vdna_messages.h>

#include "connection.h"
#include "cursor.h"

/* The entry of an instance, which may be a new one, in the place of the one silent for longest. */
static vdna_transport_peer *peer_of(vdna_transport *transport, int64_t instance)
{
    vdna_transport_peer *oldest = transport->peers;
    for (uint32_t i = 0; i < transport->peer_count; i++) {
        vdna_transport_peer *peer = &transport->peers[i];
        if (peer->instance == instance)
            return peer;
        if (peer->received_us < oldest->received_us)
            oldest = peer;
    }
    if (transport->peer_count < VDNA_TRANSPORT_PEERS_MAX)
        return &transport->peers[transport->peer_count++];
    return oldest;
}

/* Anybody may name a machine: control characters must not reach a terminal. */
static void keep_host(cursor *c, char out_host[VDNA_TRANSPORT_HOST_SIZE])
{
    const uint32_t length = cursor_count(c);
    const uint8_t *name = cursor_take(c, length, 1);
    memset(out_host, 0, VDNA_TRANSPORT_HOST_SIZE);
    for (uint32_t i = 0; name && name[i] && i + 1 < VDNA_TRANSPORT_HOST_SIZE; i++)
        out_host[i] = name[i] < ' ' || name[i] == 0x7f ? '?' : (char)name[i];
}

/* see connection.h */
bool vdna_transport_take_peer(vdna_transport *transport, const vdna_transport_incoming *message)
{
    if (vdna_transport_check(&vdna_message_status, message->data, message->size) != VDNA_OK)
        return false;
    cursor c = cursor_begin(message->data, message->size, vdna_message_status.fingerprint);
    cursor_int64(&c);                     /* utime */
    cursor_unsigned(&c, sizeof(int32_t)); /* state */
    const int64_t instance = cursor_int64(&c);
    vdna_transport_peer *peer = peer_of(transport, instance);
    peer->instance = instance;
    peer->serving_utime = cursor_int64(&c);
    peer->received_us = message->received_us;
    keep_host(&c, peer->host);
    return true;
}

/* see vdna/transport.h */
const vdna_transport_peer *vdna_transport_peers(const vdna_transport *transport,
                                                uint32_t *out_count)
{
    if (!transport || !out_count)
        return NULL;
    *out_count = transport->peer_count;
    return transport->peers;
}
