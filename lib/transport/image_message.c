#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cursor.h"
#include "protection.h"

/* see protection.h */
vdna_status vdna_protection_parse_image(const void *data, size_t size,
                                        vdna_transport_frame *out_frame,
                                        vdna_protection *out_protection)
{
    const vdna_status status = vdna_transport_check(&vdna_message_image, data, size);
    if (status != VDNA_OK)
        return status;

    vdna_transport_frame frame = {.received_us = 0};
    cursor c = cursor_begin(data, size, vdna_message_image.fingerprint);
    frame.utime = cursor_int64(&c);
    frame.image.width = cursor_count(&c);
    frame.image.height = cursor_count(&c);
    frame.image.row_stride = cursor_count(&c);
    frame.image.pixelformat = (uint32_t)cursor_unsigned(&c, sizeof(int32_t));
    frame.image.size = cursor_count(&c);
    frame.image.data = cursor_take(&c, frame.image.size, 1);

    /* A camera names its format. 0 would let the network choose among all file formats that the
     * picture decoder happens to know. */
    if (c.broken || frame.image.pixelformat == VDNA_PIXEL_ENCODED)
        return VDNA_ERR_FORMAT;
    *out_protection = vdna_protection_read(data, size, frame.image.size);
    if (out_protection->state == VDNA_PROTECTION_FALSE)
        return VDNA_ERR_FORMAT;
    *out_frame = frame;
    return VDNA_OK;
}

/* see vdna/transport.h */
vdna_status vdna_transport_parse_image(const void *data, size_t size,
                                       vdna_transport_frame *out_frame)
{
    vdna_protection protection;
    if (!out_frame)
        return VDNA_ERR_ARG;
    return vdna_protection_parse_image(data, size, out_frame, &protection);
}
