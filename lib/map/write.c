#include "write.h"

#include <assert.h>
#include <crc32c.h>
#include <fail.h>
#include <inttypes.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "journal.h"
#include "layout.h"
#include "position_frame.h"
#include "rules.h"

/* Room for taps, preprocessing and eight short texts with every byte escaped, plus about 100 bytes
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
    /* The fields have known sizes: only a change of this file can get here. */
    assert(length >= 0 && (size_t)length < room);
    text->size += (size_t)length;
}

/* Append `"key":"value",`; a value is printable ASCII, so only two characters need escaping. */
static void append_text(header_text *text, const char *key, const char *value)
{
    append(text, "\"%s\":\"", key);
    for (; *value != '\0'; value++)
        append(text, *value == '"' || *value == '\\' ? "\\%c" : "%c", *value);
    append(text, "\",");
}

static void append_tensor(header_text *text, const vdna_field *field, uint64_t *offset)
{
    const uint64_t end = *offset + vdna_layout_elements(field) * field->width;
    append(text, "\"%s\":{\"dtype\":\"%s\",\"shape\":[%" PRIu32, field->name, field->dtype,
           field->rows);
    if (field->columns > 0)
        append(text, ",%" PRIu32, field->columns);
    append(text, "],\"data_offsets\":[%" PRIu64 ",%" PRIu64 "]}", *offset, end);
    *offset = end;
}

static void append_metadata(header_text *text, const vdna_experience *e)
{
    char comparable[VDNA_SHA256_SIZE] = "";
    const char *const precision = vdna_identity_precision(&e->identity);
    vdna_identity_hash(&e->identity, comparable); /* cannot fail: vdna_rules_check() passed */
    append(text, "\"__metadata__\":{");
    append_text(text, "format", "vdna-experience");
    append_text(text, "name", e->name);
    append_text(text, "backbone", e->identity.backbone);
    append_text(text, "model_sha256", e->identity.model_sha256);
    append_text(text, "preprocessing", e->identity.preprocessing);
    if (strcmp(precision, VDNA_PRECISION_DEFAULT) != 0)
        append_text(text, "precision", precision);
    append_text(text, "taps", e->identity.taps);
    if (e->identity.embedding[0] != '\0')
        append_text(text, "embedding", e->identity.embedding);
    append_text(text, "comparable", comparable);
    if (e->frame_position)
        append_text(text, "position_frame", vdna_position_frame_of(e));
    if (e->order[0] != '\0')
        append_text(text, "order", e->order);
    append(text, "\"format_version\":\"%u\"},", vdna_layout_version(e));
}

static void make_header(const vdna_experience *e, const vdna_field fields[VDNA_FIELD_COUNT],
                        header_text *out_text)
{
    const vdna_field crc = {VDNA_CRC_TENSOR, "U32", 4, 0, 1, 0, NULL};
    uint64_t offset = 0;
    out_text->size = 8;
    append(out_text, "{");
    append_metadata(out_text, e);
    for (size_t f = 0; f < VDNA_FIELD_COUNT; f++)
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

static vdna_status write_parts(const vdna_replace *file, const header_text *header,
                               const vdna_field fields[VDNA_FIELD_COUNT], vdna_error *error)
{
    uint32_t crc = 0;
    vdna_status status = write_part(file, header->bytes, header->size, &crc, error);
    for (size_t f = 0; f < VDNA_FIELD_COUNT && status == VDNA_OK; f++)
        if (fields[f].data) {
            const uint64_t size = vdna_layout_elements(&fields[f]) * fields[f].width;
            status = write_part(file, fields[f].data, (size_t)size, &crc, error);
        }
    if (status == VDNA_OK)
        status = vdna_replace_write(file, &crc, sizeof crc, error);
    return status;
}

/* see write.h */
vdna_status vdna_write_check(const vdna_experience *experience, const char *path, vdna_error *error)
{
    if (!vdna_layout_fits_host())
        return vdna_fail(error, VDNA_ERR_UNSUPPORTED,
                         "%s: experience files are written from memory as it is, which needs a"
                         " little-endian machine",
                         path);
    vdna_error reason;
    const vdna_status status = vdna_rules_check(experience, &reason);
    if (status != VDNA_OK)
        return vdna_fail(error, status, "%s: not written: %s", path, reason.text);
    return VDNA_OK;
}

/* see write.h */
vdna_status vdna_write_into(vdna_replace *file, const vdna_experience *experience,
                            vdna_error *error)
{
    vdna_field fields[VDNA_FIELD_COUNT];
    header_text header;
    vdna_layout_of(experience, fields);
    make_header(experience, fields, &header);
    const vdna_status status = write_parts(file, &header, fields, error);
    if (status != VDNA_OK)
        vdna_replace_abandon(file);
    return status;
}

/* If an update of this directory was interrupted when it was final, finish it: it is older than the
 * file that is about to be replaced, and would replace it later. */
static vdna_status finish_update(const vdna_replace *file, vdna_error *error)
{
    if (faccessat(file->directory, VDNA_JOURNAL_FILE, F_OK, 0) != 0)
        return VDNA_OK;
    char directory[VDNA_REPLACE_PATH_SIZE];
    snprintf(directory, sizeof directory, "%.*s.", (int)(file->name - file->path), file->path);
    vdna_map_update *update = NULL;
    const vdna_status status = vdna_map_update_open(directory, error, &update);
    vdna_map_update_close(update);
    return status;
}

/* see vdna/map.h */
vdna_status vdna_experience_write(const vdna_experience *experience, const char *path,
                                  vdna_error *error)
{
    if (!experience || !path)
        return vdna_fail(error, VDNA_ERR_ARG, "experience to write: it or its path is missing");
    vdna_replace file;
    vdna_status status = vdna_write_check(experience, path, error);
    if (status == VDNA_OK)
        status = vdna_replace_begin(path, error, &file);
    if (status == VDNA_OK)
        status = vdna_write_into(&file, experience, error);
    if (status != VDNA_OK)
        return status;
    status = finish_update(&file, error);
    if (status == VDNA_OK)
        return vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, error);
    vdna_replace_abandon(&file);
    return status;
}
