#include <fail.h>
#include <growth.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/listener.h>

#include "inbox.h"
#include "network.h"
#include "url.h"

#define CHANNELS_MAX VDNA_REASSEMBLY_CHANNELS
#define QUEUE_MAX 65536u
#define OLDEST_CONFIG sizeof(vdna_listener_config) /* in version 0.1 */

/* One channel and its waiting message. One is enough: messages are taken off the network one at a
 * time, and each is handed to a subscription at most once. */
typedef struct subscription {
    const vdna_network *network;
    channel_name name;
    const vdna_message_type *type;
    void *decoded;                 /* [type->struct_size] */
    vdna_listener_message message; /* type NULL = none; data, if there is any, is `decoded` */
} subscription;

struct vdna_listener {
    vdna_network network;
    vdna_inbox *inbox;        /* NULL = messages come through LCM */
    subscription *handed_out; /* whose message the caller has; NULL = none */
    uint32_t count;
    subscription subscriptions[];
};

static const vdna_listener_config defaults = {.queue_length = VDNA_LISTENER_QUEUE};

/* see vdna/listener.h */
void vdna_listener_config_init(vdna_listener_config *config)
{
    vdna_config_write(config, OLDEST_CONFIG, &defaults, sizeof defaults);
}

static vdna_status read_config(const vdna_listener_config *given, vdna_error *error,
                               vdna_listener_config *config)
{
    *config = defaults;
    if (!vdna_config_read(given, OLDEST_CONFIG, config, sizeof *config))
        return vdna_fail(error, VDNA_ERR_ARG,
                         "listener: the configuration was not made by "
                         "vdna_listener_config_init() of this version or one since 0.1");
    if (config->queue_length == 0 || config->queue_length > QUEUE_MAX)
        return vdna_fail(error, VDNA_ERR_ARG, "listener: queue_length is %u, expected 1..%u",
                         config->queue_length, QUEUE_MAX);
    if (config->channel_count > CHANNELS_MAX)
        return vdna_fail(error, VDNA_ERR_ARG, "listener: channel_count is %u, expected 0..%u",
                         config->channel_count, CHANNELS_MAX);
    if (config->channel_count > 0 && !config->channels)
        return vdna_fail(error, VDNA_ERR_ARG, "listener: channels is NULL, expected %u of them",
                         config->channel_count);
    for (uint32_t i = 0; i < config->channel_count; i++) {
        const vdna_listener_channel *channel = &config->channels[i];
        const vdna_status status = vdna_transport_check_channel(channel->name, error);
        if (status != VDNA_OK)
            return status;
        if (!channel->type)
            return vdna_fail(error, VDNA_ERR_ARG,
                             "listener: channel %s has no type, expected one "
                             "of vdna_messages.h",
                             channel->name);
    }
    return VDNA_OK;
}

static void keep_message(subscription *s, const void *data, size_t size, int64_t received_us)
{
    vdna_listener_message message = {
        .type = s->type,
        .channel = s->name,
        .rejected = "a message of another type or version",
        .size = size,
        .received_us = received_us,
    };
    if (vdna_transport_check(s->type, data, size) == VDNA_OK &&
        s->type->decode(data, (int32_t)size, s->decoded) >= 0) {
        message.data = s->decoded;
        message.rejected = NULL;
    }
    s->message = message;
}

/* LCM calls this for each message on a channel; the bytes are LCM's and gone once it returns. */
static void on_message(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    (void)channel;
    subscription *s = context;
    keep_message(s, received->data, received->data_size,
                 vdna_network_received_us(s->network, received));
}

/* Hand a message that came by our own means to those who want it. */
static void keep_waiting(vdna_listener *listener, const vdna_inbox_message *waiting)
{
    const char *channel = listener->subscriptions[waiting->wanted].name;
    for (uint32_t i = 0; i < listener->count; i++) {
        subscription *s = &listener->subscriptions[i];
        if (strcmp(s->name, channel) != 0)
            continue;
        keep_message(s, waiting->data, waiting->size, waiting->received_us);
        if (waiting->size == waiting->total_size)
            continue;
        s->message.rejected = "a message larger than a listener keeps";
        s->message.size = (size_t)waiting->total_size;
    }
}

static void drop_message(subscription *s)
{
    if (s->message.data)
        s->type->cleanup(s->decoded);
    s->message = (vdna_listener_message){.type = NULL};
}

