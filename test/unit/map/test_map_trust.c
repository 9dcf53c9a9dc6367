/* The file of what a map knows about itself: written ones are read back for the experiences that
 * are asked for, and only valid ones are read. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <sys/stat.h>

#include <vdna/map_trust.h>

#include "cmocka_all.h"
#include "edited_file.h"
#include "watched_calls.h"

enum { RUNS = 3, NUMBERS = sizeof(vdna_trust_cell) / sizeof(double) };

/* A map of experiences "a", "b" and "c" of two frames each, with its own file. */
typedef struct map {
    edited_file file; /* its `directory` is the map */
    vdna_experience experiences[RUNS];
    vdna_trust_cell cells[RUNS][RUNS];
    double own_scale[RUNS], correlation[RUNS];
    uint32_t frames[RUNS];
    vdna_map_trust trust;
} map;

/* Write experience number `i` of this first grey level, and open it. */
static void make_experience(map *m, uint32_t i, float grey)
{
    const float greys[2] = {grey, 0};
    vdna_experience sample = sample_experience();
    char name[16];
    snprintf(sample.name, sizeof sample.name, "%c", 'a' + (int)i);
    snprintf(name, sizeof name, "%c" VDNA_MAP_EXTENSION, 'a' + (int)i);
    sample.frame_grey = greys;
    const char *path = path_in(&m->file.directory, name);
    vdna_experience_close(&m->experiences[i]);
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &m->experiences[i]), VDNA_OK);
}

static void fill_tables(map *m)
{
    for (int a = 0; a < RUNS; a++) {
        m->own_scale[a] = 0.25 * (a + 1);
        m->correlation[a] = a == 0 ? NAN : 3.5 * a;
        m->frames[a] = 2;
        for (int b = 0; b < RUNS; b++)
            for (int i = 0; i < (int)VDNA_TRUST_WINDOWS; i++) {
                const double x = 0.1 * a + 0.01 * b + 0.001 * i;
                m->cells[a][b].nearest[i] = x;
                m->cells[a][b].likeness[i] = x + 1;
                m->cells[a][b].recall[i] = b == 2 ? NAN : x / 2;
                m->cells[a][b].distance[i] = 10 * x;
            }
    }
    m->trust.tables = (vdna_trust_tables){m->frames, m->own_scale, m->correlation, m->cells[0]};
    m->trust.tolerance = 2.5;
    m->trust.runs = RUNS;
    m->trust.localiser = VDNA_TRUST_EUCLIDEAN;
}

static const char *file_of(const map *m)
{
    return path_in(&m->file.directory, VDNA_MAP_TRUST_FILE);
}

static void write_trust(map *m)
{
    vdna_error error = {""};
    if (vdna_map_trust_write(m->file.directory.path, m->experiences, &m->trust, &error) != VDNA_OK)
        fail_msg("not written: %s", error.text);
    m->file.size = load_file(file_of(m), m->file.bytes, sizeof m->file.bytes);
}

static int set_up(void **state)
{
    map *m = calloc(1, sizeof *m);
    m->file.directory = make_directory_in_memory();
    for (uint32_t i = 0; i < RUNS; i++)
        make_experience(m, i, (float)i);
    fill_tables(m);
    write_trust(m);
    *state = m;
    return 0;
}

static int tear_down(void **state)
{
    map *m = *state;
    for (uint32_t i = 0; i < RUNS; i++)
        vdna_experience_close(&m->experiences[i]);
    remove_directory(&m->file.directory);
    free(m);
    return 0;
}

static vdna_status open_trust(const map *m, uint32_t count, vdna_error *error, vdna_map_trust *out)
{
    return vdna_map_trust_open(m->file.directory.path, m->experiences, count, error, out);
}

/* Check that the file is refused for the intended reason, with the remedy, without output. */
static void assert_useless(const map *m, vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    vdna_map_trust trust, untouched;
    memset(&trust, 0xAA, sizeof trust);
    untouched = trust;
    assert_int_equal(open_trust(m, RUNS, &error, &trust), expected);
    assert_memory_equal(&trust, &untouched, sizeof trust);
    if (!strstr(error.text, reason) || !strstr(error.text, VDNA_MAP_TRUST_FILE ": ") ||
        !strstr(error.text, "`vdna calibrate --trust /"))
        fail_msg("expected the file, \"%s\" and the remedy in: %s", reason, error.text);
}

/* The same of the bytes in memory. */
static void assert_refused(const map *m, vdna_status expected, const char *reason)
{
    save_file(file_of(m), m->file.bytes, m->file.size);
    assert_useless(m, expected, reason);
}

