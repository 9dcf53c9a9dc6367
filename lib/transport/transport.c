#include <fail.h>
#include <growth.h>
#include <stdlib.h>
#include <string.h>

#include "connection.h"
#include "url.h"

#define DEFAULT_MAX_IMAGE_BYTES (8u << 20)

/* Bytes of vdna_transport_config in version 0.1: the publishing channels were removed before
 * that. */
#define OLDEST_CONFIG offsetof(vdna_transport_config, sources)

static const vdna_transport_config defaults = {.max_image_bytes = DEFAULT_MAX_IMAGE_BYTES};

/* see vdna/transport.h; in parentheses, because the header has a macro of this name */
void(vdna_transport_config_init)(vdna_transport_config *config)
{
    vdna_config_write(config, OLDEST_CONFIG, &defaults, sizeof defaults);
}

/* see vdna/transport.h */
void vdna_transport_config_init_sized(vdna_transport_config *config, size_t struct_size)
{
    vdna_config_write(config, struct_size, &defaults, sizeof defaults);
}

static vdna_status check_sources(const vdna_transport_config *config, vdna_error *error)
{
    if (config->source_count > VDNA_TRANSPORT_SOURCES_MAX)
        return vdna_fail(error, VDNA_ERR_ARG, "transport: source_count is %llu, expected 0..%u",
                         (unsigned long long)config->source_count, VDNA_TRANSPORT_SOURCES_MAX);
    if (config->source_count > 0 && !config->sources)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "transport: sources is NULL, but source_count is not 0");
    for (uint64_t i = 0; i < config->source_count; i++)
        if (!vdna_multicast_is_source(config->sources[i]))
            return vdna_fail(error, VDNA_ERR_ARG,
                             "transport: source \"%.60s\" is no IPv4 address such as 10.0.0.2",
                             config->sources[i] ? config->sources[i] : "NULL");
    return VDNA_OK;
}

/* Read a caller's config, and check it. */
static vdna_status read_config(const vdna_transport_config *given, vdna_error *error,
                               vdna_transport_config *config)
{
    *config = defaults;
    if (!vdna_config_read(given, OLDEST_CONFIG, config, sizeof *config))
        return vdna_fail(error, VDNA_ERR_ARG,
                         "transport: the configuration was not made by "
                         "vdna_transport_config_init() of this version or one since 0.1");
    if (config->max_image_bytes == 0 || config->max_image_bytes > VDNA_MESSAGE_BYTES_MAX)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "transport: max_image_bytes is %u, expected 1..%u, LCM's largest message",
                         config->max_image_bytes, VDNA_MESSAGE_BYTES_MAX);
    if (config->max_message_bytes > VDNA_MESSAGE_BYTES_MAX)
        return vdna_fail(
            error, VDNA_ERR_ARG,
            "transport: max_message_bytes is %u, expected 0..%u, LCM's largest message",
            config->max_message_bytes, VDNA_MESSAGE_BYTES_MAX);
    if (config->require_protection > 1)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "transport: require_protection is %u, expected 0 or 1",
                         config->require_protection);
    return check_sources(config, error);
}

static vdna_status keep_channel(channel_name out_name, const char *name, vdna_error *error)
{
    if (!name)
        return VDNA_OK;
    const vdna_status status = vdna_transport_check_channel(name, error);
    if (status == VDNA_OK)
        memcpy(out_name, name, strlen(name) + 1);
    return status;
}

/* Room for the largest picture now, so that a camera cannot make the process grow later. */
static vdna_status reserve_picture(vdna_transport *transport, vdna_error *error)
{
    if (!transport->camera[0])
        return VDNA_OK;
    transport->picture = malloc(transport->picture_max);
    if (!transport->picture)
        return vdna_fail(error, VDNA_ERR_NOMEM,
                         "transport: no %u bytes of memory for a picture; lower max_image_bytes",
                         transport->picture_max);
    return VDNA_OK;
}

static vdna_status reserve_message(vdna_transport *transport, size_t size, vdna_error *error)
{
    if (size > 0 && vdna_transport_reserve(transport, size) != VDNA_OK)
        return vdna_fail(error, VDNA_ERR_NOMEM,
                         "transport: no %zu bytes of memory for a message; lower "
                         "max_message_bytes",
                         size);
    return VDNA_OK;
}

/* LCM 1.3 to 1.5 over udpm://, which only sends: its state and its socket's. */
#define LCM_ITSELF (256u << 10)
/* Bytes of a camera message besides its picture; generous, because it may carry metadata. */
#define IMAGE_MESSAGE_OVERHEAD 4096u
/* Bytes of a command or a status; LCM sends as much in one datagram. */
#define COMMAND_MESSAGE_MAX 65499u