static vdna_status subscribe(vdna_listener *listener, const vdna_listener_channel *channel,
                             uint32_t queue_length, vdna_error *error)
{
    subscription *s = &listener->subscriptions[listener->count];
    memcpy(s->name, channel->name, strlen(channel->name) + 1);
    s->network = &listener->network;
    s->type = channel->type;
    s->decoded = malloc(s->type->struct_size);
    if (!s->decoded)
        return vdna_fail(error, VDNA_ERR_NOMEM, "listener: no memory left");
    listener->count++;
    if (listener->inbox)
        return VDNA_OK;
    return vdna_network_subscribe(s->network, s->name, queue_length, on_message, s, error);
}

/* Receive by our own means from udpm://, through LCM from anything else. */
static vdna_status open_inbox(vdna_listener *listener, const vdna_listener_config *config,
                              vdna_error *error)
{
    vdna_wanted_channel wanted[CHANNELS_MAX];
    const char *url = vdna_network_url(config->url);
    if (!url_has_scheme(url, "udpm://") || config->channel_count == 0)
        return VDNA_OK;
    /* The names stay as long as the inbox: subscribe() writes the same ones there. */
    for (uint32_t i = 0; i < config->channel_count; i++) {
        char *name = listener->subscriptions[i].name;
        memcpy(name, config->channels[i].name, strlen(config->channels[i].name) + 1);
        wanted[i] = (vdna_wanted_channel){name, VDNA_LISTENER_MESSAGE_BYTES_MAX};
    }
    return vdna_inbox_open(url, wanted, config->channel_count, config->queue_length, error,
                           &listener->inbox);
}

/* see vdna/listener.h */
vdna_status vdna_listener_open(const vdna_listener_config *given, vdna_error *error,
                               vdna_listener **out_listener)
{
    vdna_listener_config config;
    vdna_status status = read_config(given, error, &config);
    if (status != VDNA_OK)
        return status;
    if (!out_listener)
        return vdna_fail(error, VDNA_ERR_ARG, "listener: out_listener is NULL");

    vdna_listener *listener =
        calloc(1, sizeof *listener + config.channel_count * sizeof *listener->subscriptions);
    if (!listener)
        return vdna_fail(error, VDNA_ERR_NOMEM, "listener: no memory left");

    status = vdna_network_open(&listener->network, config.url, error);
    if (status == VDNA_OK)
        status = open_inbox(listener, &config, error);
    for (uint32_t i = 0; status == VDNA_OK && i < config.channel_count; i++)
        status = subscribe(listener, &config.channels[i], config.queue_length, error);
    if (status != VDNA_OK) {
        vdna_listener_close(listener);
        return status;
    }
    *out_listener = listener;
    return VDNA_OK;
}

/* The first channel with a waiting message, in LCM's order; NULL = none. */
static subscription *waiting(vdna_listener *listener)
{
    for (uint32_t i = 0; i < listener->count; i++)
        if (listener->subscriptions[i].message.type)
            return &listener->subscriptions[i];
    return NULL;
}

/* As vdna_network_take_one(), by our own means. */
static int take_waiting(vdna_listener *listener, int32_t timeout_ms)
{
    vdna_inbox_message *message = NULL;
    const int taken = vdna_inbox_take(listener->inbox, timeout_ms, &message);
    if (taken == 1)
        keep_waiting(listener, message);
    free(message);
    return taken;
}

static int take(vdna_listener *listener, int32_t timeout_ms)
{
    return listener->inbox ? take_waiting(listener, timeout_ms)
                           : vdna_network_take_one(&listener->network, timeout_ms);
}

/* see vdna/listener.h */
vdna_status vdna_listener_poll(vdna_listener *listener, int32_t timeout_ms,
                               vdna_listener_message *out_message)
{
    if (!listener || timeout_ms < 0 || timeout_ms > VDNA_TIMEOUT_MS_MAX || !out_message)
        return VDNA_ERR_ARG;

    if (listener->handed_out)
        drop_message(listener->handed_out);
    listener->handed_out = waiting(listener);
    if (!listener->handed_out) {
        if (take(listener, timeout_ms) < 0)
            return vdna_network_end(&listener->network);
        listener->handed_out = waiting(listener);
    }
    *out_message = listener->handed_out ? listener->handed_out->message
                                        : (vdna_listener_message){.type = NULL};
    return VDNA_OK;
}

/* see vdna/listener.h */
void vdna_listener_close(vdna_listener *listener)
{
    if (!listener)
        return;
    vdna_inbox_close(listener->inbox);
    vdna_network_close(&listener->network);
    for (uint32_t i = 0; i < listener->count; i++) {
        drop_message(&listener->subscriptions[i]);
        free(listener->subscriptions[i].decoded);
    }
    free(listener);
}