static void assert_not_written(const map *m, vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    assert_int_equal(
        vdna_map_trust_write(m->file.directory.path, m->experiences, &m->trust, &error), expected);
    if (!strstr(error.text, reason))
        fail_msg("expected \"%s\" in: %s", reason, error.text);
    unsigned char bytes[FILE_SIZE];
    assert_int_equal(load_file(file_of(m), bytes, sizeof bytes), m->file.size);
    assert_memory_equal(bytes, m->file.bytes, m->file.size);
}

static void what_is_written_is_read_back(void **state)
{
    const map *m = *state;
    vdna_map_trust trust;
    assert_int_equal(open_trust(m, RUNS, NULL, &trust), VDNA_OK);
    assert_int_equal(trust.runs, RUNS);
    assert_int_equal(trust.localiser, VDNA_TRUST_EUCLIDEAN);
    assert_true(trust.tolerance == 2.5);
    assert_memory_equal(trust.tables.frames, m->frames, sizeof m->frames);
    assert_memory_equal(trust.tables.own_scale, m->own_scale, sizeof m->own_scale);
    assert_memory_equal(trust.tables.correlation, m->correlation, sizeof m->correlation);
    assert_memory_equal(trust.tables.cells, m->cells, sizeof m->cells);
    vdna_map_trust_close(&trust);
    assert_null(trust.memory);
    vdna_map_trust_close(&trust);
    vdna_map_trust_close(NULL);
}

static void the_runs_are_those_asked_for_in_their_order(void **state)
{
    const map *m = *state;
    const vdna_experience asked[2] = {m->experiences[2], m->experiences[0]};
    vdna_map_trust trust;
    assert_int_equal(vdna_map_trust_open(m->file.directory.path, asked, 2, NULL, &trust), VDNA_OK);
    assert_int_equal(trust.runs, 2);
    assert_true(trust.tables.own_scale[0] == 0.75 && trust.tables.own_scale[1] == 0.25);
    assert_true(trust.tables.correlation[0] == 7 && isnan(trust.tables.correlation[1]));
    assert_memory_equal(&trust.tables.cells[1], &m->cells[2][0], sizeof(vdna_trust_cell));
    assert_memory_equal(&trust.tables.cells[2], &m->cells[0][2], sizeof(vdna_trust_cell));
    vdna_map_trust_close(&trust);
}

static void a_map_of_one_experience_has_such_a_file_too(void **state)
{
    map *m = *state;
    m->trust.runs = 1;
    m->trust.localiser = VDNA_TRUST_CENTRED;
    write_trust(m);
    vdna_map_trust trust;
    assert_int_equal(open_trust(m, 1, NULL, &trust), VDNA_OK);
    assert_int_equal(trust.runs, 1);
    assert_int_equal(trust.localiser, VDNA_TRUST_CENTRED);
    vdna_map_trust_close(&trust);
    assert_useless(m, VDNA_ERR_MISMATCH, "does not know experience b");
}

static void it_is_no_experience_of_the_map(void **state)
{
    const map *m = *state;
    uint32_t count = 0;
    assert_int_equal(vdna_map_count(m->file.directory.path, NULL, &count), VDNA_OK);
    assert_int_equal(count, RUNS);
}

static void without_a_file_the_map_knows_nothing_and_the_remedy_is_said(void **state)
{
    const map *m = *state;
    unlink(file_of(m));
    assert_useless(m, VDNA_ERR_EMPTY, "the map knows nothing about itself");
}

static void an_experience_that_was_replaced_is_named(void **state)
{
    map *m = *state;
    make_experience(m, 1, 200);
    assert_useless(m, VDNA_ERR_MISMATCH, "knows experience b with CRC-32C");
}

