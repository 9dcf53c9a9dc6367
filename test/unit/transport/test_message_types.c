// The tables that message_table.py writes, against the encoders that lcm-gen writes: two readings
// of the same .lcm files. The samples are made from the tables and encoded by lcm-gen's code.
#include <vdna_messages.h>

#include <vdna/transport.h>

#include "cmocka_all.h"
#include "message_sample.h"

#define FINGERPRINT_BYTES 8u
#define WIRE_BYTES 1024u

// A sample of one type, and its bytes on the wire.
typedef struct sample {
    const vdna_message_type *type;
    char *message;
    uint8_t bytes[WIRE_BYTES];
    size_t size;
} sample;

static size_t encode(const sample *s, uint8_t *out_bytes)
{
    const int32_t size = s->type->encode(s->message, out_bytes, WIRE_BYTES);
    assert_true(size > 0);
    return (size_t)size;
}

static sample make(unsigned index)
{
    sample s = {.type = vdna_message_types[index]};
    s.message = sample_new(s.type);
    s.size = encode(&s, s.bytes);
    return s;
}

static uint32_t length_of(const vdna_message_member *member)
{
    return member->length > 0 ? member->length : SAMPLE_COUNT;
}

// The first element of a member, in the C struct or behind its pointer.
static char *elements_of(const vdna_message_member *member, char *message)
{
    char *elements = message + member->offset;
    if (member->length == 0)
        memcpy(&elements, message + member->offset, sizeof elements);
    return elements;
}

// The bytes of a message, by its table.
enum { FINGERPRINT = 'f', NUMBER = 'n', COUNT = 'c', LENGTH = 'l', TEXT = 't', END = '0' };

typedef struct map {
    char kinds[WIRE_BYTES];
    size_t size;
} map;

static void append(map *m, char kind, size_t bytes)
{
    assert_true(bytes <= sizeof m->kinds - m->size);
    memset(m->kinds + m->size, kind, bytes);
    m->size += bytes;
}

static void append_struct(map *m, const vdna_message_type *type);

static void append_element(map *m, const vdna_message_member *member)
{
    switch (member->kind) {
    case VDNA_MESSAGE_COUNT:
        append(m, COUNT, 4);
        break;
    case VDNA_MESSAGE_STRING:
        append(m, LENGTH, 4);
        append(m, TEXT, sizeof SAMPLE_TEXT - 1);
        append(m, END, 1);
        break;
    case VDNA_MESSAGE_STRUCT:
        append_struct(m, member->type);
        break;
    default:
        append(m, NUMBER, sample_element_size(member)); // as in the C struct
    }
}

static void append_member(map *m, const vdna_message_member *member)
{
    for (uint32_t i = 0; i < length_of(member); i++)
        append_element(m, member);
}

static void append_struct(map *m, const vdna_message_type *type)
{
    for (uint32_t i = 0; i < type->member_count; i++)
        append_member(m, &type->members[i]);
}

static map map_of(const vdna_message_type *type)
{
    map m = {.size = 0};
    append(&m, FINGERPRINT, FINGERPRINT_BYTES);
    append_struct(&m, type);
    return m;
}

// Change an element in the C struct; a second call changes it back. Returns which of its bytes on
// the wire is the first to change.
static size_t toggle(const vdna_message_member *member, char *element)
{
    char *text;
    int32_t count;
    switch (member->kind) {
    case VDNA_MESSAGE_COUNT: // SAMPLE_COUNT or one less, of which the last byte differs
        memcpy(&count, element, sizeof count);
        count ^= 1;
        memcpy(element, &count, sizeof count);
        return 3;
    case VDNA_MESSAGE_STRING:
        memcpy(&text, element, sizeof text);
        text[0] = (char)(text[0] ^ 1);
        return 4;
    case VDNA_MESSAGE_STRUCT:
        return toggle(member->type->members, element + member->type->members->offset);
    default:
        for (size_t i = 0; i < sample_element_size(member); i++)
            element[i] = (char)(element[i] ^ 1);
        return 0;
    }
}

static size_t first_difference(const sample *s, const uint8_t *bytes, size_t size)
{
    size_t at = 0;
    while (at < size && at < s->size && bytes[at] == s->bytes[at])
        at++;
    return at;
}

static void assert_element_at(sample *s, const vdna_message_member *member, char *element,
                              size_t place)
{
    uint8_t bytes[WIRE_BYTES];
    place += toggle(member, element);
    const size_t size = encode(s, bytes);
    toggle(member, element);
    assert_int_equal(first_difference(s, bytes, size), place);
}

