// LCM's datagrams to messages: every order, loss and duplicate of up to six fragments, and each
// thing that a datagram can have wrong. VDNA_ALL is set: six fragments in place of five.
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cmocka_all.h"
#include "reassembly.h"

#define CAMERA_MAX 1000u
#define COMMAND_MAX 100u
#define DATAGRAM_MAX 2048u

static const vdna_wanted_channel channels[] = {{"CAMERA", CAMERA_MAX}, {"COMMAND", COMMAND_MAX}};

static void *memory;
static vdna_reassembly *r;

static int begin(void **state)
{
    (void)state;
    const size_t size = vdna_reassembly_mem_size(channels, 2);
    free(memory);
    memory = malloc(size);
    memset(memory, 0xa5, size); // nothing relies on its content
    r = vdna_reassembly_init(channels, 2, memory, size);
    assert_non_null(r);
    return 0;
}

static int end(void **state)
{
    (void)state;
    free(memory);
    memory = NULL;
    return 0;
}

// --- datagrams ---

typedef struct bytes {
    uint8_t data[DATAGRAM_MAX];
    size_t size;
} bytes;

static void put(bytes *out, uint32_t value, int size)
{
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
        out->data[out->size++] = (uint8_t)(value >> shift);
}

static void put_text(bytes *out, const char *text, size_t size)
{
    memcpy(out->data + out->size, text, size);
    out->size += size;
}

// Byte number `at` of message `sequence`.
static uint8_t byte_at(uint32_t sequence, size_t at)
{
    return (uint8_t)((sequence + 1) * 37 + at * 101 + at / 256);
}

static void put_content(bytes *out, uint32_t sequence, size_t from, size_t size)
{
    for (size_t i = 0; i < size; i++)
        out->data[out->size++] = byte_at(sequence, from + i);
}

static bytes short_message(uint32_t sequence, const char *channel, size_t size)
{
    bytes out = {.size = 0};
    put(&out, 0x4C433032, 4);
    put(&out, sequence, 4);
    put_text(&out, channel, strlen(channel) + 1);
    put_content(&out, sequence, 0, size);
    return out;
}

typedef struct header {
    uint32_t sequence, size, offset, number, count;
} header;

// A fragment with any header; channel NULL = none.
static bytes fragment_with(header h, const char *channel, size_t size)
{
    bytes out = {.size = 0};
    put(&out, 0x4C433033, 4);
    put(&out, h.sequence, 4);
    put(&out, h.size, 4);
    put(&out, h.offset, 4);
    put(&out, h.number, 2);
    put(&out, h.count, 2);
    if (channel)
        put_text(&out, channel, strlen(channel) + 1);
    put_content(&out, h.sequence, h.offset, size);
    return out;
}

// Fragments of 7, 8, 9 ... bytes: no sender makes them so, but they are well-formed.
#define FIRST_BYTES 7u
static uint32_t offset_of(uint32_t number)
{
    return number * FIRST_BYTES + number * (number - 1) / 2;
}

static bytes fragment_on(const char *channel, uint32_t sequence, uint32_t number, uint32_t count)
{
    const header h = {sequence, offset_of(count), offset_of(number), number, count};
    return fragment_with(h, number == 0 ? channel : NULL, FIRST_BYTES + number);
}

static bytes fragment(uint32_t sequence, uint32_t number, uint32_t count)
{
    return fragment_on("CAMERA", sequence, number, count);
}

// --- what comes of them ---

static vdna_arrival accept_at(uint64_t source, int64_t time_us, bytes datagram)
{
    // Of its exact size, so that sanitizers see the first byte beyond it.
    static uint8_t *exact;
    free(exact);
    exact = malloc(datagram.size ? datagram.size : 1);
    memcpy(exact, datagram.data, datagram.size);
    const vdna_datagram d = {exact, datagram.size, source, time_us};
    return vdna_reassembly_accept(r, &d);
}

static vdna_arrival accept(bytes datagram)
{
    return accept_at(1, 0, datagram);
}

static void assert_nothing(vdna_arrival arrival)
{
    assert_int_equal(arrival.kind, VDNA_ARRIVAL_NOTHING);
}

static void assert_whole(vdna_arrival arrival, uint32_t sequence, size_t size)
{
    assert_int_equal(arrival.kind, VDNA_ARRIVAL_MESSAGE);
    assert_int_equal(arrival.sequence, sequence);
    assert_int_equal(arrival.size, size);
    assert_int_equal(arrival.total_size, size);
    for (size_t i = 0; i < size; i++)
        assert_int_equal(arrival.data[i], byte_at(sequence, i));
}

