#include "connection.h"
#include <bot_core_image_t.h>
#include <stdlib.h>
#include <vdna_msg_command_t.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

/* The encoders that lcm-gen writes take a complete message for granted: every function here
 * checks its message, makes room for it, encodes, and sends. */

/* see connection.h */
vdna_status vdna_transport_reserve(vdna_transport *transport, size_t size)
{
    if (size > LCM_MAX_MESSAGE_SIZE)
        return VDNA_ERR_ARG;
    if (size <= transport->message_size)
        return VDNA_OK;

    uint8_t *larger = malloc(size);
    if (!larger)
        return VDNA_ERR_NOMEM;
    free(transport->message);
    transport->message = larger;
    transport->message_size = size;
    return VDNA_OK;
}

/* Room for a message whose encoder asks for `size` bytes. */
static vdna_status reserve(vdna_transport *transport, int size)
{
    return size < 0 ? VDNA_ERR_ARG : vdna_transport_reserve(transport, (size_t)size);
}

/* Send the encoded message; `size` is what the encoder returned. */
static vdna_status send_encoded(vdna_transport *transport, const char *channel, int size)
{
    if (size < 0)
        return VDNA_ERR_ARG;
    if (lcm_publish(transport->lcm, channel, transport->message, (unsigned)size) != 0)
        return VDNA_ERR_IO;
    return VDNA_OK;
}

static bool is_complete_ranking(const vdna_msg_ranking_t *message)
{
    if (!message->backbone || !message->comparable || message->count < 0)
        return false;
    if (message->count > 0 && (!message->experience || !message->distance_bins || !message->tied ||
                               !message->predicted_recall))
        return false;
    for (int32_t i = 0; i < message->count; i++)
        if (!message->experience[i])
            return false;
    return true;
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_ranking(vdna_transport *transport,
                                           const vdna_msg_ranking_t *message)
{
    if (!transport || !transport->ranking[0] || !message || !is_complete_ranking(message))
        return VDNA_ERR_ARG;

    const int size = vdna_msg_ranking_t_encoded_size(message);
    const vdna_status status = reserve(transport, size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, transport->ranking,
                        vdna_msg_ranking_t_encode(transport->message, 0, size, message));
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_localisation(vdna_transport *transport,
                                                const vdna_msg_localisation_t *message)
{
    if (!transport || !transport->localisation[0] || !message || !message->experience)
        return VDNA_ERR_ARG;

    const int size = vdna_msg_localisation_t_encoded_size(message);
    const vdna_status status = reserve(transport, size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, transport->localisation,
                        vdna_msg_localisation_t_encode(transport->message, 0, size, message));
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_status(vdna_transport *transport,
                                          const vdna_msg_status_t *message)
{
    if (!transport || !transport->status[0] || !message || !message->experience ||
        !message->backbone || !message->version || !message->message)
        return VDNA_ERR_ARG;

    const int size = vdna_msg_status_t_encoded_size(message);
    const vdna_status status = reserve(transport, size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, transport->status,
                        vdna_msg_status_t_encode(transport->message, 0, size, message));
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_command(vdna_transport *transport,
                                           const vdna_msg_command_t *message)
{
    if (!transport || !transport->command[0] || !message || !message->argument)
        return VDNA_ERR_ARG;

    const int size = vdna_msg_command_t_encoded_size(message);
    const vdna_status status = reserve(transport, size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, transport->command,
                        vdna_msg_command_t_encode(transport->message, 0, size, message));
}

/* Whether the message's signed 32-bit members can hold the picture's. */
static bool is_sendable(const vdna_image *image)
{
    return image->data && image->size <= LCM_MAX_MESSAGE_SIZE && image->width <= INT32_MAX &&
           image->height <= INT32_MAX && image->row_stride <= INT32_MAX &&
           image->pixelformat != VDNA_PIXEL_ENCODED;
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_image(vdna_transport *transport, int64_t utime,
                                         const vdna_image *image)
{
    if (!transport || !transport->camera[0] || !image || !is_sendable(image))
        return VDNA_ERR_ARG;

    const bot_core_image_t message = {
        .utime = utime,
        .width = (int32_t)image->width,
        .height = (int32_t)image->height,
        .row_stride = (int32_t)image->row_stride,
        .pixelformat = (int32_t)image->pixelformat,
        .size = (int32_t)image->size,
        .data = (uint8_t *)image->data, /* the encoder only reads it */
    };
    const int size = bot_core_image_t_encoded_size(&message);
    const vdna_status status = reserve(transport, size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, transport->camera,
                        bot_core_image_t_encode(transport->message, 0, size, &message));
}
