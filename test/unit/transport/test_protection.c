// End-to-end protection of camera frames: the bytes of SPEC-lcm, and each fault of a network or
// log.
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cmocka_all.h"
#include "connection.h"
#include "lcm_samples.h"

#define KEY "vdna.frame"
#define VALUE_BYTES 21
// The message of frame_message(): fingerprint, members up to data, data; then count, key, value.
#define DATA_END (8 + 28 + sizeof sample_pixels)
#define KEY_AT (DATA_END + 4 + 4)
#define VALUE_AT (KEY_AT + sizeof KEY + 4)

typedef struct message {
    uint8_t bytes[256];
    size_t size;
} message;

static vdna_transport *open_on_memq(uint32_t require_protection)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = "memq://";
    config.max_image_bytes = 100;
    config.camera_channel = "CAMERA";
    config.command_channel = "VDNA_COMMAND";
    config.require_protection = require_protection;
    vdna_transport *transport = NULL;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_OK);
    return transport;
}

static int open_lenient(void **state)
{
    *state = open_on_memq(0);
    return 0;
}

static int open_strict(void **state)
{
    *state = open_on_memq(1);
    return 0;
}

static int close_transport(void **state)
{
    vdna_transport_close(*state);
    return 0;
}

// CRC-32C by its definition.
static uint32_t crc_of(uint32_t crc, const uint8_t *bytes, size_t size)
{
    crc = ~crc;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78u : 0);
    }
    return ~crc;
}

static void write_number(uint8_t *bytes, uint64_t number, size_t size)
{
    for (size_t i = 0; i < size; i++)
        bytes[i] = (uint8_t)(number >> 8 * (size - 1 - i));
}

static message encode(const bot_core_image_t *image)
{
    message m;
    const int size = bot_core_image_t_encode(m.bytes, 0, sizeof m.bytes, image);
    assert_true(size > 0);
    m.size = (size_t)size;
    return m;
}

// The sample picture as message `sequence` of a stream, by lcm-gen's encoder and the specification.
static message frame_message(uint64_t stream, uint64_t sequence)
{
    uint8_t value[VALUE_BYTES] = {1};
    bot_core_image_metadata_t entry = {KEY, VALUE_BYTES, value};
    bot_core_image_t image = sample_image;
    image.nmetadata = 1;
    image.metadata = &entry;
    write_number(value + 1, stream, 8);
    write_number(value + 9, sequence, 8);
    message m = encode(&image);
    const uint32_t crc = crc_of(crc_of(0, m.bytes + 8, DATA_END - 8), value, 17);
    write_number(m.bytes + m.size - 4, crc, 4);
    return m;
}

static void send_message(vdna_transport *transport, const message *m)
{
    assert_int_equal(lcm_publish(transport->network.lcm, "CAMERA", m->bytes, (unsigned)m->size), 0);
}

// Whether the frame of a message is handed out.
static bool is_used(vdna_transport *transport, const message *m)
{
    send_message(transport, m);
    vdna_transport_frame frame;
    uint32_t events = 0;
    assert_int_equal(vdna_transport_poll(transport, 0, &events, &frame), VDNA_OK);
    if (!(events & VDNA_TRANSPORT_FRAME))
        return false;
    assert_int_equal(frame.image.size, sizeof sample_pixels);
    assert_memory_equal(frame.image.data, sample_pixels, sizeof sample_pixels);
    return true;
}

static bool comes(vdna_transport *transport, uint64_t stream, uint64_t sequence)
{
    const message m = frame_message(stream, sequence);
    return is_used(transport, &m);
}

static void assert_counted(vdna_transport *transport, uint64_t streams, uint64_t lost,
                           uint64_t repeated, uint64_t reordered)
{
    const vdna_transport_counters *counters = vdna_transport_count(transport);
    assert_int_equal(counters->stream_count, streams);
    assert_int_equal(counters->lost_frames, lost);
    assert_int_equal(counters->repeated_frames, repeated);
    assert_int_equal(counters->reordered_frames, reordered);
}

// --- the bytes ---

static void keep_message(const lcm_recv_buf_t *received, const char *channel, void *context)
{
    (void)channel;
    message *kept = context;
    assert_true(received->data_size <= sizeof kept->bytes);
    memcpy(kept->bytes, received->data, received->data_size);
    kept->size = received->data_size;
}