static void assert_counts(uint64_t malformed, uint64_t repeated, uint64_t incomplete)
{
    const vdna_reassembly_counters *counters = vdna_reassembly_count(r);
    assert_int_equal(counters->malformed, malformed);
    assert_int_equal(counters->repeated, repeated);
    assert_int_equal(counters->incomplete, incomplete);
}

static void assert_malformed(bytes datagram)
{
    const uint64_t before = vdna_reassembly_count(r)->malformed;
    assert_nothing(accept(datagram));
    assert_int_equal(vdna_reassembly_count(r)->malformed, before + 1);
}

// --- short messages ---

static void a_short_message_is_there_at_once(void **state)
{
    (void)state;
    const vdna_arrival image = accept(short_message(5, "CAMERA", 20));
    assert_whole(image, 5, 20);
    assert_int_equal(image.wanted, 0);
    assert_int_equal(image.source, 1);
    assert_string_equal(image.channel, "CAMERA");
    const vdna_arrival command = accept(short_message(6, "COMMAND", 0));
    assert_whole(command, 6, 0);
    assert_int_equal(command.wanted, 1);
    assert_counts(0, 0, 0);
}

static void of_another_channel_the_beginning_is_shown(void **state)
{
    (void)state;
    const char *others[] = {"CAMERA2", "CAMER", "camera", "X"};
    for (uint32_t i = 0; i < 4; i++) {
        const vdna_arrival other = accept(short_message(i, others[i], 9));
        assert_int_equal(other.kind, VDNA_ARRIVAL_OTHER);
        assert_string_equal(other.channel, others[i]);
        assert_int_equal(other.size, 9);
        assert_int_equal(other.data[8], byte_at(i, 8));
    }
    const vdna_arrival large = accept(fragment_on("LIDAR", 9, 0, 3));
    assert_int_equal(large.kind, VDNA_ARRIVAL_OTHER);
    assert_int_equal(large.size, FIRST_BYTES);
    assert_int_equal(large.total_size, offset_of(3));
    assert_nothing(accept(fragment_on("LIDAR", 9, 1, 3)));
    assert_nothing(accept(fragment_on("LIDAR", 9, 2, 3)));
    assert_counts(0, 2, 0);
}

static void a_short_message_that_is_too_large_for_its_channel_is_not_handed_out(void **state)
{
    (void)state;
    assert_whole(accept(short_message(1, "COMMAND", COMMAND_MAX)), 1, COMMAND_MAX);
    const vdna_arrival large = accept(short_message(2, "COMMAND", COMMAND_MAX + 1));
    assert_int_equal(large.kind, VDNA_ARRIVAL_TOO_LARGE);
    assert_int_equal(large.wanted, 1);
    assert_int_equal(large.total_size, COMMAND_MAX + 1);
}

static void a_duplicate_is_ignored_and_another_message_of_its_number_is_not(void **state)
{
    (void)state;
    accept(short_message(5, "CAMERA", 20));
    assert_nothing(accept(short_message(5, "CAMERA", 20)));
    assert_counts(0, 1, 0);
    // A sender that does not number its messages, another sender, another channel.
    bytes other = short_message(5, "CAMERA", 20);
    other.data[20] ^= 1;
    assert_int_equal(accept(other).kind, VDNA_ARRIVAL_MESSAGE);
    assert_whole(accept(short_message(5, "CAMERA", 21)), 5, 21);
    assert_whole(accept_at(2, 0, short_message(5, "CAMERA", 20)), 5, 20);
    assert_whole(accept(short_message(5, "COMMAND", 20)), 5, 20);
    assert_counts(0, 1, 0);
}

static void a_message_of_long_ago_is_no_duplicate(void **state)
{
    (void)state;
    accept_at(1, 1000, short_message(5, "CAMERA", 20));
    accept_at(1, 1000, fragment(6, 0, 1));
    const int64_t last = 1000 + VDNA_REASSEMBLY_PATIENCE_US;
    assert_nothing(accept_at(1, last, short_message(5, "CAMERA", 20)));
    assert_nothing(accept_at(1, last, fragment(6, 0, 1)));
    assert_whole(accept_at(1, last + 1, short_message(5, "CAMERA", 20)), 5, 20);
    assert_whole(accept_at(1, last + 1, fragment(6, 0, 1)), 6, FIRST_BYTES);
}

