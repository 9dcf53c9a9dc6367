// Any bytes as a message of each type. If a check accepts a message, lcm-gen's decoder must accept
// it, read it to its last byte and encode it back to the same bytes. A protected camera message
// that is accepted must be refused once a bit of its picture is flipped.
#include <bot_core_image_t.h>
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "connection.h"
#include "message_sample.h"
#include "protection.h"

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

// Where a well-formed camera message has the bytes of its picture, and their number.
#define IMAGE_SIZE_AT 32
#define IMAGE_DATA_AT 36

static size_t picture_size(const uint8_t *message)
{
    const uint8_t *at = message + IMAGE_SIZE_AT;
    return (size_t)at[0] << 24 | (size_t)at[1] << 16 | (size_t)at[2] << 8 | at[3];
}

// Mutations leave no checksum right, so write the right one, where there is a place for it.
static void try_protected(const uint8_t *data, size_t size)
{
    const size_t picture = picture_size(data);
    if (picture == 0 || size - IMAGE_DATA_AT - picture < VDNA_PROTECTION_BYTES)
        return;
    uint8_t *copy = sample_memory(size);
    memcpy(copy, data, size);
    vdna_protection_finish(copy, size, picture);
    vdna_transport_frame frame;
    vdna_protection protection;
    if (vdna_protection_parse_image(copy, size, &frame, &protection) == VDNA_OK &&
        protection.state == VDNA_PROTECTION_GOOD) {
        copy[IMAGE_DATA_AT + size % picture] ^= (uint8_t)(1u << size % 8);
        require(vdna_transport_parse_image(copy, size, &frame) == VDNA_ERR_FORMAT,
                vdna_message_image.name, "a bit of its picture is flipped");
    }
    free(copy);
}

static void try_image(const uint8_t *data, size_t size)
{
    if (vdna_transport_check(&vdna_message_image, data, size) == VDNA_OK)
        try_protected(data, size);
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

// A status of another daemon, whose machine has a name that can be shown.
static void try_peer(const uint8_t *data, size_t size)
{
    static vdna_transport transport;
    const vdna_transport_incoming message = {data, size, 1, NULL};
    const char *name = vdna_message_status.name;
    const bool is_status = vdna_transport_take_peer(&transport, &message);
    require(!is_status || vdna_transport_check(&vdna_message_status, data, size) == VDNA_OK, name,
            "is not well-formed");
    uint32_t count = 0;
    const vdna_transport_peer *peers = vdna_transport_peers(&transport, &count);
    require(count <= VDNA_TRANSPORT_PEERS_MAX && count >= (uint32_t)is_status, name,
            "the peers are not counted");
    for (uint32_t i = 0; i < count; i++) {
        const char *end = memchr(peers[i].host, '\0', sizeof peers[i].host);
        require(end != NULL, name, "the name of the machine has no end");
        for (const char *at = peers[i].host; at < end; at++)
            require(*at < 0 || *at >= ' ', name, "the name of the machine has control characters");
    }
}

// A command is handed out if it is well-formed, with as much of its argument as there is room for.
static void try_command(const uint8_t *data, size_t size)
{
    vdna_transport transport = {0};
    const vdna_transport_incoming message = {data, size, 1, NULL};
    const char *name = vdna_message_command.name;
    uint32_t count = 0;
    vdna_transport_take_command(&transport, &message);
    const vdna_transport_command *command = vdna_transport_commands(&transport, &count);
    require(count == (vdna_transport_check(&vdna_message_command, data, size) == VDNA_OK), name,
            "is not handed out");
    require(count + transport.counters.rejected == 1, name, "is not counted once");
    if (count == 0)
        return;
    const uint32_t most = sizeof command->argument - 1;
    require(strlen(command->argument) ==
                (command->argument_bytes < most ? command->argument_bytes : most),
            name, "has another argument");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    try_image(data, size);
    try_peer(data, size);
    try_command(data, size);
    for (unsigned i = 0; i < VDNA_MESSAGE_TYPES; i++)
        try_type(vdna_message_types[i], data, size);
    return 0;
}

static size_t protected_seed(uint8_t *out, int room)
{
    const vdna_transport_stream stream = {0x0123456789abcdef, 41};
    uint8_t pixels[] = {1, 2, 3, 4, 5, 6}, value[VDNA_PROTECTION_BYTES];
    vdna_protection_begin(&stream, value);
    bot_core_image_metadata_t entry = {VDNA_PROTECTION_KEY, sizeof value, value};
    const bot_core_image_t image = {1,      3, 2,     3, (int32_t)VDNA_PIXEL_GREY, sizeof pixels,
                                    pixels, 1, &entry};
    const int size = bot_core_image_t_encode(out, 0, room, &image);
    if (size <= 0)
        return 0;
    vdna_protection_finish(out, (size_t)size, sizeof pixels);
    return (size_t)size;
}

// One well-formed message of each type, and a protected camera message.
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    const int room = capacity < INT32_MAX ? (int)capacity : INT32_MAX;
    if (index == VDNA_MESSAGE_TYPES)
        return protected_seed(out, room);
    if (index > VDNA_MESSAGE_TYPES)
        return 0;
    const vdna_message_type *type = vdna_message_types[index];
    void *message = sample_new(type);
    const int size = type->encode(message, out, room);
    sample_free(type, message);
    return size > 0 ? (size_t)size : 0;
}