static message published(vdna_transport *transport, vdna_transport_stream *stream)
{
    const vdna_image image = {sample_pixels, sizeof sample_pixels, 3, 2, 3, VDNA_PIXEL_GREY};
    message kept = {.size = 0};
    lcm_subscription_t *subscription =
        lcm_subscribe(transport->network.lcm, "OUT", keep_message, &kept);
    assert_int_equal(vdna_transport_publish_protected_image(transport, "OUT", sample_image.utime,
                                                            &image, stream),
                     VDNA_OK);
    lcm_handle(transport->network.lcm);
    lcm_unsubscribe(transport->network.lcm, subscription);
    return kept;
}

static void what_is_published_are_the_bytes_of_the_specification(void **state)
{
    vdna_transport_stream stream = {0xfedcba9876543210, 0x0123456789abcdef};
    const message found = published(*state, &stream);
    const message expected = frame_message(0xfedcba9876543210, 0x0123456789abcdef);
    assert_int_equal(found.size, expected.size);
    assert_memory_equal(found.bytes, expected.bytes, expected.size);
    assert_int_equal(stream.sequence, 0x0123456789abcdf0);
}

static void a_listener_that_does_not_know_it_decodes_the_message(void **state)
{
    vdna_transport_stream stream = {7, 0};
    const message m = published(*state, &stream);
    bot_core_image_t image;
    assert_int_equal(bot_core_image_t_decode(m.bytes, 0, (int)m.size, &image), m.size);
    assert_int_equal(image.utime, sample_image.utime);
    assert_int_equal(image.pixelformat, sample_image.pixelformat);
    assert_int_equal(image.size, sizeof sample_pixels);
    assert_memory_equal(image.data, sample_pixels, sizeof sample_pixels);
    bot_core_image_t_decode_cleanup(&image);
}

static void arguments_that_do_not_do_are_refused_and_take_no_number(void **state)
{
    const vdna_image image = {sample_pixels, sizeof sample_pixels, 3, 2, 3, VDNA_PIXEL_GREY};
    const vdna_image nothing = {NULL, 0, 3, 2, 3, VDNA_PIXEL_GREY};
    vdna_transport_stream stream = {7, 0};
    assert_int_equal(vdna_transport_publish_protected_image(NULL, "OUT", 1, &image, &stream),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish_protected_image(*state, "", 1, &image, &stream),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish_protected_image(*state, "OUT", 1, NULL, &stream),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish_protected_image(*state, "OUT", 1, &nothing, &stream),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish_protected_image(*state, "OUT", 1, &image, NULL),
                     VDNA_ERR_ARG);
    assert_int_equal(stream.sequence, 0);
}

static void a_configuration_requires_protection_or_does_not(void **state)
{
    (void)state;
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    assert_int_equal(config.require_protection, 0);
    config.require_protection = 2;
    vdna_transport *transport = NULL;
    vdna_error error;
    assert_int_equal(vdna_transport_open(&config, &error, &transport), VDNA_ERR_ARG);
    assert_string_equal(error.text, "transport: require_protection is 2, expected 0 or 1");
}

// --- corruption ---

static void flip(message *m, size_t bit)
{
    m->bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
}

// Outside the key each bit is covered by the checksum, the format or the fingerprint. In the key it
// makes an unprotected frame of it, whose picture is intact, as is_used() sees.
static void no_frame_with_a_flipped_bit_is_used(void **state)
{
    message m = frame_message(7, 0);
    uint64_t unprotected = 0;
    for (size_t bit = 0; bit < 8 * m.size; bit++) {
        flip(&m, bit);
        const bool in_key = bit / 8 >= KEY_AT && bit / 8 < KEY_AT + strlen(KEY);
        assert_int_equal(is_used(*state, &m), in_key);
        unprotected += in_key;
        flip(&m, bit);
    }
    assert_int_equal(vdna_transport_count(*state)->unprotected_frames, unprotected);
    assert_int_equal(vdna_transport_count(*state)->received, unprotected);
    assert_int_equal(vdna_transport_count(*state)->rejected, 8 * m.size - unprotected);
    assert_true(is_used(*state, &m));
    assert_counted(*state, 1, 0, 0, 0);
}

static void where_protection_is_required_no_flipped_bit_passes(void **state)
{
    message m = frame_message(7, 0);
    for (size_t bit = 0; bit < 8 * m.size; bit++) {
        flip(&m, bit);
        assert_false(is_used(*state, &m));
        flip(&m, bit);
    }
    assert_int_equal(vdna_transport_count(*state)->rejected, 8 * m.size);
    assert_int_equal(vdna_transport_count(*state)->received, 0);
    assert_true(is_used(*state, &m));
}