// --- what is malformed ---

static void a_datagram_that_ends_early_is_malformed(void **state)
{
    (void)state;
    const bytes whole[] = {short_message(1, "CAMERA", 0), fragment(2, 0, 2)};
    const size_t headers[] = {8 + sizeof "CAMERA", 20 + sizeof "CAMERA"};
    for (size_t i = 0; i < 2; i++)
        for (size_t size = 0; size < headers[i]; size++) {
            bytes cut = whole[i];
            cut.size = size;
            assert_malformed(cut);
        }
}

static void another_magic_number_is_malformed(void **state)
{
    (void)state;
    for (uint32_t magic = 0x4C433030; magic < 0x4C433040; magic++) {
        bytes datagram = short_message(1, "CAMERA", 30);
        datagram.data[3] = (uint8_t)magic;
        if (magic != 0x4C433032)
            assert_malformed(datagram);
    }
}

static void a_channel_has_1_to_63_bytes(void **state)
{
    (void)state;
    char name[66];
    memset(name, 'x', sizeof name);
    name[64] = 0;
    assert_malformed(short_message(1, "", 10));
    assert_malformed(short_message(2, name, 10));
    assert_malformed(fragment_on("", 3, 0, 2));
    assert_malformed(fragment_on(name, 4, 0, 2));
    assert_int_equal(accept(short_message(5, name + 1, 10)).kind, VDNA_ARRIVAL_OTHER);
    assert_int_equal(accept(fragment_on(name + 1, 6, 0, 2)).kind, VDNA_ARRIVAL_OTHER);
}

// Nothing that is malformed may disturb a message that comes meanwhile.
static void a_fragment_lies_within_its_message(void **state)
{
    (void)state;
    static const struct {
        header h;
        size_t size;
    } cases[] = {
        {{7, 100, 0xffffff00, 1, 3}, 0x200}, // the offset wraps: this ended liblcm
        {{7, 100, 0xffffff00, 1, 3}, 0x110},
        {{7, 100, 90, 1, 3}, 11},
        {{7, 100, 101, 1, 3}, 0},
        {{7, 100, 100, 1, 3}, 1},
        {{7, 100, 50, 1, 3}, 0}, // no byte
        {{7, 100, 50, 3, 3}, 10},
        {{7, 100, 50, 65535, 3}, 10}, // no such number
        {{7, 100, 0, 0, 0}, 10},
        {{7, 100, 50, 1, 0}, 10},
        {{7, 100, 90, 2, 3}, 9}, // not at the end
        {{7, 1, 0, 1, 3}, 1},    // more than bytes
        {{7, (1u << 28) + 1, 50, 1, 3}, 10},
        {{7, UINT32_MAX, 50, 1, 3}, 10},
    };
    accept(fragment(1, 0, 2));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_malformed(fragment_with(cases[i].h, NULL, cases[i].size));
    assert_malformed(fragment_with((header){7, 100, 1, 0, 3}, "CAMERA", 10)); // the first elsewhere
    assert_whole(accept(fragment(1, 1, 2)), 1, offset_of(2));
    assert_counts(sizeof cases / sizeof *cases + 1, 0, 0);
}

static void two_datagrams_do_no_harm(void **state)
{
    (void)state;
    bytes first = fragment_with((header){7, 900, 0, 0, 3}, "CAMERA", 100);
    assert_nothing(accept(first));
    assert_malformed(fragment_with((header){7, 900, 0xffffff00, 1, 3}, NULL, 0x200));
    assert_nothing(accept(fragment_with((header){7, 900, 100, 1, 3}, NULL, 300)));
    assert_whole(accept(fragment_with((header){7, 900, 400, 2, 3}, NULL, 500)), 7, 900);
}

