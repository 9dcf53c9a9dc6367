#include "header.h"

#include <fail.h>
#include <inttypes.h>
#include <string.h>

#include "json.h"

/* Bytes of the header's length, the first field of a file. */
#define LENGTH_SIZE 8u

const vdna_tensor *vdna_header_tensor(const vdna_header *header, const char *name)
{
    for (uint32_t t = 0; t < header->tensor_count; t++)
        if (strcmp(header->tensors[t].name, name) == 0)
            return &header->tensors[t];
    return NULL;
}

const char *vdna_header_text(const vdna_header *header, const char *key)
{
    for (uint32_t t = 0; t < header->text_count; t++)
        if (strcmp(header->texts[t].key, key) == 0)
            return header->texts[t].value;
    return NULL;
}

static int take_text(vdna_json *json, vdna_header *header)
{
    if (header->text_count == VDNA_HEADER_TEXTS)
        return vdna_json_fail(json, "no more than 32 texts in __metadata__");
    vdna_metadata *text = &header->texts[header->text_count];
    if (!vdna_json_string(json, text->key, sizeof text->key) || !vdna_json_take(json, ':') ||
        !vdna_json_string(json, text->value, sizeof text->value))
        return 0;
    if (vdna_header_text(header, text->key))
        return vdna_json_fail(json, "each key of __metadata__ once");
    header->text_count++;
    return 1;
}

static int take_metadata(vdna_json *json, vdna_header *header)
{
    if (header->has_metadata)
        return vdna_json_fail(json, "one __metadata__ only");
    header->has_metadata = 1;
    if (!vdna_json_take(json, '{'))
        return 0;
    if (vdna_json_try(json, '}'))
        return 1;
    do {
        if (!take_text(json, header))
            return 0;
    } while (vdna_json_try(json, ','));
    return vdna_json_take(json, '}');
}

static int take_shape(vdna_json *json, vdna_tensor *tensor)
{
    if (!vdna_json_take(json, '['))
        return 0;
    if (vdna_json_try(json, ']'))
        return 1;
    do {
        if (tensor->dimensions == VDNA_HEADER_DIMENSIONS)
            return vdna_json_fail(json, "no more than 8 dimensions");
        if (!vdna_json_number(json, &tensor->shape[tensor->dimensions]))
            return 0;
        tensor->dimensions++;
    } while (vdna_json_try(json, ','));
    return vdna_json_take(json, ']');
}

static int take_offsets(vdna_json *json, vdna_tensor *tensor)
{
    return vdna_json_take(json, '[') && vdna_json_number(json, &tensor->begin) &&
           vdna_json_take(json, ',') && vdna_json_number(json, &tensor->end) &&
           vdna_json_take(json, ']');
}

/* Take one member of a tensor's description; `seen` has a bit for each one taken. */
static int take_member(vdna_json *json, vdna_tensor *tensor, unsigned *seen)
{
    static const char *const names[] = {"dtype", "shape", "data_offsets"};
    char name[VDNA_HEADER_KEY_SIZE];
    if (!vdna_json_string(json, name, sizeof name) || !vdna_json_take(json, ':'))
        return 0;
    unsigned member = 0;
    while (member < 3 && strcmp(name, names[member]) != 0)
        member++;
    if (member == 3 || (*seen & 1u << member))
        return vdna_json_fail(json, "dtype, shape and data_offsets once each and nothing else");
    *seen |= 1u << member;
    if (member == 0)
        return vdna_json_string(json, tensor->dtype, sizeof tensor->dtype);
    return member == 1 ? take_shape(json, tensor) : take_offsets(json, tensor);
}

/* Keep the tensors sorted by their bytes; an empty one goes before the one it touches. */
static void insert(vdna_header *header, const vdna_tensor *tensor)
{
    uint32_t place = header->tensor_count++;
    for (; place > 0; place--) {
        const vdna_tensor *before = &header->tensors[place - 1];
        if (before->begin < tensor->begin ||
            (before->begin == tensor->begin && before->end <= tensor->end))
            break;
        header->tensors[place] = *before;
    }
    header->tensors[place] = *tensor;
}