static void every_fingerprint_is_the_one_that_lcm_gen_computes(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        uint64_t fingerprint = 0;
        for (unsigned i = 0; i < FINGERPRINT_BYTES; i++)
            fingerprint = fingerprint << 8 | s.bytes[i];
        assert_int_equal(fingerprint, s.type->fingerprint);
        sample_free(s.type, s.message);
    }
}

static void every_message_has_as_many_bytes_as_its_table_says(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        const map m = map_of(s.type);
        assert_int_equal(s.size, m.size);
        assert_int_equal(s.type->encoded_size(s.message), m.size);
        sample_free(s.type, s.message);
    }
}

static void every_member_is_where_its_table_says_in_the_struct_and_on_the_wire(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        map m = {.size = 0};
        append(&m, FINGERPRINT, FINGERPRINT_BYTES);
        for (uint32_t i = 0; i < s.type->member_count; i++) {
            const vdna_message_member *member = &s.type->members[i];
            char *element = elements_of(member, s.message);
            for (uint32_t e = 0; e < length_of(member); e++) {
                assert_element_at(&s, member, element, m.size);
                append_element(&m, member);
                element += sample_element_size(member);
            }
        }
        sample_free(s.type, s.message);
    }
}

static void what_is_accepted_decodes_to_its_end_and_encodes_to_the_same_bytes(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        assert_int_equal(vdna_transport_check(s.type, s.bytes, s.size), VDNA_OK);
        sample again = {.type = s.type, .message = sample_memory(s.type->struct_size)};
        assert_int_equal(s.type->decode(s.bytes, (int32_t)s.size, again.message), s.size);
        assert_int_equal(encode(&again, again.bytes), s.size);
        assert_memory_equal(again.bytes, s.bytes, s.size);
        sample_free(s.type, again.message);
        sample_free(s.type, s.message);
    }
}

// The verdict on a copy without a byte to spare, so that AddressSanitizer sees a read past it.
static vdna_status judge(const vdna_message_type *type, const uint8_t *bytes, size_t size)
{
    uint8_t *copy = sample_memory(size + (size == 0));
    memcpy(copy, bytes, size);
    const vdna_status status = vdna_transport_check(type, copy, size);
    free(copy);
    return status;
}

static void every_truncation_and_every_byte_too_many_is_refused(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        for (size_t size = 0; size < s.size; size++)
            assert_int_equal(judge(s.type, s.bytes, size), VDNA_ERR_FORMAT);
        assert_int_equal(judge(s.type, s.bytes, s.size + 1), VDNA_ERR_FORMAT);
        sample_free(s.type, s.message);
    }
}

static void a_changed_number_or_letter_is_accepted_and_any_other_change_is_refused(void **state)
{
    (void)state;
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        const map m = map_of(s.type);
        for (size_t at = 0; at < s.size; at++) {
            const uint8_t before = s.bytes[at];
            for (unsigned value = 0; value < 256; value++) {
                const int fits =
                    value == before || m.kinds[at] == NUMBER || (m.kinds[at] == TEXT && value != 0);
                s.bytes[at] = (uint8_t)value;
                assert_int_equal(judge(s.type, s.bytes, s.size), fits ? VDNA_OK : VDNA_ERR_FORMAT);
            }
            s.bytes[at] = before;
        }
        sample_free(s.type, s.message);
    }
}

static void a_check_refuses_bad_arguments(void **state)
{
    (void)state;
    const uint8_t bytes[FINGERPRINT_BYTES] = {0};
    assert_int_equal(vdna_transport_check(NULL, bytes, sizeof bytes), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_check(&vdna_message_command, NULL, 8), VDNA_ERR_FORMAT);
    assert_int_equal(vdna_transport_check(&vdna_message_command, bytes, (size_t)INT32_MAX + 1),
                     VDNA_ERR_FORMAT);
}

// --- publishing ---

static int open_on_memq(void **state)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = "memq://";
    vdna_transport *transport = NULL;
    if (vdna_transport_open(&config, NULL, &transport) != VDNA_OK)
        return -1;
    *state = transport;
    return 0;
}

static int close_transport(void **state)
{
    vdna_transport_close(*state);
    return 0;
}

static vdna_status publish(vdna_transport *transport, const sample *s)
{
    return vdna_transport_publish(transport, "CHANNEL", s->type, s->message);
}

