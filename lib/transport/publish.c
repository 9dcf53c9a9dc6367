#include <bot_core_image_t.h>
#include <stdlib.h>
#include <string.h>
#include <vdna_messages.h>

#include "connection.h"
#include "protection.h"

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
    memcpy((void *)&pointer, place, sizeof pointer);
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

/* Encode a message into transport->message. */
static vdna_status encode(vdna_transport *transport, const vdna_message_type *type,
                          const void *message, int32_t *out_size)
{
    const int32_t size = type->encoded_size(message);
    if (size < 0)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_transport_reserve(transport, (size_t)size);
    if (status != VDNA_OK)
        return status;
    if (type->encode(message, transport->message, size) != size)
        return VDNA_ERR_ARG;
    *out_size = size;
    return VDNA_OK;
}

/* Send the first bytes of transport->message. */
static vdna_status send_encoded(vdna_transport *transport, const char *channel, int32_t size)
{
    if (transport->network.log)
        return VDNA_ERR_IO;
    if (lcm_publish(transport->network.lcm, channel, transport->message, (unsigned)size) != 0)
        return VDNA_ERR_IO;
    return VDNA_OK;
}

static bool is_channel(const char *name)
{
    return vdna_transport_check_channel(name, NULL) == VDNA_OK;
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish(vdna_transport *transport, const char *channel,
                                   const vdna_message_type *type, const void *message)
{
    if (!transport || !is_channel(channel) || !type || !message || !is_complete(type, message))
        return VDNA_ERR_ARG;

    int32_t size;
    const vdna_status status = encode(transport, type, message, &size);
    if (status != VDNA_OK)
        return status;
    return send_encoded(transport, channel, size);
}

/* Whether the picture's numbers fit the message's signed 32-bit members. */
static bool is_sendable(const vdna_image *image)
{
    return image->data && image->size <= VDNA_MESSAGE_BYTES_MAX && image->width <= INT32_MAX &&
           image->height <= INT32_MAX && image->row_stride <= INT32_MAX &&
           image->pixelformat != VDNA_PIXEL_ENCODED;
}

static bot_core_image_t message_of(int64_t utime, const vdna_image *image)
{
    return (bot_core_image_t){
        .utime = utime,
        .width = (int32_t)image->width,
        .height = (int32_t)image->height,
        .row_stride = (int32_t)image->row_stride,
        .pixelformat = (int32_t)image->pixelformat,
        .size = (int32_t)image->size,
        .data = (uint8_t *)image->data, /* the encoder only reads it */
    };
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_image(vdna_transport *transport, const char *channel,
                                         int64_t utime, const vdna_image *image)
{
    if (!image || !is_sendable(image))
        return VDNA_ERR_ARG;

    const bot_core_image_t message = message_of(utime, image);
    return vdna_transport_publish(transport, channel, &vdna_message_image, &message);
}

/* see vdna/transport.h */
vdna_status vdna_transport_publish_protected_image(vdna_transport *transport, const char *channel,
                                                   int64_t utime, const vdna_image *image,
                                                   vdna_transport_stream *stream)
{
    if (!transport || !is_channel(channel) || !image || !is_sendable(image) || !stream)
        return VDNA_ERR_ARG;

    uint8_t value[VDNA_PROTECTION_BYTES];
    vdna_protection_begin(stream, value);
    bot_core_image_metadata_t entry = {VDNA_PROTECTION_KEY, sizeof value, value};
    bot_core_image_t message = message_of(utime, image);
    message.nmetadata = 1;
    message.metadata = &entry;

    int32_t size;
    const vdna_status status = encode(transport, &vdna_message_image, &message, &size);
    if (status == VDNA_ERR_ARG)
        return status;
    stream->sequence++;
    if (status != VDNA_OK)
        return status;
    vdna_protection_finish(transport->message, (size_t)size, image->size);
    return send_encoded(transport, channel, size);
}
