#include "connection.h"
#include "cursor.h"
#include <errno.h>
#include <fail.h>
#include <poll.h>
#include <time.h>
#include <vdna_msg_command_t.h>

/* Far more than LCM queues, which is 30 messages per channel: a backlog is always taken whole, and
 * still whoever floods a channel cannot keep us in one poll. */
#define MESSAGES_PER_POLL 256

#define POLL_TIMEOUT_MAX_MS 1000

#define QUEUED_MAX_US 60000000

static int64_t clock_us(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* When a message came off the socket, by the monotonic clock. LCM stamps it with the wall clock,
 * which may have been set meanwhile: a wait that cannot be is taken for none. The stamps of a log
 * are those of its recording. */
static int64_t received_us(const vdna_transport *transport, const lcm_recv_buf_t *message)
{
    const int64_t queued = clock_us(CLOCK_REALTIME) - message->recv_utime;
    const int64_t now = clock_us(CLOCK_MONOTONIC);
    if (transport->is_log || queued < 0 || queued > QUEUED_MAX_US)
        return now;
    return now - queued;
}

/* LCM calls this for each message on the camera channel; the bytes are LCM's and go when it
 * returns. */
static void on_image(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    vdna_transport *transport = context;
    vdna_transport_counters *counters = &transport->counters;
    vdna_transport_frame frame;
    if (vdna_transport_parse_image(message->data, message->data_size, &frame) != VDNA_OK) {
        counters->rejected++;
        return;
    }

    counters->received++;
    if (frame.image.size > counters->picture_bytes_max)
        counters->picture_bytes_max = frame.image.size;
    if (frame.image.size > transport->picture_size) {
        counters->oversized++;
        transport->unanswered++;
        return;
    }
    if (transport->events & VDNA_TRANSPORT_FRAME) {
        counters->skipped++;
        transport->unanswered++;
    }

    memcpy(transport->picture, frame.image.data, frame.image.size);
    frame.image.data = transport->picture;
    frame.received_us = received_us(transport, message);
    transport->events |= VDNA_TRANSPORT_FRAME;
    transport->frame = frame;
}

/* As on_image(), for the command channel. A command that this version does not know is counted
 * and otherwise ignored. */
static void on_command(const lcm_recv_buf_t *message, const char *channel, void *context)
{
    (void)channel;
    vdna_transport *transport = context;
    if (vdna_transport_check_command(message->data, message->data_size) != VDNA_OK) {
        transport->counters.rejected++;
        return;
    }

    cursor c = cursor_begin(message->data, message->data_size, __vdna_msg_command_t_get_hash());
    cursor_int64(&c); /* utime */
    if (cursor_unsigned(&c, sizeof(int32_t)) == VDNA_MSG_COMMAND_T_RESET)
        transport->events |= VDNA_TRANSPORT_RESET;
    transport->counters.commands++;
}

/* LCM takes a channel to be a regular expression that the whole name has to match. */
static void escape(const char *name, char *out_pattern)
{
    for (; *name; name++) {
        if (strchr("\\^$.[|()?*+{", *name))
            *out_pattern++ = '\\';
        *out_pattern++ = *name;
    }
    *out_pattern = 0;
}

static vdna_status subscribe(vdna_transport *transport, const char *channel,
                             lcm_msg_handler_t handler, vdna_error *error)
{
    if (!*channel)
        return VDNA_OK;
    char pattern[2 * sizeof(channel_name)];
    escape(channel, pattern);
    if (!lcm_subscribe(transport->lcm, pattern, handler, transport))
        return vdna_fail(error, VDNA_ERR_IO,
                         "channel %s: LCM cannot subscribe and says why on standard error; for "
                         "udpm:// check that the firewall lets multicast through and that `ip "
                         "route` has 224.0.0.0/4",
                         channel);
    return VDNA_OK;
}

/* see connection.h */
vdna_status vdna_transport_subscribe(vdna_transport *transport, vdna_error *error)
{
    const vdna_status status = subscribe(transport, transport->camera, on_image, error);
    if (status != VDNA_OK)
        return status;
    return subscribe(transport, transport->command, on_command, error);
}

/* Take one message, if one comes in time.
 * Returns 1 if a message was taken, 0 if none came or a signal did, -1 if the connection is gone.
 * Not lcm_handle_timeout(): it does not tell a signal from the end. */
static int take_one(vdna_transport *transport, int timeout_ms)
{
    struct pollfd incoming = {.fd = lcm_get_fileno(transport->lcm), .events = POLLIN};
    if (incoming.fd < 0)
        return -1;
    const int ready = poll(&incoming, 1, timeout_ms);
    if (ready < 0)
        return errno == EINTR ? 0 : -1;
    if (ready == 0)
        return 0;
    return lcm_handle(transport->lcm) == 0 ? 1 : -1;
}

/* Take all that is there. A live network goes on while we are away, so only its newest frame is
 * of interest; a log waits, so every frame of it is handed out, and a replay gives the same
 * answers at any speed. */
static int drain(vdna_transport *transport, int timeout_ms)
{
    int taken = take_one(transport, timeout_ms);
    uint32_t messages = taken == 1;
    while (taken == 1 && messages < MESSAGES_PER_POLL) {
        if (transport->is_log && transport->events != 0)
            break;
        taken = take_one(transport, 0);
        messages += taken == 1;
    }
    if (messages > transport->counters.backlog_max)
        transport->counters.backlog_max = messages;
    return taken;
}

/* see vdna/transport.h */
vdna_status vdna_transport_poll(vdna_transport *transport, int32_t timeout_ms, uint32_t *out_events,
                                vdna_transport_frame *out_frame)
{
    if (!transport || timeout_ms < 0 || timeout_ms > POLL_TIMEOUT_MAX_MS || !out_events ||
        !out_frame)
        return VDNA_ERR_ARG;

    transport->events = 0;
    /* What came before the end is handed out first: the next poll meets the end again. */
    if (drain(transport, timeout_ms) < 0 && transport->events == 0)
        return VDNA_ERR_IO;

    *out_events = transport->events;
    if (transport->events & VDNA_TRANSPORT_FRAME) {
        *out_frame = transport->frame;
        out_frame->skipped = transport->unanswered;
        transport->unanswered = 0;
    }
    return VDNA_OK;
}
