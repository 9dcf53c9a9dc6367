#include <assert.h>
#include <crc32c.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tensors.h"

/* Room for taps, preprocessing and nine short texts with every byte escaped, plus about 100 bytes
 * per tensor.
 */
#define HEADER_SIZE 12288u

/* The header as it grows: first its own length, 8 bytes little-endian, then the JSON. */
typedef struct header_text {
    char bytes[8 + HEADER_SIZE];
    size_t size;
} header_text;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
append(header_text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const size_t room = sizeof text->bytes - text->size;
    const int length = vsnprintf(text->bytes + text->size, room, format, arguments);
    va_end(arguments);
    /* The fields have known sizes: only a change of our code can get here. */
    assert(length >= 0 && (size_t)length < room);
    text->size += (size_t)length;
}

/* Append `"key":"value"`; a value is printable ASCII, so only two characters need escaping. */
static void append_text(header_text *text, const char *key, const char *value)
{
    append(text, "\"%s\":\"", key);
    for (; *value != '\0'; value++)
        append(text, *value == '"' || *value == '\\' ? "\\%c" : "%c", *value);
    append(text, "\"");
}

static void append_metadata(header_text *text, const vdna_text *texts, size_t count)
{
    const char *separator = "";
    append(text, "\"__metadata__\":{");
    for (size_t t = 0; t < count; t++)
        if (texts[t].value) {
            append(text, "%s", separator);
            append_text(text, texts[t].key, texts[t].value);
            separator = ",";
        }
    append(text, "},");
}

static void append_tensor(header_text *text, const vdna_field *field, uint64_t *offset)
{
    const uint64_t end = *offset + vdna_field_elements(field) * field->width;
    append(text, "\"%s\":{\"dtype\":\"%s\",\"shape\":[%" PRIu32, field->name, field->dtype,
           field->shape[0]);
    for (size_t d = 1; d < VDNA_FIELD_DIMENSIONS && field->shape[d] > 0; d++)
        append(text, ",%" PRIu32, field->shape[d]);
    append(text, "],\"data_offsets\":[%" PRIu64 ",%" PRIu64 "]}", *offset, end);
    *offset = end;
}

static void make_header(const vdna_text *texts, size_t text_count, const vdna_field *fields,
                        size_t field_count, header_text *out_text)
{
    const vdna_field crc = {VDNA_CRC_TENSOR, "U32", 4, 0, {1}, NULL};
    uint64_t offset = 0;
    out_text->size = 8;
    append(out_text, "{");
    append_metadata(out_text, texts, text_count);
    for (size_t f = 0; f < field_count; f++)
        if (fields[f].data) {
            append_tensor(out_text, &fields[f], &offset);
            append(out_text, ",");
        }
    append_tensor(out_text, &crc, &offset);
    append(out_text, "}");
    /* The data follows the header and begins with 8-byte numbers, which must be aligned. */
    while (out_text->size % 8 != 0)
        append(out_text, " ");

    const uint64_t length = out_text->size - 8;
    memcpy(out_text->bytes, &length, sizeof length);
}

static vdna_status write_part(const vdna_replace *file, const void *bytes, size_t size,
                              uint32_t *crc, vdna_error *error)
{
    *crc = vdna_crc32c(*crc, bytes, size);
    return vdna_replace_write(file, bytes, size, error);
}

vdna_status vdna_tensors_write(vdna_replace *file, const vdna_text *texts, size_t text_count,
                               const vdna_field *fields, size_t field_count, vdna_error *error)
{
    header_text header;
    make_header(texts, text_count, fields, field_count, &header);
    uint32_t crc = 0;
    vdna_status status = write_part(file, header.bytes, header.size, &crc, error);
    for (size_t f = 0; f < field_count && status == VDNA_OK; f++)
        if (fields[f].data) {
            const uint64_t size = vdna_field_elements(&fields[f]) * fields[f].width;
            status = write_part(file, fields[f].data, (size_t)size, &crc, error);
        }
    if (status == VDNA_OK)
        status = vdna_replace_write(file, &crc, sizeof crc, error);
    if (status != VDNA_OK)
        vdna_replace_abandon(file);
    return status;
}