// Whether the message is refused while a pointer of it is NULL.
static void assert_needed(vdna_transport *transport, const sample *s, char *place)
{
    char *pointer, *const nothing = NULL;
    memcpy(&pointer, place, sizeof pointer);
    memcpy(place, &nothing, sizeof nothing);
    assert_int_equal(publish(transport, s), VDNA_ERR_ARG);
    memcpy(place, &pointer, sizeof pointer);
}

// Whether the message is refused while a count of it is negative.
static void assert_not_negative(vdna_transport *transport, const sample *s, char *place)
{
    const int32_t count = SAMPLE_COUNT, negative[] = {-1, INT32_MIN};
    for (int i = 0; i < 2; i++) {
        memcpy(place, &negative[i], sizeof negative[i]);
        assert_int_equal(publish(transport, s), VDNA_ERR_ARG);
    }
    memcpy(place, &count, sizeof count);
}

static void assert_complete(vdna_transport *transport, const sample *s,
                            const vdna_message_type *type, char *message)
{
    for (uint32_t i = 0; i < type->member_count; i++) {
        const vdna_message_member *member = &type->members[i];
        if (member->length == 0)
            assert_needed(transport, s, message + member->offset);
        char *element = elements_of(member, message);
        for (uint32_t e = 0; e < length_of(member); e++) {
            if (member->kind == VDNA_MESSAGE_STRING)
                assert_needed(transport, s, element);
            if (member->kind == VDNA_MESSAGE_COUNT)
                assert_not_negative(transport, s, element);
            if (member->kind == VDNA_MESSAGE_STRUCT)
                assert_complete(transport, s, member->type, element);
            element += sample_element_size(member);
        }
    }
}

static void a_message_of_any_type_is_published_only_if_nothing_of_it_is_missing(void **state)
{
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        sample s = make(type);
        assert_complete(*state, &s, s.type, s.message);
        assert_int_equal(publish(*state, &s), VDNA_OK);
        sample_free(s.type, s.message);
    }
}

static void an_array_of_no_elements_may_be_missing(void **state)
{
    for (unsigned type = 0; type < VDNA_MESSAGE_TYPES; type++) {
        const vdna_message_type *t = vdna_message_types[type];
        // Only counted arrays may be missing, strings may not.
        sample s = make(type);
        char *empty = sample_memory(t->struct_size);
        memcpy(empty, s.message, t->struct_size);
        for (uint32_t i = 0; i < t->member_count; i++) {
            if (t->members[i].kind == VDNA_MESSAGE_COUNT)
                memset(empty + t->members[i].offset, 0, sizeof(int32_t));
            if (t->members[i].length == 0)
                memset(empty + t->members[i].offset, 0, sizeof(void *));
        }
        assert_int_equal(vdna_transport_publish(*state, "CHANNEL", t, empty), VDNA_OK);
        free(empty);
        sample_free(t, s.message);
    }
}

static void publishing_refuses_bad_arguments(void **state)
{
    sample s = make(0);
    char name[65];
    memset(name, 'x', sizeof name);
    name[64] = 0;
    assert_int_equal(vdna_transport_publish(NULL, "CHANNEL", s.type, s.message), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(*state, NULL, s.type, s.message), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(*state, "", s.type, s.message), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(*state, name, s.type, s.message), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(*state, name + 1, s.type, s.message), VDNA_OK);
    assert_int_equal(vdna_transport_publish(*state, "CHANNEL", NULL, s.message), VDNA_ERR_ARG);
    assert_int_equal(vdna_transport_publish(*state, "CHANNEL", s.type, NULL), VDNA_ERR_ARG);
    sample_free(s.type, s.message);
}

#define ON_MEMQ(test) cmocka_unit_test_setup_teardown(test, open_on_memq, close_transport)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_fingerprint_is_the_one_that_lcm_gen_computes),
        cmocka_unit_test(every_message_has_as_many_bytes_as_its_table_says),
        cmocka_unit_test(every_member_is_where_its_table_says_in_the_struct_and_on_the_wire),
        cmocka_unit_test(what_is_accepted_decodes_to_its_end_and_encodes_to_the_same_bytes),
        cmocka_unit_test(every_truncation_and_every_byte_too_many_is_refused),
        cmocka_unit_test(a_changed_number_or_letter_is_accepted_and_any_other_change_is_refused),
        cmocka_unit_test(a_check_refuses_bad_arguments),
        ON_MEMQ(a_message_of_any_type_is_published_only_if_nothing_of_it_is_missing),
        ON_MEMQ(an_array_of_no_elements_may_be_missing),
        ON_MEMQ(publishing_refuses_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