static void fragments_that_contradict_their_message_are_malformed(void **state)
{
    (void)state;
    accept(fragment_with((header){7, 100, 0, 0, 4}, "CAMERA", 20));
    assert_malformed(fragment_with((header){7, 101, 20, 1, 4}, NULL, 30)); // size
    assert_malformed(fragment_with((header){7, 100, 20, 1, 5}, NULL, 30)); // count
    assert_malformed(fragment_with((header){7, 100, 19, 1, 4}, NULL, 31)); // overlaps fragment 0
    assert_malformed(fragment_with((header){7, 100, 21, 1, 4}, NULL, 29)); // leaves a gap
    assert_nothing(accept(fragment_with((header){7, 100, 50, 2, 4}, NULL, 10)));
    assert_malformed(fragment_with((header){7, 100, 20, 1, 4}, NULL, 29)); // gap to fragment 2
    assert_malformed(fragment_with((header){7, 100, 20, 1, 4}, NULL, 31));
    assert_malformed(fragment_with((header){7, 100, 59, 3, 4}, NULL, 41));
    assert_nothing(accept(fragment_with((header){7, 100, 20, 1, 4}, NULL, 30)));
    assert_whole(accept(fragment_with((header){7, 100, 60, 3, 4}, NULL, 40)), 7, 100);
    assert_counts(7, 0, 0);
}

// Sums of sizes and numbers of fragments are right here: this delivers a hole where those are
// counted.
static void an_overlap_does_not_hide_a_hole(void **state)
{
    (void)state;
    accept(fragment_with((header){7, 90, 0, 0, 3}, "CAMERA", 30));
    assert_malformed(fragment_with((header){7, 90, 15, 1, 3}, NULL, 30));
    assert_nothing(accept(fragment_with((header){7, 90, 60, 2, 3}, NULL, 30)));
    assert_nothing(accept(fragment_with((header){7, 90, 60, 2, 3}, NULL, 30)));
    assert_whole(accept(fragment_with((header){7, 90, 30, 1, 3}, NULL, 30)), 7, 90);
}

static void the_first_content_of_a_fragment_stays(void **state)
{
    (void)state;
    accept(fragment(1, 0, 2));
    bytes changed = fragment(1, 0, 2);
    changed.data[changed.size - 1] ^= 0xff;
    assert_nothing(accept(changed));
    assert_whole(accept(fragment(1, 1, 2)), 1, offset_of(2));
}

// --- limits ---

static void a_large_message_is_refused_by_its_first_fragment_and_once(void **state)
{
    (void)state;
    const uint32_t size = CAMERA_MAX + 1;
    assert_nothing(accept(fragment_with((header){7, size, 500, 1, 2}, NULL, size - 500)));
    const bytes first = fragment_with((header){7, size, 0, 0, 2}, "CAMERA", 500);
    const vdna_arrival large = accept(first);
    assert_int_equal(large.kind, VDNA_ARRIVAL_TOO_LARGE);
    assert_int_equal(large.wanted, 0);
    assert_int_equal(large.size, 500);
    assert_int_equal(large.total_size, size);
    assert_nothing(accept(first));
    assert_nothing(accept(fragment_with((header){7, size, 500, 1, 2}, NULL, size - 500)));
    assert_counts(0, 2, 0);
    assert_int_equal(vdna_reassembly_lost(r), 0);
    // It would fit the other channel.
    const uint32_t middle = COMMAND_MAX + 1;
    assert_nothing(accept(fragment_with((header){8, middle, 50, 1, 2}, NULL, middle - 50)));
    assert_int_equal(accept(fragment_with((header){8, middle, 0, 0, 2}, "COMMAND", 50)).kind,
                     VDNA_ARRIVAL_TOO_LARGE);
    assert_counts(0, 2, 0);
}

static void other_fragments_of_a_large_message_take_no_place(void **state)
{
    (void)state;
    for (uint32_t sequence = 1; sequence <= 3; sequence++)
        accept(fragment(sequence, 0, 2));
    assert_nothing(accept(fragment_with((header){7, 1 << 20, (1 << 20) - 10, 1, 2}, NULL, 10)));
    assert_counts(0, 0, 0);
}

static void the_largest_message_and_the_most_fragments_fit(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < CAMERA_MAX; i++) {
        const header h = {7, CAMERA_MAX, i, i, CAMERA_MAX};
        const vdna_arrival arrival = accept(fragment_with(h, i == 0 ? "CAMERA" : NULL, 1));
        if (i < CAMERA_MAX - 1)
            assert_nothing(arrival);
        else
            assert_whole(arrival, 7, CAMERA_MAX);
    }
}

