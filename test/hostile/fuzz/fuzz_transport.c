// Any bytes as a message. What a check accepts, the decoder that lcm-gen writes must accept and
// read to its last byte, and encode back to the same bytes.
#include "lcm_samples.h"
#include <stdio.h>
#include <vdna/transport.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity);

static void require(int condition, const char *type, const char *promise)
{
    if (condition)
        return;
    fprintf(stderr, "%s was accepted, but %s\n", type, promise);
    abort();
}

// void round_trip_TYPE(data, size): decode a message of that type that was accepted, and encode it.
#define DEFINE_ROUND_TRIP(type)                                                                 \
    static void round_trip_##type(const uint8_t *data, size_t size)                             \
    {                                                                                           \
        type message;                                                                           \
        memset(&message, 0, sizeof message);                                                    \
        const int decoded = type##_decode(data, 0, (int)size, &message);                        \
        require(decoded == (int)size, #type, "was not decoded to its end");                     \
        uint8_t *encoded = malloc(size);                                                        \
        require(encoded != NULL, #type, "there is no memory left");                             \
        require(type##_encode(encoded, 0, (int)size, &message) == (int)size, #type,             \
                "has another size when encoded again");                                         \
        require(memcmp(encoded, data, size) == 0, #type, "has other bytes when encoded again"); \
        free(encoded);                                                                          \
        type##_decode_cleanup(&message);                                                        \
    }
DEFINE_ROUND_TRIP(vdna_msg_ranking_t)
DEFINE_ROUND_TRIP(vdna_msg_localisation_t)
DEFINE_ROUND_TRIP(vdna_msg_status_t)
DEFINE_ROUND_TRIP(vdna_msg_command_t)
DEFINE_ROUND_TRIP(bot_core_image_t)

static void try_image(const uint8_t *data, size_t size)
{
    vdna_transport_frame frame;
    if (vdna_transport_parse_image(data, size, &frame) != VDNA_OK)
        return;
    round_trip_bot_core_image_t(data, size);
    require(frame.image.data >= data &&
                frame.image.size <= size - (size_t)(frame.image.data - data),
            "bot_core_image_t", "its picture is not within the message");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    try_image(data, size);
    if (vdna_transport_check_ranking(data, size) == VDNA_OK)
        round_trip_vdna_msg_ranking_t(data, size);
    if (vdna_transport_check_localisation(data, size) == VDNA_OK)
        round_trip_vdna_msg_localisation_t(data, size);
    if (vdna_transport_check_status(data, size) == VDNA_OK)
        round_trip_vdna_msg_status_t(data, size);
    if (vdna_transport_check_command(data, size) == VDNA_OK)
        round_trip_vdna_msg_command_t(data, size);
    return 0;
}

// One well-formed message of each type.
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    const int room = capacity < INT32_MAX ? (int)capacity : INT32_MAX;
    int size = 0;
    switch (index) {
    case 0:
        size = bot_core_image_t_encode(out, 0, room, &sample_image);
        break;
    case 1:
        size = vdna_msg_ranking_t_encode(out, 0, room, &sample_ranking);
        break;
    case 2:
        size = vdna_msg_localisation_t_encode(out, 0, room, &sample_localisation);
        break;
    case 3:
        size = vdna_msg_status_t_encode(out, 0, room, &sample_status);
        break;
    case 4:
        size = vdna_msg_command_t_encode(out, 0, room, &sample_command);
        break;
    }
    return size > 0 ? (size_t)size : 0;
}
