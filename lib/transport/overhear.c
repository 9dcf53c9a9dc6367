#include <string.h>
#include <vdna_messages.h>

#include "connection.h"
#include "cursor.h"

static bool is_camera_like(const vdna_transport_overheard *entry)
{
    return entry->fingerprint == vdna_message_image.fingerprint;
}

/* The entry of a channel, which may be a new one; NULL = no room. Whoever asks is looking for his
 * camera, so pictures displace anything else. */
static vdna_transport_overheard *entry_of(vdna_transport *transport, const char *channel,
                                          uint64_t fingerprint)
{
    vdna_transport_overheard *displaced = NULL;
    for (uint32_t i = 0; i < transport->overheard_count; i++) {
        vdna_transport_overheard *entry = &transport->overheard[i];
        if (strcmp(entry->channel, channel) == 0)
            return entry;
        if (!displaced && !is_camera_like(entry))
            displaced = entry;
    }

    vdna_transport_overheard *entry = transport->overheard_count < VDNA_TRANSPORT_OVERHEARD_MAX
                                          ? &transport->overheard[transport->overheard_count++]
                                      : fingerprint == vdna_message_image.fingerprint ? displaced
                                                                                      : NULL;
    if (entry) {
        *entry = (vdna_transport_overheard){.messages = 0};
        memcpy(entry->channel, channel, strlen(channel) + 1);
    }
    return entry;
}

/* see connection.h */
void vdna_transport_note(vdna_transport *transport, const char *channel,
                         const vdna_transport_incoming *message)
{
    if (!transport->is_overhearing)
        return;
    const uint64_t fingerprint = cursor_fingerprint(message->data, message->size);
    vdna_transport_overheard *entry = entry_of(transport, channel, fingerprint);
    if (!entry)
        return;
    entry->last_us = message->received_us;
    if (entry->messages++ == 0)
        entry->first_us = entry->last_us;
    entry->fingerprint = fingerprint;
}

/* LCM calls this for each message of the network. A log may have longer channel names than LCM
 * allows; nobody could subscribe to those. */
static void on_any(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    vdna_transport *transport = context;
    if (strcmp(channel, transport->camera) == 0 || strcmp(channel, transport->command) == 0 ||
        strcmp(channel, transport->peer) == 0 ||
        vdna_transport_check_channel(channel, NULL) != VDNA_OK)
        return;
    const vdna_transport_incoming message = {
        .data = received->data,
        .size = received->data_size,
        .received_us = vdna_network_received_us(&transport->network, received),
    };
    vdna_transport_note(transport, channel, &message);
}

/* Our receiver shows us all channels anyway. */
static vdna_status begin(vdna_transport *transport)
{
    vdna_status status = VDNA_OK;
    if (!transport->receiver)
        status = vdna_network_subscribe_all(&transport->network, OVERHEARD_QUEUE, on_any, transport,
                                            &transport->overhearing);
    if (status != VDNA_OK)
        return status;
    transport->is_overhearing = true;
    transport->overheard_count = 0;
    return VDNA_OK;
}

/* see vdna/transport.h */
vdna_status vdna_transport_overhear(vdna_transport *transport, uint32_t on)
{
    if (!transport || on > 1 || (!transport->camera[0] && !transport->command[0]))
        return VDNA_ERR_ARG;
    if (on)
        return transport->is_overhearing ? VDNA_OK : begin(transport);
    if (transport->overhearing)
        vdna_network_unsubscribe(&transport->network, transport->overhearing);
    transport->overhearing = NULL;
    transport->is_overhearing = false;
    return VDNA_OK;
}

/* see vdna/transport.h */
const vdna_transport_overheard *vdna_transport_overheard_channels(const vdna_transport *transport,
                                                                  uint32_t *out_count)
{
    if (!transport || !out_count)
        return NULL;
    *out_count = transport->overheard_count;
    return transport->overheard;
}