static void a_sender_has_three_messages_at_a_time(void **state)
{
    (void)state;
    for (uint32_t sequence = 1; sequence <= 4; sequence++)
        assert_nothing(accept(fragment(sequence, 0, 2)));
    assert_nothing(accept_at(2, 0, fragment(1, 0, 2))); // another one has room
    assert_counts(0, 0, 1);
    assert_nothing(accept(fragment(1, 1, 2)));
    assert_counts(0, 1, 1);
    for (uint32_t sequence = 2; sequence <= 4; sequence++)
        assert_whole(accept(fragment(sequence, 1, 2)), sequence, offset_of(2));
    assert_whole(accept_at(2, 0, fragment(1, 1, 2)), 1, offset_of(2));
}

static void the_oldest_of_all_messages_makes_room(void **state)
{
    (void)state;
    for (uint64_t source = 1; source <= VDNA_REASSEMBLY_SLOTS + 1; source++)
        assert_nothing(accept_at(source, 0, fragment(1, 0, 2)));
    assert_counts(0, 0, 1);
    assert_nothing(accept_at(1, 0, fragment(1, 1, 2)));
    for (uint64_t source = 2; source <= VDNA_REASSEMBLY_SLOTS + 1; source++)
        assert_whole(accept_at(source, 0, fragment(1, 1, 2)), 1, offset_of(2));
    assert_counts(0, 1, 1);
}

static void a_message_that_pauses_for_more_than_a_second_is_given_up(void **state)
{
    (void)state;
    const int64_t pause = VDNA_REASSEMBLY_PATIENCE_US;
    accept_at(1, 1000, fragment(1, 0, 3));
    accept_at(1, 1000 + pause, fragment(1, 1, 3));
    assert_whole(accept_at(1, 1000 + 2 * pause, fragment(1, 2, 3)), 1, offset_of(3));
    accept_at(1, 0, fragment(2, 0, 2));
    accept_at(2, pause + 1, short_message(9, "X", 1)); // of somebody else
    assert_counts(0, 0, 1);
    // Its number may be used again by a sender that began anew.
    accept_at(1, 2 * pause + 2, fragment(2, 0, 2));
    assert_whole(accept_at(1, 2 * pause + 2, fragment(2, 1, 2)), 2, offset_of(2));
}

static void time_that_runs_backwards_does_no_harm(void **state)
{
    (void)state;
    accept_at(1, INT64_MAX, fragment(1, 0, 3));
    accept_at(1, INT64_MIN, fragment(1, 1, 3));
    assert_nothing(accept_at(1, INT64_MAX, fragment(1, 2, 3)));
    assert_counts(0, 0, 1);
}

// --- messages that are held ---

static void held_messages_stay_until_they_are_released(void **state)
{
    (void)state;
    accept(fragment(1, 0, 2));
    vdna_arrival arrival = accept(fragment(1, 1, 2));
    const uint32_t first = vdna_reassembly_hold(r, &arrival);
    arrival = accept(short_message(2, "CAMERA", 500));
    const uint32_t second = vdna_reassembly_hold(r, &arrival);
    for (uint32_t sequence = 3; sequence < 100; sequence++) {
        accept(fragment(sequence, 1, 2));
        if (sequence % 3)
            assert_whole(accept(fragment(sequence, 0, 2)), sequence, offset_of(2));
    }
    for (uint32_t i = 0; i < offset_of(2); i++)
        assert_int_equal(vdna_reassembly_held(r, first)[i], byte_at(1, i));
    for (uint32_t i = 0; i < 500; i++)
        assert_int_equal(vdna_reassembly_held(r, second)[i], byte_at(2, i));
    vdna_reassembly_release(r, first);
    vdna_reassembly_release(r, second);
    for (uint64_t source = 1; source <= VDNA_REASSEMBLY_SLOTS; source++)
        accept_at(source, 0, fragment(200, 0, 2));
    for (uint64_t source = 1; source <= VDNA_REASSEMBLY_SLOTS; source++)
        assert_whole(accept_at(source, 0, fragment(200, 1, 2)), 200, offset_of(2));
}

// --- losses ---

