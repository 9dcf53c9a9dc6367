// Any bytes as a message of each type. If a check accepts a message, lcm-gen's decoder must accept
// it, read it to its last byte and encode it back to the same bytes.
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "message_sample.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity);

static void require(int condition, const char *type, const char *promise)
{
    if (condition)
        return;
    fprintf(stderr, "%s was accepted, but %s\n", type, promise);
    abort();
}

static void try_type(const vdna_message_type *type, const uint8_t *data, size_t size)
{
    if (vdna_transport_check(type, data, size) != VDNA_OK)
        return;
    void *message = sample_memory(type->struct_size);
    const int32_t length = (int32_t)size;
    require(type->decode(data, length, message) == length, type->name,
            "was not decoded to its end");
    uint8_t *encoded = sample_memory(size);
    require(type->encoded_size(message) == length &&
                type->encode(message, encoded, length) == length,
            type->name, "has another size when encoded again");
    require(memcmp(encoded, data, size) == 0, type->name, "has other bytes when encoded again");
    free(encoded);
    sample_free(type, message);
}

static void try_image(const uint8_t *data, size_t size)
{
    vdna_transport_frame frame;
    if (vdna_transport_parse_image(data, size, &frame) != VDNA_OK)
        return;
    const char *name = vdna_message_image.name;
    require(vdna_transport_check(&vdna_message_image, data, size) == VDNA_OK, name,
            "is not well-formed");
    require(frame.image.data >= data &&
                frame.image.size <= size - (size_t)(frame.image.data - data),
            name, "its picture is not within the message");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    try_image(data, size);
    for (unsigned i = 0; i < VDNA_MESSAGE_TYPES; i++)
        try_type(vdna_message_types[i], data, size);
    return 0;
}

// One well-formed message of each type.
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index >= VDNA_MESSAGE_TYPES)
        return 0;
    const vdna_message_type *type = vdna_message_types[index];
    void *message = sample_new(type);
    const int room = capacity < INT32_MAX ? (int)capacity : INT32_MAX;
    const int size = type->encode(message, out, room);
    sample_free(type, message);
    return size > 0 ? (size_t)size : 0;
}