/* To renew the file, rows and columns of all but the one that was replaced can be kept. */
static void the_experiences_that_it_still_knows_are_told_apart(void **state)
{
    map *m = *state;
    const char *path = m->file.directory.path;
    uint8_t known[RUNS] = {9, 9, 9};
    vdna_map_trust trust;
    make_experience(m, 1, 200);
    assert_int_equal(vdna_map_trust_open_known(path, m->experiences, RUNS, NULL, known, &trust),
                     VDNA_OK);
    assert_true(known[0] == 1 && known[1] == 0 && known[2] == 1);
    assert_int_equal(trust.runs, 2);
    assert_true(trust.tolerance == 2.5);
    assert_true(trust.tables.own_scale[0] == 0.25 && trust.tables.own_scale[1] == 0.75);
    assert_true(trust.tables.frames[1] == 2 && trust.tables.correlation[1] == 7);
    assert_memory_equal(&trust.tables.cells[1], &m->cells[0][2], sizeof(vdna_trust_cell));
    assert_memory_equal(&trust.tables.cells[2], &m->cells[2][0], sizeof(vdna_trust_cell));
    vdna_map_trust_close(&trust);

    vdna_error error = {""};
    assert_int_equal(vdna_map_trust_open_known(path, m->experiences + 1, 1, &error, known, &trust),
                     VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "knows experience b with CRC-32C"));
    assert_int_equal(vdna_map_trust_open_known(path, m->experiences, RUNS, NULL, NULL, &trust),
                     VDNA_ERR_ARG);
}

static void a_file_of_another_map_is_told_apart(void **state)
{
    map *m = *state;
    m->experiences[2].comparable[0] ^= 1;
    assert_useless(m, VDNA_ERR_MISMATCH, "does not compare with experience c");
}

static void any_damaged_byte_is_refused(void **state)
{
    map *m = *state;
    for (size_t i = 0; i < m->file.size; i++) {
        vdna_map_trust trust;
        m->file.bytes[i] ^= (unsigned char)(1u << i % 8);
        save_file(file_of(m), m->file.bytes, m->file.size);
        const vdna_status status = open_trust(m, RUNS, NULL, &trust);
        if (status != VDNA_ERR_FORMAT && status != VDNA_ERR_CHECKSUM &&
            status != VDNA_ERR_UNSUPPORTED)
            fail_msg("byte %zu: status %d", i, status);
        m->file.bytes[i] ^= (unsigned char)(1u << i % 8);
    }
}

static void a_file_cut_at_any_length_is_refused(void **state)
{
    map *m = *state;
    for (size_t size = 0; size < m->file.size; size++) {
        vdna_map_trust trust;
        save_file(file_of(m), m->file.bytes, size);
        assert_int_equal(open_trust(m, RUNS, NULL, &trust), VDNA_ERR_FORMAT);
    }
    m->file.size = 0;
    assert_refused(m, VDNA_ERR_FORMAT, "the file has 0 bytes");
}

static void a_newer_format_version_is_unsupported(void **state)
{
    map *m = *state;
    edit_header(&m->file, "\"format_version\":\"1\"", "\"format_version\":\"2\"");
    assert_refused(m, VDNA_ERR_UNSUPPORTED, "version 2 is newer");
}

static void a_header_that_breaks_a_rule_is_refused(void **state)
{
    const struct {
        const char *from, *to, *reason;
    } cases[] = {
        {"vdna-trust", "vdna-experience", "format is not vdna-trust"},
        {"comparable", "incomparable", "comparable in __metadata__ is missing"},
        {"\"localiser\":\"euclidean\"", "\"localiser\":\"manhattan\"", "localiser"},
        {"localiser", "locator", "localiser"},
        {"\"member_name\"", "\"other_name\"", "member_name has 0 rows"},
        {"[3,64]", "[4097,64]", "member_name has 4097 rows"},
        {"[3,64]", "[3,32]", "tensor member_name has a dtype or shape that does not fit"},
        {"[3,64]", "[3,64,1]", "expected U8 [3, 64]"},
        {"[3,3,4,7]", "[3,3,28]", "expected F64 [3, 3, 4, 7]"},
        {"[3,3,4,7]", "[3,3,4,7,1]", "expected F64 [3, 3, 4, 7]"},
        {"\"own_scale\"", "\"own_scales\"", "tensor own_scale is missing"},
        {"{\"dtype\":\"F64\",\"shape\":[1]", "{\"dtype\":\"I64\",\"shape\":[1]",
         "tensor tolerance"},
    };
    map *m = *state;
    const edited_file whole = m->file;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        m->file = whole;
        edit_header(&m->file, cases[i].from, cases[i].to);
        assert_refused(m, VDNA_ERR_FORMAT, cases[i].reason);
    }
    char comparable[VDNA_SHA256_SIZE];
    m->file = whole;
    memcpy(comparable, m->experiences[0].comparable, sizeof comparable);
    char upper[VDNA_SHA256_SIZE];
    memcpy(upper, comparable, sizeof upper);
    upper[0] = 'A';
    edit_header(&m->file, comparable, upper);
    assert_refused(m, VDNA_ERR_FORMAT, "comparable is no SHA-256");
}