static void corrupted_frames_are_counted_apart_from_malformed_ones(void **state)
{
    message m = frame_message(7, 1);
    flip(&m, 8 * (DATA_END - 1));
    assert_false(is_used(*state, &m));
    m.size--;
    assert_false(is_used(*state, &m));
    const vdna_transport_counters *counters = vdna_transport_count(*state);
    assert_int_equal(counters->corrupted_frames, 1);
    assert_int_equal(counters->rejected, 2);
    assert_int_equal(counters->camera_rejected, 2);
}

static void a_corrupted_frame_is_missing_in_its_stream(void **state)
{
    assert_true(comes(*state, 7, 0));
    message m = frame_message(7, 1);
    flip(&m, 8 * VALUE_AT + 100);
    assert_false(is_used(*state, &m));
    assert_counted(*state, 1, 0, 0, 0);
    assert_true(comes(*state, 7, 2));
    assert_counted(*state, 1, 1, 0, 0);
}

// A message with two entries of metadata; both have the same checksum.
static message with_entries(const char *key1, int32_t size1, const char *key2, int32_t size2,
                            uint8_t version)
{
    message whole = frame_message(7, 0);
    uint8_t value[VALUE_BYTES + 1] = {0};
    memcpy(value, whole.bytes + VALUE_AT, VALUE_BYTES);
    value[0] = version;
    const uint32_t crc = crc_of(crc_of(0, whole.bytes + 8, DATA_END - 8), value, 17);
    write_number(value + 17, crc, 4);
    bot_core_image_metadata_t entries[] = {{(char *)key1, size1, value},
                                           {(char *)key2, size2, value}};
    bot_core_image_t image = sample_image;
    image.metadata = entries;
    return encode(&image);
}

static void other_metadata_beside_it_is_ignored(void **state)
{
    const message before = with_entries("vdna.framf", VALUE_BYTES, KEY, VALUE_BYTES, 1);
    assert_true(is_used(*state, &before));
    const message after = with_entries(KEY, VALUE_BYTES, "vdna", 0, 1);
    assert_false(is_used(*state, &after));
    assert_counted(*state, 1, 0, 1, 0);
    assert_int_equal(vdna_transport_count(*state)->unprotected_frames, 0);
}

static void protection_of_another_form_is_refused(void **state)
{
    const message wrong[] = {
        with_entries(KEY, VALUE_BYTES, KEY, VALUE_BYTES, 1),
        with_entries(KEY, VALUE_BYTES - 1, "", 0, 1),
        with_entries(KEY, VALUE_BYTES + 1, "", 0, 1),
        with_entries(KEY, 0, "", 0, 1),
        with_entries(KEY, VALUE_BYTES, "", 0, 2),
    };
    const size_t count = sizeof wrong / sizeof *wrong;
    for (size_t i = 0; i < count; i++) {
        vdna_transport_frame frame;
        assert_int_equal(vdna_transport_parse_image(wrong[i].bytes, wrong[i].size, &frame),
                         VDNA_ERR_FORMAT);
        assert_false(is_used(*state, &wrong[i]));
    }
    assert_int_equal(vdna_transport_count(*state)->corrupted_frames, count);
}

static void a_frame_without_protection_is_used_and_counted(void **state)
{
    const message m = encode(&sample_image);
    assert_true(is_used(*state, &m));
    assert_true(is_used(*state, &m));
    assert_int_equal(vdna_transport_count(*state)->unprotected_frames, 2);
    assert_int_equal(vdna_transport_count(*state)->rejected, 0);
    assert_counted(*state, 0, 0, 0, 0);
}

static void where_protection_is_required_a_frame_without_it_is_refused(void **state)
{
    const message m = encode(&sample_image);
    assert_false(is_used(*state, &m));
    assert_int_equal(vdna_transport_count(*state)->unprotected_frames, 1);
    assert_int_equal(vdna_transport_count(*state)->camera_rejected, 1);
    assert_int_equal(vdna_transport_count(*state)->corrupted_frames, 0);
}

// --- order ---

static void frames_in_order_are_used(void **state)
{
    for (uint64_t sequence = 0; sequence < 200; sequence++)
        assert_true(comes(*state, 7, sequence));
    assert_counted(*state, 1, 0, 0, 0);
    assert_int_equal(vdna_transport_count(*state)->received, 200);
}

static void a_repeated_frame_is_not_used(void **state)
{
    assert_true(comes(*state, 7, 0));
    assert_true(comes(*state, 7, 1));
    assert_false(comes(*state, 7, 1));
    assert_false(comes(*state, 7, 0));
    assert_counted(*state, 1, 0, 2, 0);
    assert_int_equal(vdna_transport_count(*state)->received, 2);
}

