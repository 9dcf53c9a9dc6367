#include <string.h>
#include <time.h>
#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include "connection.h"
#include "cursor.h"
#include "protection.h"

/* Far more than VDNA_TRANSPORT_QUEUE for each channel: a backlog is always taken whole, yet a flood
 * cannot trap one poll. */
#define MESSAGES_PER_POLL 256
/* The same for datagrams: more than a receive buffer of 8 MiB holds of the smallest. */
#define DATAGRAMS_PER_POLL 16384
/* A camera message with an empty picture and no metadata. */
#define IMAGE_FIXED_BYTES 40u
/* After this time without a message, the first lane is the next sender's. */
#define FIRST_SOURCE_SILENT_US 1000000

/* --- the camera --- */

static void reject_image(vdna_transport *transport, const vdna_transport_incoming *message)
{
    transport->counters.rejected++;
    transport->counters.camera_rejected++;
    transport->counters.camera_fingerprint = cursor_fingerprint(message->data, message->size);
}

static void note_size(vdna_transport *transport, uint64_t picture_bytes)
{
    if (picture_bytes > transport->counters.picture_bytes_max)
        transport->counters.picture_bytes_max = picture_bytes;
}

static void pass_over_image(vdna_transport *transport, uint64_t picture_bytes)
{
    transport->counters.received++;
    transport->counters.oversized++;
    transport->counters.oversized_bytes = picture_bytes;
    transport->unanswered++;
}

static void skip_image(vdna_transport *transport)
{
    transport->counters.received++;
    transport->counters.skipped++;
    transport->unanswered++;
}

/* A sender that floods the channel must not take the place of the camera's frames. */
static vdna_transport_lane *lane_of(vdna_transport *transport,
                                    const vdna_transport_incoming *message)
{
    const uint64_t source = message->arrival ? message->arrival->source : 0;
    if (source != transport->first_source &&
        message->received_us - transport->first_received_us < FIRST_SOURCE_SILENT_US) {
        transport->counters.other_sender_frames++;
        return &transport->lanes[1];
    }
    transport->first_source = source;
    transport->first_received_us = message->received_us;
    return &transport->lanes[0];
}

/* Whether a frame overtook this one on its way. */
static bool is_overtaken(const vdna_transport_lane *lane, const vdna_arrival *arrival)
{
    return arrival && arrival->source == lane->source &&
           arrival->sequence - lane->sequence > INT32_MAX;
}

static void keep_image(vdna_transport *transport, vdna_transport_lane *lane,
                       const vdna_transport_frame *frame, const vdna_transport_incoming *message)
{
    const vdna_arrival *arrival = message->arrival;
    const size_t before = (size_t)(frame->image.data - message->data);
    vdna_reassembly *messages = arrival ? transport->receiver->messages : NULL;
    if (arrival && lane->is_waiting)
        vdna_reassembly_release(messages, lane->slot);

    lane->is_waiting = true;
    lane->frame = *frame;
    lane->frame.received_us = message->received_us;
    if (arrival) {
        lane->source = arrival->source;
        lane->sequence = arrival->sequence;
        lane->slot = vdna_reassembly_hold(messages, arrival);
        lane->frame.image.data = vdna_reassembly_held(messages, lane->slot) + before;
    } else {
        memcpy(transport->picture, frame->image.data, frame->image.size);
        lane->frame.image.data = transport->picture;
    }
}

/* Read a camera message. Returns false, and counts why, if its frame is not to be used. */
static bool admit_image(vdna_transport *transport, const vdna_transport_incoming *message,
                        vdna_transport_frame *out_frame)
{
    vdna_transport_counters *counters = &transport->counters;
    vdna_protection protection = {.state = VDNA_PROTECTION_NONE};
    const vdna_status status =
        vdna_protection_parse_image(message->data, message->size, out_frame, &protection);
    if (protection.state == VDNA_PROTECTION_FALSE)
        counters->corrupted_frames++;
    if (status != VDNA_OK) {
        reject_image(transport, message);
        return false;
    }
    if (protection.state == VDNA_PROTECTION_GOOD)
        return vdna_streams_take(&transport->streams, &protection.stream, counters);
    counters->unprotected_frames++;
    if (transport->require_protection)
        reject_image(transport, message);
    return !transport->require_protection;
}

