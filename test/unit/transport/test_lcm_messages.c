// Well-formed messages: the library's verdict, against lcm-gen's encoders.
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cmocka_all.h"
#include "lcm_samples.h"
#include "message_sample.h"

// Bytes of the members in front of the first length, by the .lcm files.
#define RANKING_BACKBONE_AT (8 + 8 + 8 + 4 + 4 + 1)
#define RANKING_RANKED_BY_AT (RANKING_BACKBONE_AT + (4 + 6) + (4 + 5) + (4 + 17) + 8)
#define RANKING_SKILL_AT (RANKING_RANKED_BY_AT + (4 + 9) + (4 + 5) + 8 + (4 + 1))
#define RANKING_COUNT_AT (RANKING_SKILL_AT + 8 + 4 + (4 + 5))
#define LOCALISATION_EXPERIENCE_AT (8 + 8 + 4 + (4 + 1))
#define STATUS_HOST_AT (8 + 8 + 4 + 8 + 8)
#define STATUS_EXPERIENCE_AT (STATUS_HOST_AT + (4 + 6) + (4 + 5) + (4 + 1) + 8 + 8)
#define COMMAND_ARGUMENT_AT (8 + 8 + 4)
#define COMMAND_RESULT_TEXT_AT (8 + 8 + 4 + 1)
#define IMAGE_WIDTH_AT (8 + 8)
#define IMAGE_PIXELFORMAT_AT (IMAGE_WIDTH_AT + 3 * 4)
#define IMAGE_SIZE_AT (IMAGE_PIXELFORMAT_AT + 4)
#define IMAGE_NMETADATA_AT (IMAGE_SIZE_AT + 4 + 6)
#define IMAGE_KEY_AT (IMAGE_NMETADATA_AT + 4)
#define IMAGE_VALUE_AT (IMAGE_KEY_AT + 4 + 9)

// A message as bytes, and the table to check it with.
typedef struct message {
    const char *type;
    uint64_t fingerprint;
    const vdna_message_type *table; // NULL = as a camera frame is
    uint8_t bytes[1024];
    int size;
} message;

static vdna_status check(const message *m, const void *data, size_t size)
{
    vdna_transport_frame frame;
    return m->table ? vdna_transport_check(m->table, data, size)
                    : vdna_transport_parse_image(data, size, &frame);
}

enum { RANKING, LOCALISATION, STATUS, COMMAND, COMMAND_RESULT, IMAGE, TYPES };

static message messages[TYPES] = {
    {"vdna_msg.ranking_t", 0, &vdna_message_ranking, {0}, 0},
    {"vdna_msg.localisation_t", 0, &vdna_message_localisation, {0}, 0},
    {"vdna_msg.status_t", 0, &vdna_message_status, {0}, 0},
    {"vdna_msg.command_t", 0, &vdna_message_command, {0}, 0},
    {"vdna_msg.command_result_t", 0, &vdna_message_command_result, {0}, 0},
    {"bot_core.image_t", 0, NULL, {0}, 0},
};

static int encode_samples(void **state)
{
    (void)state;
    message *m = messages;
    const int room = sizeof m->bytes;
    m[RANKING].size = vdna_msg_ranking_t_encode(m[RANKING].bytes, 0, room, &sample_ranking);
    m[LOCALISATION].size =
        vdna_msg_localisation_t_encode(m[LOCALISATION].bytes, 0, room, &sample_localisation);
    m[STATUS].size = vdna_msg_status_t_encode(m[STATUS].bytes, 0, room, &sample_status);
    m[COMMAND].size = vdna_msg_command_t_encode(m[COMMAND].bytes, 0, room, &sample_command);
    m[COMMAND_RESULT].size =
        vdna_msg_command_result_t_encode(m[COMMAND_RESULT].bytes, 0, room, &sample_command_result);
    m[IMAGE].size = bot_core_image_t_encode(m[IMAGE].bytes, 0, room, &sample_image);
    for (int type = 0; type < TYPES; type++) {
        assert_true(m[type].size > 0);
        for (int i = 0; i < 8; i++)
            m[type].fingerprint = m[type].fingerprint << 8 | m[type].bytes[i];
    }
    return 0;
}

// The verdict on a copy without a byte to spare, so that AddressSanitizer sees a read past it.
static vdna_status judge(const message *m, const uint8_t *bytes, size_t size)
{
    uint8_t *copy = malloc(size);
    assert_true(copy || size == 0);
    if (size > 0)
        memcpy(copy, bytes, size);
    const vdna_status status = check(m, copy, size);
    free(copy);
    return status;
}

