/* Private: end-to-end protection of camera messages; docs/reference/SPEC-lcm.md defines it. */
#ifndef VDNA_PROTECTION_H
#define VDNA_PROTECTION_H

#include <vdna/transport.h>

/* The key in the metadata of a bot_core.image_t, and the bytes of its value. */
#define VDNA_PROTECTION_KEY "vdna.frame"
#define VDNA_PROTECTION_BYTES 21

typedef enum vdna_protection_state {
    VDNA_PROTECTION_NONE, /* the message has no such key */
    VDNA_PROTECTION_GOOD, /* its checksum is right */
    VDNA_PROTECTION_FALSE /* its checksum is not, or it is there twice, or it is of another form */
} vdna_protection_state;

typedef struct vdna_protection {
    vdna_protection_state state;
    vdna_transport_stream stream; /* of a GOOD one: whose frame it is, and its number there */
} vdna_protection;

/* Write the value, but for the checksum. */
void vdna_protection_begin(const vdna_transport_stream *stream,
                           uint8_t out_value[VDNA_PROTECTION_BYTES]);

/* Write the checksum into a message, whose last bytes are the value.
 * @param picture_bytes  the message's `size` */
void vdna_protection_finish(uint8_t *message, size_t message_bytes, size_t picture_bytes);

/* Read the protection of a camera message.
 * @param message        well-formed, as vdna_transport_check() says
 * @param picture_bytes  the message's `size` */
vdna_protection vdna_protection_read(const uint8_t *message, size_t message_bytes,
                                     size_t picture_bytes);

/* As vdna_transport_parse_image(), with the protection. Untouched unless the message is
 * well-formed: out_protection. Untouched unless VDNA_OK: out_frame. */
vdna_status vdna_protection_parse_image(const void *data, size_t size,
                                        vdna_transport_frame *out_frame,
                                        vdna_protection *out_protection);

#endif
