// Logs, whole and damaged. The events are written here, byte by byte.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cmocka_all.h"
#include "log.h"

#define PATH_TEMPLATE "/tmp/vdna_test_log_XXXXXX"
#define HEADER 28

typedef struct bytes {
    uint8_t data[4096];
    size_t size;
} bytes;

static void put(bytes *out, uint64_t value, int size)
{
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
        out->data[out->size++] = (uint8_t)(value >> shift);
}

static void put_text(bytes *out, const char *text)
{
    memcpy(out->data + out->size, text, strlen(text));
    out->size += strlen(text);
}

static void put_event(bytes *out, int64_t time_us, const char *channel, const char *data)
{
    put(out, 0xEDA1DA01, 4);
    put(out, 7, 8);
    put(out, (uint64_t)time_us, 8);
    put(out, strlen(channel), 4);
    put(out, strlen(data), 4);
    put_text(out, channel);
    put_text(out, data);
}

// Three events, "A" to "C" on channel X, a millisecond apart.
static bytes three_events(void)
{
    bytes log = {.size = 0};
    put_event(&log, 1000, "X", "A");
    put_event(&log, 2000, "X", "B");
    put_event(&log, 3000, "X", "C");
    return log;
}

#define EVENT (HEADER + 2)

static vdna_log *open_bytes(const bytes *log, const char *options)
{
    char path[] = PATH_TEMPLATE, url[128];
    const int descriptor = mkstemp(path);
    assert_int_equal(write(descriptor, log->data, log->size), log->size);
    close(descriptor);
    snprintf(url, sizeof url, "file://%s%s", path, options);
    vdna_log *opened = vdna_log_open(url);
    assert_non_null(opened);
    unlink(path);
    return opened;
}

// The data of all events in a row, and the bytes passed over.
static void assert_read(const bytes *log, const char *expected, uint64_t damaged)
{
    vdna_log *opened = open_bytes(log, "?speed=0");
    char found[256] = "";
    vdna_log_event event;
    while (vdna_log_next(opened, 0, &event) == 1)
        snprintf(found + strlen(found), sizeof found - strlen(found), "%.*s", (int)event.size,
                 (const char *)event.data);
    assert_string_equal(found, expected);
    assert_int_equal(vdna_log_damaged_bytes(opened), damaged);
    assert_int_equal(vdna_log_next(opened, 0, &event), -1);
    vdna_log_close(opened);
}

static void events_come_in_order_with_channel_and_data(void **state)
{
    (void)state;
    bytes log = {.size = 0};
    put_event(&log, 5, "CAMERA", "first");
    put_event(&log, 6, "P", "");
    vdna_log *opened = open_bytes(&log, "?speed=0");
    vdna_log_event event;
    assert_int_equal(vdna_log_next(opened, 0, &event), 1);
    assert_string_equal(event.channel, "CAMERA");
    assert_int_equal(event.size, 5);
    assert_memory_equal(event.data, "first", 5);
    assert_int_equal(vdna_log_next(opened, 0, &event), 1);
    assert_string_equal(event.channel, "P");
    assert_int_equal(event.size, 0);
    assert_int_equal(vdna_log_next(opened, 0, &event), -1);
    vdna_log_close(opened);
}

static void zeros_at_the_end_are_the_end(void **state)
{
    (void)state;
    bytes log = three_events();
    for (int zeros = 1; zeros <= 64; zeros++) {
        log.size++;
        assert_read(&log, "ABC", 0);
    }
}

static void half_an_event_at_the_end_is_the_end(void **state)
{
    (void)state;
    bytes log = three_events();
    for (log.size--; log.size > 2 * EVENT; log.size--)
        assert_read(&log, "AB", 0);
}

static void after_damage_reading_goes_on_with_the_next_event(void **state)
{
    (void)state;
    bytes log = three_events();
    memset(log.data + EVENT, 0, EVENT);
    assert_read(&log, "AC", EVENT);

    log = three_events();
    memcpy(log.data, "XXXX", 4); // no log at all, at first
    assert_read(&log, "BC", EVENT);

    log = three_events();
    memset(log.data + 2 * EVENT, 'x', EVENT); // and at last
    assert_read(&log, "AB", EVENT);
}

static void a_damaged_length_costs_its_event(void **state)
{
    (void)state;
    const uint32_t lengths[] = {0xffffffff, 0x80000000, 0x7fffffff, 0x10000000, 3000, 2};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        for (size_t at = EVENT + 20; at <= EVENT + 24; at += 4) { // of channel and data
            bytes log = three_events();
            bytes length = {.size = 0};
            put(&length, lengths[i], 4);
            memcpy(log.data + at, length.data, 4);
            assert_read(&log, "AC", EVENT);
        }
    }
}