static void take_image(vdna_transport *transport, const vdna_transport_incoming *message)
{
    vdna_transport_frame frame;
    transport->arrived++;
    if (!admit_image(transport, message, &frame))
        return;
    note_size(transport, frame.image.size);
    if (frame.image.size > transport->picture_max) {
        pass_over_image(transport, frame.image.size);
        return;
    }
    vdna_transport_lane *lane = lane_of(transport, message);
    if (lane->is_waiting) {
        skip_image(transport);
        if (is_overtaken(lane, message->arrival))
            return;
    }
    keep_image(transport, lane, &frame, message);
}

/* A camera message of which only the beginning was kept. Its picture, with the metadata, has more
 * than max_image_bytes. */
static void take_large_image(vdna_transport *transport, const vdna_transport_incoming *message)
{
    transport->arrived++;
    if (cursor_fingerprint(message->data, message->size) != vdna_message_image.fingerprint) {
        reject_image(transport, message);
        return;
    }
    const uint64_t bytes = message->arrival->total_size - IMAGE_FIXED_BYTES;
    note_size(transport, bytes);
    pass_over_image(transport, bytes);
}

/* --- commands --- */

static void keep_command(vdna_transport *transport, const vdna_transport_command *command)
{
    transport->counters.commands++;
    if (transport->command_count == VDNA_TRANSPORT_COMMANDS_MAX) {
        transport->counters.commands_dropped++;
        return;
    }
    transport->commands[transport->command_count++] = *command;
    transport->events |= VDNA_TRANSPORT_COMMAND;
}

/* see connection.h */
void vdna_transport_take_command(vdna_transport *transport, const vdna_transport_incoming *message)
{
    transport->arrived++;
    if (vdna_transport_check(&vdna_message_command, message->data, message->size) != VDNA_OK) {
        transport->counters.rejected++;
        return;
    }

    cursor c = cursor_begin(message->data, message->size, vdna_message_command.fingerprint);
    vdna_transport_command command = {0};
    command.utime = cursor_int64(&c);
    command.command = (int32_t)cursor_unsigned(&c, sizeof(int32_t));
    command.argument_bytes = cursor_count(&c) - 1; /* checked: there is at least the NUL */
    const uint32_t room = VDNA_TRANSPORT_ARGUMENT_SIZE - 1;
    memcpy(command.argument, c.at, command.argument_bytes < room ? command.argument_bytes : room);
    /* So that a recording can be sent again. */
    if (command.command == VDNA_MSG_COMMAND_T_RESET)
        transport->streams.count = 0;
    keep_command(transport, &command);
}

/* --- other daemons --- */

static void take_status(vdna_transport *transport, const vdna_transport_incoming *message)
{
    if (!vdna_transport_take_peer(transport, message))
        transport->counters.rejected++;
}

/* --- through LCM --- */

static vdna_transport_incoming of_lcm(const vdna_transport *transport,
                                      const lcm_recv_buf_t *message)
{
    return (vdna_transport_incoming){
        .data = message->data,
        .size = message->data_size,
        .received_us = vdna_network_received_us(&transport->network, message),
    };
}

/* LCM calls this for each message on the camera channel; the bytes are LCM's and gone once it
 * returns. */
static void on_image(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    (void)channel;
    const vdna_transport_incoming message = of_lcm(context, received);
    take_image(context, &message);
}

/* As on_image(), for the command channel. */
static void on_command(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    (void)channel;
    const vdna_transport_incoming message = of_lcm(context, received);
    vdna_transport_take_command(context, &message);
}