// The verdict on a message with one big-endian int32 overwritten.
static vdna_status judge_with(int type, size_t at, int64_t value)
{
    const message *m = &messages[type];
    uint8_t changed[sizeof m->bytes];
    memcpy(changed, m->bytes, sizeof changed);
    for (int i = 0; i < 4; i++)
        changed[at + (size_t)i] = (uint8_t)((uint64_t)value >> (24 - 8 * i));
    return judge(m, changed, (size_t)m->size);
}

// Whether a length is refused when it is anything but `right`.
static void assert_only_length(int type, size_t at, int32_t right)
{
    assert_int_equal(judge_with(type, at, right), VDNA_OK);
    const int64_t wrong[] = {-1,         INT32_MIN, INT32_MAX, 0x20000001,
                             0x10000000, right + 1, right - 1, 1000};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(judge_with(type, at, wrong[i]), VDNA_ERR_FORMAT);
}

// The fingerprint that lcm-gen's encoder writes for a type, by its name.
static uint64_t fingerprint_of(const char *name)
{
    int known = 0;
    while (known < VDNA_MESSAGE_TYPES && strcmp(vdna_message_types[known]->name, name) != 0)
        known++;
    assert_in_range(known, 0, VDNA_MESSAGE_TYPES - 1);
    const vdna_message_type *type = vdna_message_types[known];
    uint8_t bytes[1024];
    void *sample = sample_new(type);
    assert_true(type->encode(sample, bytes, sizeof bytes) > 0);
    sample_free(type, sample);
    uint64_t fingerprint = 0;
    for (int i = 0; i < 8; i++)
        fingerprint = fingerprint << 8 | bytes[i];
    return fingerprint;
}

static void the_fingerprints_are_those_of_the_table(void **state)
{
    (void)state;
    FILE *table = fopen(VDNA_FINGERPRINTS, "r");
    assert_non_null(table);
    char type[64];
    uint64_t fingerprint;
    int lines[TYPES] = {0};
    while (fscanf(table, "%63s %" SCNx64, type, &fingerprint) == 2) {
        assert_int_equal(fingerprint_of(type), fingerprint);
        for (int known = 0; known < TYPES; known++)
            if (strcmp(messages[known].type, type) == 0) {
                assert_int_equal(messages[known].fingerprint, fingerprint);
                lines[known]++;
            }
    }
    assert_true(feof(table));
    fclose(table);
    for (int known = 0; known < TYPES; known++)
        assert_int_equal(lines[known], 1);
}

static void what_the_encoders_write_is_accepted(void **state)
{
    (void)state;
    for (int type = 0; type < TYPES; type++)
        assert_int_equal(judge(&messages[type], messages[type].bytes, (size_t)messages[type].size),
                         VDNA_OK);
}

static void every_truncation_is_refused(void **state)
{
    (void)state;
    for (int type = 0; type < TYPES; type++)
        for (int size = 0; size < messages[type].size; size++)
            assert_int_equal(judge(&messages[type], messages[type].bytes, (size_t)size),
                             VDNA_ERR_FORMAT);
}

static void a_byte_too_many_is_refused(void **state)
{
    (void)state;
    for (int type = 0; type < TYPES; type++)
        assert_int_equal(
            judge(&messages[type], messages[type].bytes, (size_t)messages[type].size + 1),
            VDNA_ERR_FORMAT);
}

static void a_message_of_another_type_is_refused(void **state)
{
    (void)state;
    for (int judged = 0; judged < TYPES; judged++)
        for (int sent = 0; sent < TYPES; sent++)
            if (judged != sent)
                assert_int_equal(
                    judge(&messages[judged], messages[sent].bytes, (size_t)messages[sent].size),
                    VDNA_ERR_FORMAT);
}

static void no_message_at_all_is_refused(void **state)
{
    (void)state;
    for (int type = 0; type < TYPES; type++)
        assert_int_equal(check(&messages[type], NULL, 100), VDNA_ERR_FORMAT);
    assert_int_equal(vdna_transport_parse_image(messages[IMAGE].bytes, 8, NULL), VDNA_ERR_ARG);
}

static void lengths_of_strings_must_be_right(void **state)
{
    (void)state;
    assert_only_length(RANKING, RANKING_BACKBONE_AT, 6);
    assert_only_length(RANKING, RANKING_RANKED_BY_AT, 9);
    assert_only_length(RANKING, RANKING_COUNT_AT + 4, 7);
    assert_only_length(LOCALISATION, LOCALISATION_EXPERIENCE_AT, 5);
    assert_only_length(STATUS, STATUS_HOST_AT, 6);
    assert_only_length(STATUS, STATUS_EXPERIENCE_AT, 5);
    assert_only_length(COMMAND, COMMAND_ARGUMENT_AT, 1);
    assert_only_length(COMMAND_RESULT, COMMAND_RESULT_TEXT_AT, 15);
    assert_only_length(IMAGE, IMAGE_KEY_AT, 9);
}