static void of_two_copies_that_wait_together_one_is_used(void **state)
{
    const message m = frame_message(7, 0);
    send_message(*state, &m);
    assert_true(is_used(*state, &m));
    assert_counted(*state, 1, 0, 1, 0);
    assert_int_equal(vdna_transport_count(*state)->skipped, 0);
}

static void numbers_that_never_come_are_lost(void **state)
{
    assert_true(comes(*state, 7, 10)); /* what was sent before we listened is not */
    assert_true(comes(*state, 7, 12));
    assert_true(comes(*state, 7, 1012));
    assert_counted(*state, 1, 1 + 999, 0, 0);
}

static void a_late_frame_is_reordered_and_not_lost(void **state)
{
    assert_true(comes(*state, 7, 0));
    assert_true(comes(*state, 7, 4));
    assert_counted(*state, 1, 3, 0, 0);
    assert_false(comes(*state, 7, 2));
    assert_counted(*state, 1, 2, 0, 1);
    assert_false(comes(*state, 7, 2));
    assert_counted(*state, 1, 2, 1, 1);
}

static void a_late_frame_from_before_the_first_was_not_missed(void **state)
{
    assert_true(comes(*state, 7, 1));
    assert_false(comes(*state, 7, 0));
    assert_false(comes(*state, 7, 0));
    assert_counted(*state, 1, 0, 1, 1);
}

static void how_late_a_frame_is_told_from_a_repeated_one(void **state)
{
    assert_true(comes(*state, 7, 0));
    assert_true(comes(*state, 7, 100));
    assert_false(comes(*state, 7, 100 - 63));
    assert_counted(*state, 1, 98, 0, 1);
    assert_false(comes(*state, 7, 100 - 64));
    assert_counted(*state, 1, 98, 1, 1);
}

static void what_came_is_remembered_across_a_gap(void **state)
{
    assert_true(comes(*state, 7, 0));
    assert_true(comes(*state, 7, 63));
    assert_false(comes(*state, 7, 0));
    assert_counted(*state, 1, 62, 1, 0);
    assert_true(comes(*state, 7, 127));
    assert_false(comes(*state, 7, 64));
    assert_counted(*state, 1, 62 + 62, 1, 1);
}

static void the_largest_numbers_are_numbers_like_others(void **state)
{
    assert_true(comes(*state, 7, UINT64_MAX - 2));
    assert_true(comes(*state, 7, UINT64_MAX));
    assert_false(comes(*state, 7, UINT64_MAX - 1));
    assert_false(comes(*state, 7, 0));
    assert_counted(*state, 1, 0, 1, 1);
}

static void another_stream_is_judged_by_itself_and_counted(void **state)
{
    for (uint64_t sequence = 0; sequence < 3; sequence++)
        for (uint64_t stream = 1; stream <= VDNA_STREAMS; stream++)
            assert_true(comes(*state, stream, 100 * stream + sequence));
    assert_counted(*state, VDNA_STREAMS, 0, 0, 0);
}

static void of_too_many_streams_the_one_silent_for_longest_is_forgotten(void **state)
{
    for (uint64_t stream = 1; stream <= VDNA_STREAMS; stream++)
        assert_true(comes(*state, stream, 0));
    assert_true(comes(*state, 1, 1));
    assert_true(comes(*state, 99, 0));
    assert_false(comes(*state, 1, 1));
    assert_counted(*state, VDNA_STREAMS + 1, 0, 1, 0);
    assert_true(comes(*state, 2, 0));
    assert_counted(*state, VDNA_STREAMS + 2, 0, 1, 0);
}

static void after_a_reset_a_recording_can_be_sent_again(void **state)
{
    assert_true(comes(*state, 7, 0));
    assert_int_equal(
        vdna_transport_publish(*state, "VDNA_COMMAND", &vdna_message_command, &sample_command),
        VDNA_OK);
    vdna_transport_frame frame;
    uint32_t events;
    assert_int_equal(vdna_transport_poll(*state, 0, &events, &frame), VDNA_OK);
    assert_int_equal(events, VDNA_TRANSPORT_COMMAND);
    assert_true(comes(*state, 7, 0));
    assert_counted(*state, 2, 0, 0, 0);
}