static void a_length_that_is_too_short_costs_the_bytes_left_over(void **state)
{
    (void)state;
    bytes log = three_events();
    log.data[EVENT + 27] = 0;
    assert_read(&log, "AC", 1);
}

static void an_event_that_was_cut_does_not_swallow_the_next_ones(void **state)
{
    (void)state;
    bytes log = {.size = 0};
    put_event(&log, 1000, "X", "A and much more");
    log.size -= 5;
    put_event(&log, 2000, "X", "B");
    assert_read(&log, "B", HEADER + 1 + 10);
}

static void damage_that_looks_like_an_event_is_passed_over(void **state)
{
    (void)state;
    bytes log = {.size = 0};
    put(&log, 0xEDA1DA01, 4);
    put(&log, 0xEDA1DA01, 4);
    put_event(&log, 1000, "X", "A");
    put_event(&log, 2000, "X", "\xED\xA1\xDA\x01 in the data");
    assert_read(&log, "A\xED\xA1\xDA\x01 in the data", 8);
}

static void any_bytes_end_the_log_in_the_end(void **state)
{
    (void)state;
    srand(1);
    for (int round = 0; round < 3000; round++) {
        bytes log = three_events();
        put_event(&log, 4000, "a longer channel", "and longer data");
        for (int change = rand() % 8; change >= 0; change--)
            log.data[(size_t)rand() % log.size] = (uint8_t)rand();
        log.size = (size_t)rand() % (log.size + 1);
        vdna_log *opened = open_bytes(&log, "?speed=0");
        vdna_log_event event;
        int events = 0;
        while (vdna_log_next(opened, 0, &event) == 1)
            events++;
        assert_in_range(events, 0, 4);
        assert_in_range(vdna_log_damaged_bytes(opened), 0, log.size);
        vdna_log_close(opened);
    }
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void events_come_at_the_pace_of_the_url(void **state)
{
    (void)state;
    bytes log = {.size = 0};
    put_event(&log, 1000000, "X", "A");
    put_event(&log, 1200000, "X", "B");
    const struct {
        const char *options;
        double least; // seconds
    } cases[] = {{"", 0.2}, {"?speed=2", 0.1}, {"?speed=0", 0}, {"?speed=nonsense", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_log *opened = open_bytes(&log, cases[i].options);
        vdna_log_event event;
        assert_int_equal(vdna_log_next(opened, 0, &event), 1);
        const double begin = seconds();
        if (cases[i].least > 0)
            assert_int_equal(vdna_log_next(opened, 1, &event), 0);
        while (vdna_log_next(opened, 50, &event) == 0)
            ;
        assert_memory_equal(event.data, "B", 1);
        assert_true(seconds() - begin >= cases[i].least * 0.99);
        vdna_log_close(opened);
    }
}

static void events_before_the_start_are_passed_over(void **state)
{
    (void)state;
    const bytes log = three_events();
    vdna_log *opened = open_bytes(&log, "?speed=0&start_timestamp=2000");
    vdna_log_event event;
    assert_int_equal(vdna_log_next(opened, 0, &event), 1);
    assert_memory_equal(event.data, "B", 1);
    vdna_log_close(opened);
}

static void what_is_no_file_is_no_log(void **state)
{
    (void)state;
    assert_null(vdna_log_open("file:///no/such/log"));
    assert_null(vdna_log_open("file:///tmp"));
    vdna_log_close(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(events_come_in_order_with_channel_and_data),
        cmocka_unit_test(zeros_at_the_end_are_the_end),
        cmocka_unit_test(half_an_event_at_the_end_is_the_end),
        cmocka_unit_test(after_damage_reading_goes_on_with_the_next_event),
        cmocka_unit_test(a_damaged_length_costs_its_event),
        cmocka_unit_test(a_length_that_is_too_short_costs_the_bytes_left_over),
        cmocka_unit_test(an_event_that_was_cut_does_not_swallow_the_next_ones),
        cmocka_unit_test(damage_that_looks_like_an_event_is_passed_over),
        cmocka_unit_test(any_bytes_end_the_log_in_the_end),
        cmocka_unit_test(events_come_at_the_pace_of_the_url),
        cmocka_unit_test(events_before_the_start_are_passed_over),
        cmocka_unit_test(what_is_no_file_is_no_log),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