static void lost_messages_are_known_by_the_numbers_of_the_sender(void **state)
{
    (void)state;
    accept_at(2, 0, short_message(50, "X", 5)); // no camera
    accept_at(2, 0, short_message(60, "X", 5));
    assert_int_equal(vdna_reassembly_lost(r), 0);

    accept(short_message(10, "CAMERA", 5));
    accept(short_message(9, "CAMERA", 5)); // before the first
    accept(short_message(13, "CAMERA", 5));
    assert_int_equal(vdna_reassembly_lost(r), 2);
    accept(short_message(11, "POSE", 5)); // late, and not on the channel
    accept(short_message(11, "POSE", 5));
    assert_int_equal(vdna_reassembly_lost(r), 1);

    accept(fragment(14, 0, 2));
    assert_int_equal(vdna_reassembly_lost(r), 1);
    accept(short_message(15, "CAMERA", 5));
    assert_int_equal(vdna_reassembly_lost(r), 1);            // 14 is half there
    for (uint32_t sequence = 16; sequence <= 18; sequence++) // so 14 is given up
        accept(fragment(sequence, 0, 2));
    accept(short_message(19, "CAMERA", 5));
    assert_int_equal(vdna_reassembly_lost(r), 2);
    assert_counts(0, 1, 1);
}

static void numbers_may_wrap_and_begin_anew(void **state)
{
    (void)state;
    accept(short_message(UINT32_MAX - 1, "CAMERA", 5));
    accept(short_message(1, "CAMERA", 6));
    assert_int_equal(vdna_reassembly_lost(r), 2);
    accept(short_message(1000000, "CAMERA", 7));
    accept(short_message(1000002, "CAMERA", 8));
    assert_int_equal(vdna_reassembly_lost(r), 3);
    accept(short_message(0, "CAMERA", 9));
    assert_int_equal(vdna_reassembly_lost(r), 3);
}

static void the_losses_of_senders_that_are_gone_stay(void **state)
{
    (void)state;
    for (uint64_t source = 1; source <= 10; source++) {
        accept_at(source, 0, short_message(1, "CAMERA", 5));
        accept_at(source, 0, short_message(3, "CAMERA", 5));
    }
    assert_int_equal(vdna_reassembly_lost(r), 10);
}

// --- memory ---

static void bad_channels_and_memory_are_refused(void **state)
{
    (void)state;
    const vdna_wanted_channel large[] = {{"A", (1u << 28) + 1}}, nameless[] = {{NULL, 10}};
    const size_t size = vdna_reassembly_mem_size(channels, 2);
    assert_int_equal(vdna_reassembly_mem_size(NULL, 1), 0);
    assert_int_equal(vdna_reassembly_mem_size(channels, 0), 0);
    assert_int_equal(vdna_reassembly_mem_size(channels, VDNA_REASSEMBLY_CHANNELS + 1), 0);
    assert_int_equal(vdna_reassembly_mem_size(large, 1), 0);
    assert_int_equal(vdna_reassembly_mem_size(nameless, 1), 0);
    assert_null(vdna_reassembly_init(channels, 2, memory, size - 1));
    assert_null(vdna_reassembly_init(channels, 2, (uint8_t *)memory + 1, size));
}

// --- all schedules ---

#define FRAGMENTS_MAX 6u

// Messages whose fragments are numbered through.
typedef struct plan {
    uint32_t messages;
    uint32_t fragments[3]; // of each message
    uint64_t source[3];
} plan;

typedef struct schedule {
    const plan *p;
    uint32_t count;
    struct {
        uint32_t message, number;
    } fragments[FRAGMENTS_MAX];
    bytes datagrams[FRAGMENTS_MAX];
    uint32_t order[2 * FRAGMENTS_MAX]; // fragments, as they come
    uint64_t done;
} schedule;

// Each message must be complete with the datagram that brings the last of its fragments for the
// first time, and never else.
static void try_schedule(schedule *s)
{
    r = vdna_reassembly_init(channels, 2, memory, vdna_reassembly_mem_size(channels, 2));
    const uint32_t length = 2 * s->count;
    uint32_t seen[3] = {0};
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t at = s->order[i], message = s->fragments[at].message;
        const uint32_t bit = 1u << s->fragments[at].number;
        const uint32_t all = (1u << s->p->fragments[message]) - 1;
        const vdna_datagram d = {s->datagrams[at].data, s->datagrams[at].size,
                                 s->p->source[message], (int64_t)i};
        const vdna_arrival arrival = vdna_reassembly_accept(r, &d);
        const bool completes = !(seen[message] & bit) && (seen[message] | bit) == all;
        seen[message] |= bit;
        if (arrival.kind != (completes ? VDNA_ARRIVAL_MESSAGE : VDNA_ARRIVAL_NOTHING))
            fail_msg("datagram %u of schedule %llu", i, (unsigned long long)s->done);
        if (completes)
            assert_whole(arrival, message, offset_of(s->p->fragments[message]));
    }
    assert_counts(0, s->count, 0);
    s->done++;
}