static void numbers_that_break_a_rule_are_refused(void **state)
{
    const double bad = NAN, negative = -1, endless = INFINITY;
    const uint32_t none = 0;
    const struct {
        const char *tensor;
        const void *number;
        size_t width;
        const char *reason;
    } cases[] = {
        {"tolerance", &bad, sizeof bad, "tolerance is"},
        {"tolerance", &negative, sizeof negative, "tolerance is -1"},
        {"own_scale", &bad, sizeof bad, "a number of the tables"},
        {"correlation", &endless, sizeof endless, "a number of the tables"},
        {"frames", &none, sizeof none, "a number of the tables"},
        {"member_name", "", 1, "member_name 0 "},
        {"member_name", "b", 1, "two members are called b"},
    };
    map *m = *state;
    const edited_file whole = m->file;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        m->file = whole;
        edit_data(&m->file, cases[i].tensor, 0, cases[i].number, cases[i].width);
        assert_refused(m, VDNA_ERR_FORMAT, cases[i].reason);
    }
    m->file = whole;
    edit_data(&m->file, "member_name", VDNA_NAME_SIZE + 5, "x", 1);
    assert_refused(m, VDNA_ERR_FORMAT, "member_name 1 goes on after its end");
    m->file = whole;
    edit_data(&m->file, "cells", NUMBERS, &bad, sizeof bad); /* nearest of a in b */
    assert_refused(m, VDNA_ERR_FORMAT, "a number of the tables");
    m->file = whole;
    edit_data(&m->file, "cells", 0, &bad, sizeof bad); /* of a in itself: ignored */
    save_file(file_of(m), m->file.bytes, m->file.size);
    vdna_map_trust trust;
    assert_int_equal(open_trust(m, RUNS, NULL, &trust), VDNA_OK);
    vdna_map_trust_close(&trust);
}

static void what_breaks_a_rule_is_not_written(void **state)
{
    map *m = *state;
    const map good = *m;
    m->trust.tolerance = NAN;
    assert_not_written(m, VDNA_ERR_ARG, "not written: tolerance is");
    m->trust.tolerance = -0.5;
    assert_not_written(m, VDNA_ERR_ARG, "not written: tolerance is -0.5");
    m->trust = good.trust;
    m->own_scale[1] = 3;
    assert_not_written(m, VDNA_ERR_NONFINITE, "a number of the tables is beyond its range");
    m->own_scale[1] = 1;
    m->frames[2] = 3;
    assert_not_written(m, VDNA_ERR_MISMATCH, "experience c has 2 frames, its tables are of 3");
    m->frames[2] = 2;
    m->experiences[2].comparable[3] ^= 1;
    assert_not_written(m, VDNA_ERR_MISMATCH, "experiences a and c do not compare");
    m->experiences[2] = m->experiences[1];
    assert_not_written(m, VDNA_ERR_MISMATCH, "two members are called b");
    m->experiences[2].file_bytes = NULL;
    assert_not_written(m, VDNA_ERR_ARG, "experience b is not from a file");
    m->experiences[2] = good.experiences[2];
}

static void arguments_that_break_a_rule_are_refused(void **state)
{
    map *m = *state;
    const char *path = m->file.directory.path;
    vdna_map_trust trust;
    const vdna_experience *e = m->experiences;
    assert_int_equal(vdna_map_trust_open(NULL, e, 1, NULL, &trust), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_open(path, NULL, 1, NULL, &trust), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_open(path, e, 0, NULL, &trust), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_open(path, e, VDNA_TRUST_RUNS_MAX + 1, NULL, &trust),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_open(path, e, 1, NULL, NULL), VDNA_ERR_ARG);

    assert_int_equal(vdna_map_trust_write(NULL, e, &m->trust, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_write(path, NULL, &m->trust, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_trust_write(path, e, NULL, NULL), VDNA_ERR_ARG);
    vdna_map_trust bad[] = {m->trust, m->trust, m->trust, m->trust};
    bad[0].runs = 0;
    bad[1].runs = VDNA_TRUST_RUNS_MAX + 1;
    bad[2].localiser = VDNA_TRUST_EUCLIDEAN + 1;
    bad[3].tables.frames = NULL;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(vdna_map_trust_write(path, e, &bad[i], NULL), VDNA_ERR_ARG);
    bad[0] = m->trust;
    bad[0].tables.cells = NULL;
    assert_int_equal(vdna_map_trust_write(path, e, &bad[0], NULL), VDNA_ERR_ARG);
}

static void a_place_that_the_system_refuses_is_named(void **state)
{
    const map *m = *state;
    vdna_error error = {""};
    vdna_map_trust trust;
    char endless[5000];
    memset(endless, 'x', sizeof endless - 1);
    endless[sizeof endless - 1] = '\0';
    assert_int_equal(vdna_map_trust_open(endless, m->experiences, 1, &error, &trust), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "the path is too long"));
    assert_int_equal(vdna_map_trust_write(endless, m->experiences, &m->trust, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "the path is too long"));

    const char *no_directory = path_in(&m->file.directory, "a.vdna");
    assert_int_equal(vdna_map_trust_open(no_directory, m->experiences, 1, &error, &trust),
                     VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "cannot open"));
    assert_int_equal(vdna_map_trust_write(no_directory, m->experiences, &m->trust, &error),
                     VDNA_ERR_IO);

    unlink(file_of(m));
    assert_int_equal(mkdir(file_of(m), 0700), 0);
    assert_int_equal(open_trust(m, RUNS, &error, &trust), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, VDNA_MAP_TRUST_FILE ": not a regular file"));
    assert_int_equal(rmdir(file_of(m)), 0);
}

