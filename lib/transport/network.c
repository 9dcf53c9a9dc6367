#include "network.h"

#include <errno.h>
#include <fail.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "url.h"

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

/* see network.h */
const char *vdna_network_url(const char *url)
{
    if (!url || !*url)
        url = getenv("LCM_DEFAULT_URL");
    return url && *url ? url : VDNA_LCM_URL;
}

/* see vdna/transport.h */
int32_t vdna_transport_is_log(const char *configured_url)
{
    const char *url = vdna_network_url(configured_url);
    const char *options = strchr(url, '?');
    const bool written = options && (strstr(options, "mode=w") || strstr(options, "mode=a"));
    return url_has_scheme(url, "file://") && !written;
}

/* see network.h */
vdna_status vdna_network_open(vdna_network *out_network, const char *configured_url,
                              vdna_error *error)
{
    const char *url = vdna_network_url(configured_url);
    vdna_network opened = {NULL, NULL};
    if (vdna_transport_is_log(url)) {
        opened.log = vdna_log_open(url);
        if (!opened.log)
            return vdna_fail(error, VDNA_ERR_IO,
                             "%.200s: the log cannot be opened: %s; expected a URL such as "
                             "file:///path/to/log?speed=1, or of a network, " VDNA_LCM_URL,
                             url, errno == EINVAL ? "it is no file" : strerror(errno));
    }
    opened.lcm = lcm_create(opened.log ? "memq://" : url);
    if (opened.lcm) {
        *out_network = opened;
        return VDNA_OK;
    }
    vdna_log_close(opened.log);
    if (url_has_scheme(url, "udpm://"))
        return vdna_fail(error, VDNA_ERR_IO,
                         "%.200s: LCM cannot use this network; expected a URL such as " VDNA_LCM_URL
                         "; " VDNA_LCM_REMEDY,
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
    vdna_log_close(network->log);
    *network = (vdna_network){NULL, NULL};
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
                         "channel %s: LCM cannot subscribe and says why on standard error; let the "
                         "firewall pass multicast; " VDNA_LCM_REMEDY,
                         channel);
    lcm_subscription_set_queue_capacity(subscription, (int)queue_length);
    return VDNA_OK;
}

/* see network.h */
vdna_status vdna_network_subscribe_all(const vdna_network *network, uint32_t queue_length,
                                       lcm_msg_handler_t handler, void *context,
                                       lcm_subscription_t **out_subscription)
{
    lcm_subscription_t *subscription = lcm_subscribe(network->lcm, ".*", handler, context);
    if (!subscription)
        return VDNA_ERR_IO;
    lcm_subscription_set_queue_capacity(subscription, (int)queue_length);
    *out_subscription = subscription;
    return VDNA_OK;
}

/* see network.h */
void vdna_network_unsubscribe(const vdna_network *network, lcm_subscription_t *subscription)
{
    lcm_unsubscribe(network->lcm, subscription);
}

/* Not lcm_handle_timeout(): it cannot tell a signal from the end. */
static int take_from_lcm(const vdna_network *network, int32_t timeout_ms)
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

/* see network.h
 * Events of a channel that nobody listens to leave nothing in LCM's queue. */
int vdna_network_take_one(const vdna_network *network, int32_t timeout_ms)
{
    if (!network->log)
        return take_from_lcm(network, timeout_ms);
    vdna_log_event event;
    const int taken = vdna_log_next(network->log, timeout_ms, &event);
    if (taken != 1)
        return taken;
    if (lcm_publish(network->lcm, event.channel, event.data, event.size) != 0)
        return -1;
    return take_from_lcm(network, 0) < 0 ? -1 : 1;
}

/* see network.h */
vdna_status vdna_network_end(const vdna_network *network)
{
    return network->log && vdna_log_damaged_bytes(network->log) > 0 ? VDNA_ERR_FORMAT : VDNA_ERR_IO;
}

static int64_t clock_us(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* see network.h
 * The wall clock may have been set meanwhile: treat an impossible wait as zero. */
int64_t vdna_network_monotonic_us(int64_t stamp_us)
{
    const int64_t queued = clock_us(CLOCK_REALTIME) - stamp_us;
    const int64_t now = clock_us(CLOCK_MONOTONIC);
    return queued < 0 || queued > QUEUED_MAX_US ? now : now - queued;
}

/* see network.h */
int64_t vdna_network_received_us(const vdna_network *network, const lcm_recv_buf_t *message)
{
    return vdna_network_monotonic_us(network->log ? 0 : message->recv_utime);
}
