#include <crc32c.h>
#include <fail.h>
#include <inttypes.h>
#include <string.h>

#include "tensors.h"

uint64_t vdna_field_elements(const vdna_field *field)
{
    uint64_t elements = 1;
    for (size_t d = 0; d < VDNA_FIELD_DIMENSIONS && field->shape[d] > 0; d++)
        elements *= field->shape[d];
    return elements;
}

int vdna_tensors_fit_host(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

static vdna_status check_version(const vdna_header *header, const vdna_format *format,
                                 vdna_error *reason)
{
    const char *name = vdna_header_text(header, "format");
    const char *version = vdna_header_text(header, "format_version");
    if (!name || strcmp(name, format->name) != 0)
        return vdna_fail(reason, VDNA_ERR_FORMAT, "a safetensors file whose format is not %s",
                         format->name);
    if (!version || *version < '1' || *version > '9' ||
        version[strspn(version, "0123456789")] != '\0')
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "format_version is not a whole number from 1, expected %u",
                         format->version);
    if (strlen(version) > 1 || (unsigned)(*version - '0') > format->version)
        return vdna_fail(reason, VDNA_ERR_UNSUPPORTED,
                         "format version %.20s is newer than this program, which reads %u", version,
                         format->version);
    return VDNA_OK;
}

static int has_shape(const vdna_tensor *tensor, const vdna_field *field)
{
    uint32_t d = 0;
    for (; d < VDNA_FIELD_DIMENSIONS && field->shape[d] > 0; d++)
        if (d >= tensor->dimensions || tensor->shape[d] != field->shape[d])
            return 0;
    return d == tensor->dimensions;
}

/* "2, 3" */
static const char *shape_text(const vdna_field *field, char out[64])
{
    size_t size = (size_t)snprintf(out, 64, "%" PRIu32, field->shape[0]);
    for (size_t d = 1; d < VDNA_FIELD_DIMENSIONS && field->shape[d] > 0; d++)
        size += (size_t)snprintf(out + size, 64 - size, ", %" PRIu32, field->shape[d]);
    return out;
}

/* Check a tensor's description in the header. */
static vdna_status check_tensor(const vdna_tensor *tensor, const vdna_field *field,
                                vdna_error *reason)
{
    char shape[64];
    if (strcmp(tensor->dtype, field->dtype) != 0 || !has_shape(tensor, field))
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "tensor %s has a dtype or shape that does not fit, expected %s [%s]",
                         field->name, field->dtype, shape_text(field, shape));
    /* Divide, because the product of a forged shape could wrap. */
    const uint64_t bytes = tensor->end - tensor->begin;
    if (bytes % field->width != 0 || bytes / field->width != vdna_field_elements(field))
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "tensor %s has %" PRIu64 " bytes, expected %" PRIu64 " numbers of %" PRIu32
                         " bytes",
                         field->name, bytes, vdna_field_elements(field), field->width);
    return VDNA_OK;
}

/* The numbers of a field are used in place. */
static vdna_status check_alignment(const vdna_tensor *tensor, const vdna_field *field,
                                   vdna_error *reason)
{
    if (tensor->begin % field->width == 0)
        return VDNA_OK;
    return vdna_fail(reason, VDNA_ERR_FORMAT,
                     "tensor %s begins at byte %" PRIu64 ", expected a multiple of %" PRIu32,
                     field->name, tensor->begin, field->width);
}

uint32_t vdna_tensors_checksum(const unsigned char *bytes, size_t size, const vdna_tensor *crc)
{
    const uint32_t before = vdna_crc32c(0, bytes, (size_t)crc->begin);
    return vdna_crc32c(before, bytes + crc->end, size - (size_t)crc->end);
}

static vdna_status check_checksum(const unsigned char *bytes, size_t size,
                                  const vdna_header *header, vdna_error *reason,
                                  uint32_t *out_checksum)
{
    const vdna_field field = {VDNA_CRC_TENSOR, "U32", 4, 0, {1}, NULL};
    const vdna_tensor *tensor = vdna_header_tensor(header, field.name);
    if (!tensor)
        return vdna_fail(reason, VDNA_ERR_FORMAT, "tensor " VDNA_CRC_TENSOR " is missing");
    const vdna_status status = check_tensor(tensor, &field, reason);
    if (status != VDNA_OK)
        return status;

    uint32_t written;
    memcpy(&written, bytes + tensor->begin, sizeof written);
    const uint32_t found = vdna_tensors_checksum(bytes, size, tensor);
    if (written != found)
        return vdna_fail(reason, VDNA_ERR_CHECKSUM,
                         "the bytes have CRC-32C %08" PRIx32 ", expected %08" PRIx32
                         ": the file is damaged",
                         found, written);
    *out_checksum = found;
    return VDNA_OK;
}

vdna_status vdna_tensors_header(const unsigned char *bytes, size_t size, const vdna_format *format,
                                vdna_error *reason, vdna_header *out_header)
{
    if (!vdna_tensors_fit_host())
        return vdna_fail(reason, VDNA_ERR_UNSUPPORTED,
                         "files of a map are read in place, which needs a little-endian machine");
    const vdna_status status = vdna_header_read(bytes, size, reason, out_header);
    return status == VDNA_OK ? check_version(out_header, format, reason) : status;
}

vdna_status vdna_tensors_read(const unsigned char *bytes, size_t size, const vdna_format *format,
                              vdna_error *reason, vdna_header *out_header, uint32_t *out_checksum)
{
    vdna_status status = vdna_tensors_header(bytes, size, format, reason, out_header);
    if (status == VDNA_OK)
        status = check_checksum(bytes, size, out_header, reason, out_checksum);
    return status;
}

vdna_status vdna_tensors_text(const vdna_header *header, const char *key, char *out,
                              size_t capacity, vdna_error *reason)
{
    const char *text = vdna_header_text(header, key);
    if (!text || strlen(text) >= capacity)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "%s in __metadata__ is %s, expected at most %zu bytes", key,
                         text ? "too long" : "missing", capacity - 1);
    memcpy(out, text, strlen(text) + 1);
    return VDNA_OK;
}

vdna_status vdna_tensors_find(const unsigned char *bytes, const vdna_header *header,
                              vdna_field *fields, size_t count, vdna_error *reason)
{
    for (size_t f = 0; f < count; f++) {
        const vdna_tensor *tensor = vdna_header_tensor(header, fields[f].name);
        if (!tensor)
            continue; /* the caller knows which ones may be absent */
        vdna_status status = check_tensor(tensor, &fields[f], reason);
        if (status == VDNA_OK)
            status = check_alignment(tensor, &fields[f], reason);
        if (status != VDNA_OK)
            return status;
        fields[f].data = bytes + tensor->begin;
    }
    return VDNA_OK;
}