static void counts_of_arrays_must_be_right(void **state)
{
    (void)state;
    assert_only_length(RANKING, RANKING_COUNT_AT, 2);
    assert_only_length(IMAGE, IMAGE_SIZE_AT, 6);
    assert_only_length(IMAGE, IMAGE_NMETADATA_AT, 2);
    assert_only_length(IMAGE, IMAGE_VALUE_AT, 3);
}

static void a_string_ends_with_its_only_nul(void **state)
{
    (void)state;
    const message *m = &messages[LOCALISATION];
    uint8_t changed[sizeof m->bytes];
    memcpy(changed, m->bytes, sizeof changed);
    uint8_t *text = changed + LOCALISATION_EXPERIENCE_AT + 4;
    assert_string_equal((char *)text, "snow");

    text[4] = 'y';
    assert_int_equal(judge(m, changed, (size_t)m->size), VDNA_ERR_FORMAT);
    text[4] = 0;
    text[2] = 0;
    assert_int_equal(judge(m, changed, (size_t)m->size), VDNA_ERR_FORMAT);
    text[2] = 'o';
    assert_int_equal(judge(m, changed, (size_t)m->size), VDNA_OK);
}

static void a_ranking_of_nothing_is_well_formed(void **state)
{
    (void)state;
    vdna_msg_ranking_t empty = sample_ranking;
    empty.count = empty.reasons = 0;
    uint8_t bytes[256];
    const int size = vdna_msg_ranking_t_encode(bytes, 0, sizeof bytes, &empty);
    assert_int_equal(judge(&messages[RANKING], bytes, (size_t)size), VDNA_OK);
}

static void a_picture_is_read_in_place(void **state)
{
    (void)state;
    const message *m = &messages[IMAGE];
    vdna_transport_frame frame;
    assert_int_equal(vdna_transport_parse_image(m->bytes, (size_t)m->size, &frame), VDNA_OK);
    assert_int_equal(frame.utime, 1700000000000006);
    assert_int_equal(frame.received_us, 0);
    assert_int_equal(frame.image.width, 3);
    assert_int_equal(frame.image.height, 2);
    assert_int_equal(frame.image.row_stride, 3);
    assert_int_equal(frame.image.pixelformat, VDNA_PIXEL_GREY);
    assert_int_equal(frame.image.size, 6);
    assert_ptr_equal(frame.image.data, m->bytes + IMAGE_SIZE_AT + 4);
}

static void a_picture_that_is_refused_leaves_the_output_alone(void **state)
{
    (void)state;
    vdna_transport_frame frame, before;
    memset(&before, 0x5a, sizeof before);
    frame = before;
    assert_int_equal(vdna_transport_parse_image(messages[IMAGE].bytes, 20, &frame),
                     VDNA_ERR_FORMAT);
    assert_memory_equal(&frame, &before, sizeof frame);
}

static void a_picture_with_negative_sides_is_refused(void **state)
{
    (void)state;
    for (size_t member = 0; member < 3; member++) // width, height, row_stride
        assert_int_equal(judge_with(IMAGE, IMAGE_WIDTH_AT + 4 * member, -1), VDNA_ERR_FORMAT);
}

static void a_picture_without_a_format_is_refused(void **state)
{
    (void)state;
    assert_int_equal(judge_with(IMAGE, IMAGE_PIXELFORMAT_AT, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
    assert_int_equal(judge_with(IMAGE, IMAGE_PIXELFORMAT_AT, VDNA_PIXEL_MJPG), VDNA_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_fingerprints_are_those_of_the_table),
        cmocka_unit_test(what_the_encoders_write_is_accepted),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(a_byte_too_many_is_refused),
        cmocka_unit_test(a_message_of_another_type_is_refused),
        cmocka_unit_test(no_message_at_all_is_refused),
        cmocka_unit_test(lengths_of_strings_must_be_right),
        cmocka_unit_test(counts_of_arrays_must_be_right),
        cmocka_unit_test(a_string_ends_with_its_only_nul),
        cmocka_unit_test(a_ranking_of_nothing_is_well_formed),
        cmocka_unit_test(a_picture_is_read_in_place),
        cmocka_unit_test(a_picture_that_is_refused_leaves_the_output_alone),
        cmocka_unit_test(a_picture_with_negative_sides_is_refused),
        cmocka_unit_test(a_picture_without_a_format_is_refused),
    };
    return cmocka_run_group_tests(tests, encode_samples, NULL);
}