/* As on_image(), for the peer channel. */
static void on_status(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    (void)channel;
    const vdna_transport_incoming message = of_lcm(context, received);
    take_status(context, &message);
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
    vdna_status status = subscribe(transport, transport->camera, on_image, error);
    if (status == VDNA_OK)
        status = subscribe(transport, transport->command, on_command, error);
    if (status == VDNA_OK)
        status = subscribe(transport, transport->peer, on_status, error);
    return status;
}

static bool has_events(const vdna_transport *transport)
{
    return transport->events != 0 || transport->lanes[0].is_waiting ||
           transport->lanes[1].is_waiting;
}

static void note_backlog(vdna_transport *transport)
{
    if (transport->arrived > transport->counters.backlog_max)
        transport->counters.backlog_max = transport->arrived;
}

/* Take all waiting messages. A live network moves on while we work, so only its newest frame
 * matters; a log waits, so every frame of it is handed out, and a replay gives the same answers at
 * any speed. */
static int poll_lcm(vdna_transport *transport, int timeout_ms)
{
    transport->arrived = 0;
    int taken = vdna_network_take_one(&transport->network, timeout_ms);
    for (uint32_t messages = 1; taken == 1 && messages < MESSAGES_PER_POLL; messages++) {
        if (transport->network.log && has_events(transport))
            break;
        taken = vdna_network_take_one(&transport->network, 0);
    }
    note_backlog(transport);
    return taken;
}

/* --- through our receiver --- */

static bool is_camera(const vdna_transport *transport, const vdna_arrival *arrival)
{
    return arrival->wanted == 0 && transport->camera[0];
}

static void take_arrival(vdna_transport *transport, const vdna_arrival *arrival,
                         int64_t received_us)
{
    const vdna_transport_incoming message = {arrival->data, arrival->size, received_us, arrival};
    switch (arrival->kind) {
    case VDNA_ARRIVAL_NOTHING:
        break;
    case VDNA_ARRIVAL_MESSAGE:
        if (is_camera(transport, arrival))
            take_image(transport, &message);
        else if (strcmp(arrival->channel, transport->command) == 0)
            vdna_transport_take_command(transport, &message);
        else
            take_status(transport, &message);
        break;
    case VDNA_ARRIVAL_TOO_LARGE:
        if (is_camera(transport, arrival)) {
            take_large_image(transport, &message);
        } else {
            transport->arrived++;
            transport->counters.rejected++;
        }
        break;
    case VDNA_ARRIVAL_OTHER:
        vdna_transport_note(transport, arrival->channel, &message);
    }
}

static int take_waiting(vdna_transport *transport)
{
    int taken = 1;
    transport->arrived = 0;
    for (uint32_t datagrams = 0; taken == 1 && datagrams < DATAGRAMS_PER_POLL; datagrams++) {
        vdna_arrival arrival;
        int64_t received_us;
        taken = vdna_multicast_take(transport->receiver, &arrival, &received_us);
        if (taken == 1)
            take_arrival(transport, &arrival, received_us);
    }
    note_backlog(transport);
    return taken;
}

static void skip_waiting_images(vdna_transport *transport)
{
    for (uint32_t i = 0; i < VDNA_TRANSPORT_LANES; i++) {
        vdna_transport_lane *lane = &transport->lanes[i];
        if (!lane->is_waiting)
            continue;
        vdna_reassembly_release(transport->receiver->messages, lane->slot);
        lane->is_waiting = false;
        skip_image(transport);
    }
}

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Wait for an event, taking what comes. While we were away, a full buffer keeps the oldest
 * datagrams and drops the newest; then the frames that we find are older than those that were lost,
 * and the next one is waited for instead. Once: in a lasting flood, some frame is better than none.
 */
