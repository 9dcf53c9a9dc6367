#include <fail.h>
#include <growth.h>
#include <stdlib.h>
#include <string.h>

#include "connection.h"

#define DEFAULT_MAX_IMAGE_BYTES (8u << 20)

/* Bytes of vdna_transport_config in version 0.1: the publishing channels were removed before
 * that. */
#define OLDEST_CONFIG sizeof(vdna_transport_config)

static const vdna_transport_config defaults = {.max_image_bytes = DEFAULT_MAX_IMAGE_BYTES};

/* see vdna/transport.h */
void vdna_transport_config_init(vdna_transport_config *config)
{
    vdna_config_write(config, OLDEST_CONFIG, &defaults, sizeof defaults);
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
    return VDNA_OK;
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
static vdna_status reserve_picture(vdna_transport *transport, size_t size, vdna_error *error)
{
    if (!transport->camera[0])
        return VDNA_OK;
    transport->picture = malloc(size);
    if (!transport->picture)
        return vdna_fail(error, VDNA_ERR_NOMEM,
                         "transport: no %zu bytes of memory for a picture; lower max_image_bytes",
                         size);
    transport->picture_size = size;
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

/* LCM 1.3 to 1.5, udpm://: messages half received, all channels together; most bytes of a datagram;
 * LCM's own state. */
#define LCM_FRAGMENTS_MAX (16u << 20)
#define LCM_DATAGRAM_MAX 65536u
#define LCM_ITSELF (1u << 20)
/* Bytes of a camera message besides its picture; generous, because it may carry metadata. */
#define IMAGE_MESSAGE_OVERHEAD 4096u

/* see vdna/transport.h */
vdna_status vdna_transport_memory_of(const vdna_transport_config *config,
                                     vdna_transport_memory *out_memory)
{
    vdna_transport_config known;
    const vdna_status status = read_config(config, NULL, &known);
    if (status != VDNA_OK || !out_memory)
        return VDNA_ERR_ARG;

    const uint64_t image = known.camera_channel ? known.max_image_bytes : 0;
    const uint64_t message = known.max_image_bytes + IMAGE_MESSAGE_OVERHEAD;
    const uint64_t pictures = known.camera_channel ? VDNA_TRANSPORT_QUEUE + 1 : 0;
    const uint64_t commands = known.command_channel ? VDNA_TRANSPORT_QUEUE + 1 : 0;
    const uint64_t overheard = known.camera_channel ? OVERHEARD_QUEUE + 1 : 0;
    /* Each datagram passes through a ring buffer that grows by half when full, and earlier buffers
     * stay until they are empty: together at most three times their content. */
    const uint64_t rings = 3 * (pictures + commands + overheard + 1) * LCM_DATAGRAM_MAX;
    out_memory->own_bytes = sizeof(vdna_transport) + image + known.max_message_bytes;
    out_memory->lcm_bytes =
        (pictures + overheard + 1) * message + LCM_FRAGMENTS_MAX + rings + LCM_ITSELF;
    return VDNA_OK;
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

    status = keep_channel(transport->camera, known.camera_channel, error);
    if (status == VDNA_OK)
        status = keep_channel(transport->command, known.command_channel, error);
    if (status == VDNA_OK)
        status = reserve_picture(transport, known.max_image_bytes, error);
    if (status == VDNA_OK)
        status = reserve_message(transport, known.max_message_bytes, error);
    if (status == VDNA_OK)
        status = vdna_network_open(&transport->network, known.url, error);
    if (status == VDNA_OK)
        status = vdna_transport_subscribe(transport, error);
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
