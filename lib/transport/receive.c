#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include "connection.h"
#include "cursor.h"

/* Far more than VDNA_TRANSPORT_QUEUE for each channel: a backlog is always taken whole, yet a flood
 * cannot trap one poll. */
#define MESSAGES_PER_POLL 256

/* LCM calls this for each message on the camera channel; the bytes are LCM's and gone once it
 * returns. */
static void on_image(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    vdna_transport *transport = context;
    vdna_transport_counters *counters = &transport->counters;
    vdna_transport_frame frame;
    transport->arrived++;
    if (vdna_transport_parse_image(message->data, message->data_size, &frame) != VDNA_OK) {
        counters->rejected++;
        counters->camera_rejected++;
        counters->camera_fingerprint = cursor_fingerprint(message->data, message->data_size);
        return;
    }

    counters->received++;
    if (frame.image.size > counters->picture_bytes_max)
        counters->picture_bytes_max = frame.image.size;
    if (frame.image.size > transport->picture_size) {
        counters->oversized++;
        counters->oversized_bytes = frame.image.size;
        transport->unanswered++;
        return;
    }
    if (transport->events & VDNA_TRANSPORT_FRAME) {
        counters->skipped++;
        transport->unanswered++;
    }

    memcpy(transport->picture, frame.image.data, frame.image.size);
    frame.image.data = transport->picture;
    frame.received_us = vdna_network_received_us(&transport->network, message);
    transport->events |= VDNA_TRANSPORT_FRAME;
    transport->frame = frame;
}

/* As on_image(), for the command channel. A command that this version does not know is counted
 * and otherwise ignored. */
static void on_command(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    vdna_transport *transport = context;
    transport->arrived++;
    if (vdna_transport_check(&vdna_message_command, message->data, message->data_size) != VDNA_OK) {
        transport->counters.rejected++;
        return;
    }

    cursor c = cursor_begin(message->data, message->data_size, vdna_message_command.fingerprint);
    cursor_int64(&c); /* utime */
    if (cursor_unsigned(&c, sizeof(int32_t)) == VDNA_MSG_COMMAND_T_RESET)
        transport->events |= VDNA_TRANSPORT_RESET;
    transport->counters.commands++;
}

static vdna_status subscribe(vdna_transport *transport, const char *channel,
                             lcm_msg_handler_t handler, vdna_error *error)
{
    if (!*channel)
        return VDNA_OK;
    return vdna_network_subscribe(&transport->network, channel, VDNA_TRANSPORT_QUEUE, handler,
                                  transport, error);
}

/* see connection.h */
vdna_status vdna_transport_subscribe(vdna_transport *transport, vdna_error *error)
{
    const vdna_status status = subscribe(transport, transport->camera, on_image, error);
    if (status != VDNA_OK)
        return status;
    return subscribe(transport, transport->command, on_command, error);
}

/* Take all waiting messages. A live network moves on while we work, so only its newest frame
 * matters; a log waits, so every frame of it is handed out, and a replay gives the same answers at
 * any speed. */
static int drain(vdna_transport *transport, int timeout_ms)
{
    transport->arrived = 0;
    int taken = vdna_network_take_one(&transport->network, timeout_ms);
    for (uint32_t messages = 1; taken == 1 && messages < MESSAGES_PER_POLL; messages++) {
        if (transport->network.log && transport->events != 0)
            break;
        taken = vdna_network_take_one(&transport->network, 0);
    }
    if (transport->arrived > transport->counters.backlog_max)
        transport->counters.backlog_max = transport->arrived;
    return taken;
}

/* see vdna/transport.h */
vdna_status vdna_transport_poll(vdna_transport *transport, int32_t timeout_ms, uint32_t *out_events,
                                vdna_transport_frame *out_frame)
{
    if (!transport || timeout_ms < 0 || timeout_ms > VDNA_TIMEOUT_MS_MAX || !out_events ||
        !out_frame)
        return VDNA_ERR_ARG;

    transport->events = 0;
    /* Messages before the end are handed out first: the next poll meets the end again. */
    const int taken = drain(transport, timeout_ms);
    if (transport->network.log)
        transport->counters.damaged_bytes = vdna_log_damaged_bytes(transport->network.log);
    if (taken < 0 && transport->events == 0)
        return vdna_network_end(&transport->network);

    *out_events = transport->events;
    if (transport->events & VDNA_TRANSPORT_FRAME) {
        *out_frame = transport->frame;
        out_frame->skipped = transport->unanswered;
        transport->unanswered = 0;
    }
    return VDNA_OK;
}