static int poll_receiver(vdna_transport *transport, int timeout_ms)
{
    const int64_t until_ms = now_ms() + (has_events(transport) ? 0 : timeout_ms);
    bool may_skip = true;
    do {
        const int64_t left_ms = until_ms - now_ms();
        const int ready = vdna_multicast_wait(transport->receiver, left_ms > 0 ? (int)left_ms : 0);
        if (ready != 1)
            return ready;
        const bool overflowed = vdna_multicast_count_dropped(transport->receiver) > 0;
        if (take_waiting(transport) < 0)
            return -1;
        /* What was dropped while we were reading had a false checksum. */
        vdna_multicast_count_dropped(transport->receiver);
        if (overflowed && may_skip) {
            skip_waiting_images(transport);
            may_skip = false;
        }
    } while (!has_events(transport) && now_ms() < until_ms);
    return 1;
}

static void release_lent(vdna_transport *transport)
{
    if (transport->lent_slot < VDNA_REASSEMBLY_SLOTS)
        vdna_reassembly_release(transport->receiver->messages, transport->lent_slot);
    transport->lent_slot = VDNA_REASSEMBLY_SLOTS;
}

static void copy_receiver_counters(vdna_transport *transport)
{
    const vdna_multicast *receiver = transport->receiver;
    const vdna_reassembly_counters *messages = vdna_reassembly_count(receiver->messages);
    vdna_transport_counters *counters = &transport->counters;
    counters->lost = transport->camera[0] ? vdna_reassembly_lost(receiver->messages) : 0;
    counters->incomplete = messages->incomplete;
    counters->dropped_datagrams = receiver->dropped;
    counters->malformed_datagrams = messages->malformed;
    counters->repeated_datagrams = messages->repeated;
    counters->foreign_datagrams = receiver->foreign;
}

/* --- both --- */

static int poll_network(vdna_transport *transport, int timeout_ms)
{
    if (!transport->receiver)
        return poll_lcm(transport, timeout_ms);
    release_lent(transport);
    const int taken = poll_receiver(transport, timeout_ms);
    copy_receiver_counters(transport);
    return taken;
}

/* Hand out the waiting frame of one lane, by turns; the other's stays, and does not count as
 * received until its fate is known. */
static void hand_out(vdna_transport *transport, vdna_transport_frame *out_frame)
{
    if (transport->lanes[!transport->served].is_waiting)
        transport->served = !transport->served;
    vdna_transport_lane *lane = &transport->lanes[transport->served];
    if (!lane->is_waiting)
        return;
    lane->is_waiting = false;
    transport->counters.received++;
    *out_frame = lane->frame;
    out_frame->skipped = transport->unanswered;
    transport->unanswered = 0;
    transport->events |= VDNA_TRANSPORT_FRAME;
    if (transport->receiver)
        transport->lent_slot = lane->slot;
}

/* see vdna/transport.h */
vdna_status vdna_transport_poll(vdna_transport *transport, int32_t timeout_ms, uint32_t *out_events,
                                vdna_transport_frame *out_frame)
{
    if (!transport || timeout_ms < 0 || timeout_ms > VDNA_TIMEOUT_MS_MAX || !out_events ||
        !out_frame)
        return VDNA_ERR_ARG;

    transport->events = 0;
    transport->command_count = 0;
    /* Messages before the end are handed out first: the next poll meets the end again. */
    const int taken = poll_network(transport, timeout_ms);
    if (transport->network.log)
        transport->counters.damaged_bytes = vdna_log_damaged_bytes(transport->network.log);
    if (taken < 0 && !has_events(transport))
        return vdna_network_end(&transport->network);

    hand_out(transport, out_frame);
    *out_events = transport->events;
    return VDNA_OK;
}

/* see vdna/transport.h */
const vdna_transport_command *vdna_transport_commands(const vdna_transport *transport,
                                                      uint32_t *out_count)
{
    if (transport && out_count)
        *out_count = transport->command_count;
    return transport ? transport->commands : NULL;
}