// All orders of the fragments that are left. Each comes twice. One that comes last is one that is
// lost, and its second time one that was not duplicated, for all that happens before.
static void try_all(schedule *s, uint32_t left[FRAGMENTS_MAX], uint32_t length)
{
    if (length == 2 * s->count)
        try_schedule(s);
    for (uint32_t i = 0; i < s->count; i++) {
        if (left[i] == 0)
            continue;
        left[i]--;
        s->order[length] = i;
        try_all(s, left, length + 1);
        left[i]++;
    }
}

static uint64_t try_plan(const plan *p)
{
    static schedule s;
    s = (schedule){.p = p};
    for (uint32_t message = 0; message < p->messages; message++)
        for (uint32_t number = 0; number < p->fragments[message]; number++) {
            s.fragments[s.count].message = message;
            s.fragments[s.count].number = number;
            s.datagrams[s.count++] = fragment(message, number, p->fragments[message]);
        }
    uint32_t left[FRAGMENTS_MAX] = {2, 2, 2, 2, 2, 2};
    try_all(&s, left, 0);
    return s.done;
}

static void every_schedule_delivers_exactly_what_came_whole(void **state)
{
    (void)state;
    static const plan plans[] = {
        {1, {1}, {1}},
        {1, {2}, {1}},
        {1, {3}, {1}},
        {1, {4}, {1}},
        {1, {5}, {1}},
        {2, {1, 1}, {1, 2}},
        {2, {2, 1}, {1, 2}},
        {2, {2, 2}, {1, 2}},
        {2, {3, 1}, {1, 2}},
        {2, {3, 2}, {1, 2}},
        {2, {4, 1}, {1, 2}},
        {2, {2, 2}, {1, 1}},
        {2, {3, 2}, {1, 1}},
        {3, {2, 1, 2}, {1, 2, 1}},
        // With VDNA_ALL only: 7 million schedules each.
        {1, {6}, {1}},
        {2, {5, 1}, {1, 2}},
        {2, {4, 2}, {1, 2}},
        {2, {3, 3}, {1, 2}},
        {2, {4, 2}, {1, 1}},
        {2, {3, 3}, {1, 1}},
        {3, {2, 2, 2}, {1, 2, 1}},
    };
    const size_t quick = 14, all = sizeof plans / sizeof *plans;
    uint64_t schedules = 0;
    for (size_t i = 0; i < (getenv("VDNA_ALL") ? all : quick); i++)
        schedules += try_plan(&plans[i]);
    print_message("%llu schedules\n", (unsigned long long)schedules);
    assert_true(schedules > 100000);
}

#define FRESH(test) cmocka_unit_test_setup_teardown(test, begin, end)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FRESH(a_short_message_is_there_at_once),
        FRESH(of_another_channel_the_beginning_is_shown),
        FRESH(a_short_message_that_is_too_large_for_its_channel_is_not_handed_out),
        FRESH(a_duplicate_is_ignored_and_another_message_of_its_number_is_not),
        FRESH(a_message_of_long_ago_is_no_duplicate),
        FRESH(a_datagram_that_ends_early_is_malformed),
        FRESH(another_magic_number_is_malformed),
        FRESH(a_channel_has_1_to_63_bytes),
        FRESH(a_fragment_lies_within_its_message),
        FRESH(two_datagrams_do_no_harm),
        FRESH(fragments_that_contradict_their_message_are_malformed),
        FRESH(an_overlap_does_not_hide_a_hole),
        FRESH(the_first_content_of_a_fragment_stays),
        FRESH(a_large_message_is_refused_by_its_first_fragment_and_once),
        FRESH(other_fragments_of_a_large_message_take_no_place),
        FRESH(the_largest_message_and_the_most_fragments_fit),
        FRESH(a_sender_has_three_messages_at_a_time),
        FRESH(the_oldest_of_all_messages_makes_room),
        FRESH(a_message_that_pauses_for_more_than_a_second_is_given_up),
        FRESH(time_that_runs_backwards_does_no_harm),
        FRESH(held_messages_stay_until_they_are_released),
        FRESH(lost_messages_are_known_by_the_numbers_of_the_sender),
        FRESH(numbers_may_wrap_and_begin_anew),
        FRESH(the_losses_of_senders_that_are_gone_stay),
        FRESH(bad_channels_and_memory_are_refused),
        FRESH(every_schedule_delivers_exactly_what_came_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
