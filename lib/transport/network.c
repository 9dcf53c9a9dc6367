#include "network.h"

#include <errno.h>
#include <fail.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if VDNA_CHANNEL_BYTES_MAX != LCM_MAX_CHANNEL_NAME_LENGTH
#error "vdna/transport.h states another limit of channel names than lcm/lcm.h"
#endif
#if VDNA_MESSAGE_BYTES_MAX != LCM_MAX_MESSAGE_SIZE
#error "vdna/transport.h states another limit of messages than lcm/lcm.h"
#endif

#define QUEUED_MAX_US 60000000

/* see vdna/transport.h */
vdna_status vdna_transport_check_channel(const char *name, vdna_error *error)
{
    if (!name)
        return vdna_fail(error, VDNA_ERR_ARG, "transport: the channel name is NULL");
    const size_t length = strlen(name);
    if (length == 0 || length > VDNA_CHANNEL_BYTES_MAX)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "transport: channel name \"%s\" has %zu bytes, LCM allows 1..%d", name,
                         length, VDNA_CHANNEL_BYTES_MAX);
    return VDNA_OK;
}

/* The URL that LCM will use, by LCM's own rule. */
static const char *effective_url(const char *url)
{
    if (!url || !*url)
        url = getenv("LCM_DEFAULT_URL");
    return url && *url ? url : VDNA_LCM_URL;
}

static bool has_scheme(const char *url, const char *scheme)
{
    return strncmp(url, scheme, strlen(scheme)) == 0;
}

/* see network.h */
vdna_status vdna_network_open(vdna_network *out_network, const char *configured_url,
                              vdna_error *error)
{
    const char *url = effective_url(configured_url);
    const vdna_network opened = {lcm_create(url), has_scheme(url, "file://")};
    if (opened.lcm) {
        *out_network = opened;
        return VDNA_OK;
    }
    if (has_scheme(url, "udpm://"))
        return vdna_fail(
            error, VDNA_ERR_IO,
            "%.200s: LCM cannot use this network; expected a URL such as " VDNA_LCM_URL
            "; if this machine has no network, it lacks a route: `ip route add 224.0.0.0/4 dev lo`",
            url);
    return vdna_fail(error, VDNA_ERR_IO,
                     "%.200s: LCM cannot open this and says why on standard error; expected a URL "
                     "such as " VDNA_LCM_URL ", file:///path/to/log?speed=1 or memq://",
                     url);
}

/* see network.h */
void vdna_network_close(vdna_network *network)
{
    if (network->lcm)
        lcm_destroy(network->lcm);
    network->lcm = NULL;
}

/* LCM treats a channel as a regular expression that must match the whole name. */
static void escape(const char *name, char *out_pattern)
{
    for (; *name; name++) {
        if (strchr("\\^$.[|()?*+{", *name))
            *out_pattern++ = '\\';
        *out_pattern++ = *name;
    }
    *out_pattern = 0;
}

/* see network.h */
vdna_status vdna_network_subscribe(const vdna_network *network, const char *channel,
                                   uint32_t queue_length, lcm_msg_handler_t handler, void *context,
                                   vdna_error *error)
{
    char pattern[2 * sizeof(channel_name)];
    escape(channel, pattern);
    lcm_subscription_t *subscription = lcm_subscribe(network->lcm, pattern, handler, context);
    if (!subscription)
        return vdna_fail(error, VDNA_ERR_IO,
                         "channel %s: LCM cannot subscribe and says why on standard error; for "
                         "udpm:// check that the firewall lets multicast through and that `ip "
                         "route` has 224.0.0.0/4",
                         channel);
    lcm_subscription_set_queue_capacity(subscription, (int)queue_length);
    return VDNA_OK;
}

/* see network.h
 * Not lcm_handle_timeout(): it cannot tell a signal from the end. */
int vdna_network_take_one(const vdna_network *network, int32_t timeout_ms)
{
    struct pollfd incoming = {.fd = lcm_get_fileno(network->lcm), .events = POLLIN};
    if (incoming.fd < 0)
        return -1;
    const int ready = poll(&incoming, 1, timeout_ms);
    if (ready < 0)
        return errno == EINTR ? 0 : -1;
    if (ready == 0)
        return 0;
    return lcm_handle(network->lcm) == 0 ? 1 : -1;
}

static int64_t clock_us(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* see network.h
 * LCM stamps a message with the wall clock, which may have been set meanwhile: treat an impossible
 * wait as zero. */
int64_t vdna_network_received_us(const vdna_network *network, const lcm_recv_buf_t *message)
{
    const int64_t queued = clock_us(CLOCK_REALTIME) - message->recv_utime;
    const int64_t now = clock_us(CLOCK_MONOTONIC);
    if (network->is_log || queued < 0 || queued > QUEUED_MAX_US)
        return now;
    return now - queued;
}