static void an_oversized_frame_that_came_whole_is_not_lost(void **state)
{
    static const uint8_t pixels[101];
    const vdna_image large = {pixels, sizeof pixels, sizeof pixels, 1, 0, VDNA_PIXEL_GREY};
    vdna_transport_stream stream = {7, 1};
    assert_true(comes(*state, 7, 0));
    assert_int_equal(vdna_transport_publish_protected_image(*state, "CAMERA", 1, &large, &stream),
                     VDNA_OK);
    assert_true(comes(*state, 7, 2));
    assert_counted(*state, 1, 0, 0, 0);
    assert_int_equal(vdna_transport_count(*state)->oversized, 1);
}

// --- logs ---

static void a_log_is_judged_like_a_network(void **state)
{
    (void)state;
    char path[] = "/tmp/protected-XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    lcm_eventlog_t *log = lcm_eventlog_create(path, "w");
    const uint64_t sequences[] = {0, 1, 1, 4, 3};
    for (size_t i = 0; i < 6; i++) {
        message m = frame_message(7, i < 5 ? sequences[i] : 5);
        if (i == 5)
            flip(&m, 8 * (DATA_END - 1));
        lcm_eventlog_event_t event = {.timestamp = (int64_t)i,
                                      .channellen = 6,
                                      .datalen = (int32_t)m.size,
                                      .channel = "CAMERA",
                                      .data = m.bytes};
        assert_int_equal(lcm_eventlog_write_event(log, &event), 0);
    }
    lcm_eventlog_destroy(log);

    char url[64];
    snprintf(url, sizeof url, "file://%s?speed=0", path);
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url;
    config.camera_channel = "CAMERA";
    vdna_transport *transport = NULL;
    assert_int_equal(vdna_transport_open(&config, NULL, &transport), VDNA_OK);
    uint64_t frames = 0;
    vdna_transport_frame frame;
    for (uint32_t events; vdna_transport_poll(transport, 0, &events, &frame) == VDNA_OK;)
        frames += events == VDNA_TRANSPORT_FRAME;
    assert_int_equal(frames, 3);
    assert_counted(transport, 1, 1, 1, 1);
    assert_int_equal(vdna_transport_count(transport)->corrupted_frames, 1);

    /* It cannot be sent to. The number counts as used: whether the frame went is not known. */
    const vdna_image image = {sample_pixels, sizeof sample_pixels, 3, 2, 3, VDNA_PIXEL_GREY};
    vdna_transport_stream stream = {7, 0};
    assert_int_equal(
        vdna_transport_publish_protected_image(transport, "CAMERA", 1, &image, &stream),
        VDNA_ERR_IO);
    assert_int_equal(stream.sequence, 1);
    vdna_transport_close(transport);
    remove(path);
}

#define LENIENT(test) cmocka_unit_test_setup_teardown(test, open_lenient, close_transport)
#define STRICT(test) cmocka_unit_test_setup_teardown(test, open_strict, close_transport)

int main(void)
{
    const struct CMUnitTest tests[] = {
        LENIENT(what_is_published_are_the_bytes_of_the_specification),
        LENIENT(a_listener_that_does_not_know_it_decodes_the_message),
        LENIENT(arguments_that_do_not_do_are_refused_and_take_no_number),
        cmocka_unit_test(a_configuration_requires_protection_or_does_not),
        LENIENT(no_frame_with_a_flipped_bit_is_used),
        STRICT(where_protection_is_required_no_flipped_bit_passes),
        LENIENT(corrupted_frames_are_counted_apart_from_malformed_ones),
        LENIENT(a_corrupted_frame_is_missing_in_its_stream),
        LENIENT(other_metadata_beside_it_is_ignored),
        LENIENT(protection_of_another_form_is_refused),
        LENIENT(a_frame_without_protection_is_used_and_counted),
        STRICT(where_protection_is_required_a_frame_without_it_is_refused),
        LENIENT(frames_in_order_are_used),
        LENIENT(a_repeated_frame_is_not_used),
        LENIENT(of_two_copies_that_wait_together_one_is_used),
        LENIENT(numbers_that_never_come_are_lost),
        LENIENT(a_late_frame_is_reordered_and_not_lost),
        LENIENT(a_late_frame_from_before_the_first_was_not_missed),
        LENIENT(how_late_a_frame_is_told_from_a_repeated_one),
        LENIENT(what_came_is_remembered_across_a_gap),
        LENIENT(the_largest_numbers_are_numbers_like_others),
        LENIENT(another_stream_is_judged_by_itself_and_counted),
        LENIENT(of_too_many_streams_the_one_silent_for_longest_is_forgotten),
        LENIENT(after_a_reset_a_recording_can_be_sent_again),
        LENIENT(an_oversized_frame_that_came_whole_is_not_lost),
        cmocka_unit_test(a_log_is_judged_like_a_network),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
