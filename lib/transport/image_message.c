#include "cursor.h"
#include <bot_core_image_t.h>
#include <vdna/transport.h>

/* Metadata is of no use to us, but must be well-formed for the message to be. */
static void skip_metadata(cursor *c)
{
    const uint32_t count = cursor_count(c);
    for (uint32_t i = 0; i < count && !c->broken; i++) {
        cursor_strings(c, 1);
        cursor_take(c, cursor_count(c), 1);
    }
}

/* see vdna/transport.h */
vdna_status vdna_transport_parse_image(const void *data, size_t size,
                                       vdna_transport_frame *out_frame)
{
    if (!out_frame)
        return VDNA_ERR_ARG;

    vdna_transport_frame frame = {.received_us = 0};
    cursor c = cursor_begin(data, size, __bot_core_image_t_get_hash());
    frame.utime = cursor_int64(&c);
    frame.image.width = cursor_count(&c);
    frame.image.height = cursor_count(&c);
    frame.image.row_stride = cursor_count(&c);
    frame.image.pixelformat = (uint32_t)cursor_unsigned(&c, sizeof(int32_t));
    frame.image.size = cursor_count(&c);
    frame.image.data = cursor_take(&c, frame.image.size, 1);
    skip_metadata(&c);

    /* A camera names its format. 0 would let the network choose among all file formats that the
     * picture decoder happens to know. */
    if (!cursor_complete(&c) || frame.image.pixelformat == VDNA_PIXEL_ENCODED)
        return VDNA_ERR_FORMAT;
    *out_frame = frame;
    return VDNA_OK;
}
