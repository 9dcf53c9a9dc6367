#include <bot_core_image_t.h>
#include <stdlib.h>
#include <string.h>
#include <vdna_messages.h>

#include "connection.h"

/* see connection.h */
vdna_status vdna_transport_reserve(vdna_transport *transport, size_t size)
{
    if (size > VDNA_MESSAGE_BYTES_MAX)
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

/* A count in a struct. */
static int32_t count_at(const char *place)
{
    int32_t count;
    memcpy(&count, place, sizeof count);
    return count;
}

/* A pointer in a struct, whatever it points to. */
static const char *pointer_at(const char *place)
{
    const char *pointer;
    memcpy(&pointer, place, sizeof pointer);
    return pointer;
}

static bool is_complete(const vdna_message_type *type, const char *message);

static bool are_complete(const vdna_message_member *member, const char *elements, size_t length)
{
    if (!elements)
        return length == 0;
    if (member->kind == VDNA_MESSAGE_STRING)
        for (size_t i = 0; i < length; i++)
            if (!pointer_at(elements + i * sizeof(char *)))
                return false;
    if (member->kind == VDNA_MESSAGE_STRUCT)
        for (size_t i = 0; i < length; i++)
            if (!is_complete(member->type, elements + i * member->type->struct_size))
                return false;
    return true;
}

/* lcm-gen's encoders assume a complete message: no negative count, and no NULL among the pointers
 * that they follow. */
static bool is_complete(const vdna_message_type *type, const char *message)
{
    for (uint32_t i = 0; i < type->member_count; i++) {
        const vdna_message_member *member = &type->members[i];
        const char *elements = message + member->offset;
        size_t length = member->length;
        if (member->kind == VDNA_MESSAGE_COUNT && count_at(elements) < 0)
            return false;
        if (length == 0) {
            /* Not negative: a count precedes the members it counts, so it has been checked. */
            length = (size_t)count_at(message + type->members[member->count_member].offset);
            elements = pointer_at(elements);
        }
        if (!are_complete(member, elements, length))
            return false;
    }
    return true;
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish(vdna_transport *transport, const char *channel,
                                   const vdna_message_type *type, const void *message)
{
    if (!transport || vdna_transport_check_channel(channel, NULL) != VDNA_OK || !type || !message ||
        !is_complete(type, message))
        return VDNA_ERR_ARG;

    const int32_t size = type->encoded_size(message);
    if (size < 0)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_transport_reserve(transport, (size_t)size);
    if (status != VDNA_OK)
        return status;
    if (type->encode(message, transport->message, size) != size)
        return VDNA_ERR_ARG;
    if (transport->network.log)
        return VDNA_ERR_IO;
    if (lcm_publish(transport->network.lcm, channel, transport->message, (unsigned)size) != 0)
        return VDNA_ERR_IO;
    return VDNA_OK;
}

/* Whether the picture's numbers fit the message's signed 32-bit members. */
static bool is_sendable(const vdna_image *image)
{
    return image->data && image->size <= VDNA_MESSAGE_BYTES_MAX && image->width <= INT32_MAX &&
           image->height <= INT32_MAX && image->row_stride <= INT32_MAX &&
           image->pixelformat != VDNA_PIXEL_ENCODED;
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_image(vdna_transport *transport, const char *channel,
                                         int64_t utime, const vdna_image *image)
{
    if (!image || !is_sendable(image))
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
    return vdna_transport_publish(transport, channel, &vdna_message_image, &message);
}