static void without_memory_or_space_nothing_happens(void **state)
{
    const map *m = *state;
    vdna_error error = {""};
    vdna_map_trust trust;
    refuse("calloc", 0, ENOMEM);
    assert_int_equal(open_trust(m, RUNS, &error, &trust), VDNA_ERR_NOMEM);
    assert_true(was_refused());
    assert_non_null(strstr(error.text, "no memory left for the tables of 3 experiences"));
    refuse("write", 1, ENOSPC);
    assert_not_written(m, VDNA_ERR_IO, "cannot write: No space left");
    assert_true(was_refused());
    for (int calls = 0; calls < 2; calls++) {
        refuse("calloc", calls, ENOMEM);
        assert_not_written(m, VDNA_ERR_NOMEM, "no memory left");
        assert_true(was_refused());
    }
}

static void a_call_that_is_refused_leaves_the_old_file_or_the_new_one(void **state)
{
    map *m = *state;
    int came_to_it = 1, refused = 0;
    for (int calls = 0; came_to_it; calls++) {
        m->trust.tolerance = 100 + calls;
        refuse(NULL, calls, EIO);
        const vdna_status status =
            vdna_map_trust_write(m->file.directory.path, m->experiences, &m->trust, NULL);
        came_to_it = was_refused();
        refused += status != VDNA_OK;
        vdna_map_trust trust;
        assert_int_equal(open_trust(m, RUNS, NULL, &trust), VDNA_OK);
        assert_true(trust.tolerance == 100 + calls || status != VDNA_OK);
        vdna_map_trust_close(&trust);
    }
    assert_true(refused > 3);
}

static void what_a_killed_writer_leaves_is_removed_by_the_next_update(void **state)
{
    const map *m = *state;
    const char *left = path_in(&m->file.directory, VDNA_MAP_TRUST_FILE ".0.partial");
    save_file(left, "half", 4);
    vdna_map_update *update = NULL;
    assert_int_equal(vdna_map_update_open(m->file.directory.path, NULL, &update), VDNA_OK);
    vdna_map_update_close(update);
    assert_int_equal(access(left, F_OK), -1);
    assert_int_equal(access(file_of(m), F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_written_is_read_back, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_runs_are_those_asked_for_in_their_order, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(a_map_of_one_experience_has_such_a_file_too, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(it_is_no_experience_of_the_map, set_up, tear_down),
        cmocka_unit_test_setup_teardown(without_a_file_the_map_knows_nothing_and_the_remedy_is_said,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(an_experience_that_was_replaced_is_named, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(the_experiences_that_it_still_knows_are_told_apart, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(a_file_of_another_map_is_told_apart, set_up, tear_down),
        cmocka_unit_test_setup_teardown(any_damaged_byte_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_file_cut_at_any_length_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_newer_format_version_is_unsupported, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_header_that_breaks_a_rule_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(numbers_that_break_a_rule_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_breaks_a_rule_is_not_written, set_up, tear_down),
        cmocka_unit_test_setup_teardown(arguments_that_break_a_rule_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_place_that_the_system_refuses_is_named, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(without_memory_or_space_nothing_happens, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_call_that_is_refused_leaves_the_old_file_or_the_new_one,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_a_killed_writer_leaves_is_removed_by_the_next_update,
                                        set_up, tear_down),
    };
    return cmocka_run_group_tests_name("map_trust", tests, NULL, NULL);
}