static int take_tensor(vdna_json *json, const char *name, vdna_header *header)
{
    if (header->tensor_count == VDNA_HEADER_TENSORS)
        return vdna_json_fail(json, "no more than 32 tensors");
    if (vdna_header_tensor(header, name))
        return vdna_json_fail(json, "each tensor once");

    vdna_tensor tensor = {0};
    memcpy(tensor.name, name, strlen(name) + 1);
    unsigned seen = 0;
    if (!vdna_json_take(json, '{') || !take_member(json, &tensor, &seen) ||
        !vdna_json_take(json, ',') || !take_member(json, &tensor, &seen) ||
        !vdna_json_take(json, ',') || !take_member(json, &tensor, &seen) ||
        !vdna_json_take(json, '}'))
        return 0;
    insert(header, &tensor);
    return 1;
}

static int take_header(vdna_json *json, vdna_header *header)
{
    /* safetensors allows white space behind the object, but not before it. */
    if (json->at == json->end || *json->at != '{')
        return vdna_json_fail(json, "'{'");
    vdna_json_take(json, '{');
    do {
        char key[VDNA_HEADER_KEY_SIZE];
        if (!vdna_json_string(json, key, sizeof key) || !vdna_json_take(json, ':'))
            return 0;
        if (!(strcmp(key, "__metadata__") == 0 ? take_metadata(json, header)
                                               : take_tensor(json, key, header)))
            return 0;
    } while (vdna_json_try(json, ','));
    return vdna_json_take(json, '}') && vdna_json_end(json);
}

/* Check that the tensors, now sorted, tile the data, and make their offsets relative to the file's
 * first byte. */
static vdna_status place_tensors(vdna_header *header, size_t data, size_t size, vdna_error *reason)
{
    uint64_t filled = 0;
    for (uint32_t t = 0; t < header->tensor_count; t++) {
        vdna_tensor *tensor = &header->tensors[t];
        if (tensor->begin != filled || tensor->end < tensor->begin || tensor->end > size - data)
            return vdna_fail(reason, VDNA_ERR_FORMAT,
                             "a tensor has data_offsets %" PRIu64 "..%" PRIu64 ", expected to begin"
                             " at %" PRIu64 " and to end within %zu bytes: the file is cut short,"
                             " or its tensors leave a gap or overlap",
                             tensor->begin, tensor->end, filled, size - data);
        filled = tensor->end;
        tensor->begin += data;
        tensor->end += data;
    }
    if (filled != size - data)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "the tensors take %" PRIu64 " bytes, but %zu follow the header", filled,
                         size - data);
    return VDNA_OK;
}

vdna_status vdna_header_read(const unsigned char *bytes, size_t size, vdna_error *reason,
                             vdna_header *out_header)
{
    if (size < LENGTH_SIZE)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "the file has %zu bytes, expected at least the 8 of a header's length",
                         size);
    uint64_t length = 0;
    for (size_t i = LENGTH_SIZE; i > 0; i--)
        length = length << 8 | bytes[i - 1];
    if (length > size - LENGTH_SIZE)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "the header claims %" PRIu64 " bytes, but only %zu follow: the file is"
                         " cut short or no file of a map",
                         length, size - LENGTH_SIZE);

    const size_t data = LENGTH_SIZE + (size_t)length;
    vdna_json json = {bytes + LENGTH_SIZE, bytes + data, NULL};
    memset(out_header, 0, sizeof *out_header);
    if (!take_header(&json, out_header))
        return vdna_fail(reason, VDNA_ERR_FORMAT, "byte %zu of the file: expected %s",
                         (size_t)(json.at - bytes), json.expected);
    return place_tensors(out_header, data, size, reason);
}