/* Camera, command, peer. */
#define CHANNELS 3u

static bool is_used(const char *channel)
{
    return channel && *channel;
}

/* The channels to receive on, the camera's first. Returns their number. */
static uint32_t channels_of(const char *camera, const char *command, const char *peer,
                            uint32_t max_image_bytes, vdna_wanted_channel out_channels[CHANNELS])
{
    uint32_t count = 0;
    uint32_t largest = max_image_bytes + IMAGE_MESSAGE_OVERHEAD;
    if (largest > VDNA_MESSAGE_BYTES_MAX)
        largest = VDNA_MESSAGE_BYTES_MAX;
    if (is_used(camera))
        out_channels[count++] = (vdna_wanted_channel){camera, largest};
    if (is_used(command))
        out_channels[count++] = (vdna_wanted_channel){command, COMMAND_MESSAGE_MAX};
    if (is_used(peer))
        out_channels[count++] = (vdna_wanted_channel){peer, COMMAND_MESSAGE_MAX};
    return count;
}

/* see vdna/transport.h */
vdna_status vdna_transport_memory_of(const vdna_transport_config *config,
                                     vdna_transport_memory *out_memory)
{
    vdna_transport_config known;
    const vdna_status status = read_config(config, NULL, &known);
    if (status != VDNA_OK || !out_memory)
        return VDNA_ERR_ARG;

    vdna_wanted_channel channels[CHANNELS];
    const uint32_t count = channels_of(known.camera_channel, known.command_channel,
                                       known.peer_channel, known.max_image_bytes, channels);
    const uint64_t receiver = count > 0 ? vdna_multicast_mem_size(channels, count) : 0;
    /* The frame that was handed out is in one of the receiver's slots. */
    const uint64_t image = known.camera_channel ? known.max_image_bytes : 0;
    out_memory->own_bytes = sizeof(vdna_transport) + image + known.max_message_bytes;
    out_memory->lcm_bytes = receiver - image + LCM_ITSELF;
    return VDNA_OK;
}

/* Receive by our own means from udpm://, through LCM from anything else. */
static vdna_status receive(vdna_transport *transport, const vdna_transport_config *config,
                           vdna_error *error)
{
    vdna_wanted_channel channels[CHANNELS];
    const char *url = vdna_network_url(config->url);
    const uint32_t count = channels_of(transport->camera, transport->command, transport->peer,
                                       transport->picture_max, channels);
    if (count > 0 && url_has_scheme(url, "udpm://"))
        return vdna_multicast_open(url, config->sources, (uint32_t)config->source_count, channels,
                                   count, error, &transport->receiver);
    const vdna_status status = reserve_picture(transport, error);
    if (status != VDNA_OK)
        return status;
    return vdna_transport_subscribe(transport, error);
}

/* see vdna/transport.h */
vdna_status vdna_transport_open(const vdna_transport_config *config, vdna_error *error,
                                vdna_transport **out_transport)
{
    vdna_transport_config known;
    vdna_status status = read_config(config, error, &known);
    if (status != VDNA_OK)
        return status;
    if (!out_transport)
        return vdna_fail(error, VDNA_ERR_ARG, "transport: out_transport is NULL");

    vdna_transport *transport = calloc(1, sizeof *transport);
    if (!transport)
        return vdna_fail(error, VDNA_ERR_NOMEM, "transport: no memory left");

    transport->picture_max = known.max_image_bytes;
    transport->require_protection = known.require_protection != 0;
    transport->lent_slot = VDNA_REASSEMBLY_SLOTS;
    status = keep_channel(transport->camera, known.camera_channel, error);
    if (status == VDNA_OK)
        status = keep_channel(transport->command, known.command_channel, error);
    if (status == VDNA_OK)
        status = keep_channel(transport->peer, known.peer_channel, error);
    if (status == VDNA_OK)
        status = reserve_message(transport, known.max_message_bytes, error);
    if (status == VDNA_OK)
        status = vdna_network_open(&transport->network, known.url, error);
    if (status == VDNA_OK)
        status = receive(transport, &known, error);
    if (status != VDNA_OK) {
        vdna_transport_close(transport);
        return status;
    }
    *out_transport = transport;
    return VDNA_OK;
}

/* see vdna/transport.h */
void vdna_transport_close(vdna_transport *transport)
{
    if (!transport)
        return;
    vdna_multicast_close(transport->receiver);
    vdna_network_close(&transport->network);
    free(transport->picture);
    free(transport->message);
    free(transport);
}

/* see vdna/transport.h */
const vdna_transport_counters *vdna_transport_count(const vdna_transport *transport)
{
    return transport ? &transport->counters : NULL;
}
