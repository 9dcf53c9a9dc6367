/* A map is a directory: its experiences in order, under different names, comparable. */
#define _POSIX_C_SOURCE 200809L
#include "map_files.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/stat.h>

#include <cmocka.h>

static void write_as(const directory *made, const char *file, const char *name, vdna_experience e)
{
    strcpy(e.name, name);
    assert_int_equal(vdna_experience_write(&e, path_in(made, file), NULL), VDNA_OK);
}

static void assert_map_refused(const directory *made, vdna_status expected, const char *reason)
{
    vdna_experience map[4] = {{.file_bytes = NULL}};
    vdna_error error = {""};
    uint32_t count = 77;
    assert_int_equal(vdna_map_open(made->path, 4, &error, map, &count), expected);
    assert_int_equal(count, 77);
    for (size_t i = 0; i < 4; i++)
        assert_null(map[i].file_bytes);
    if (!strstr(error.text, reason) || !strstr(error.text, made->path))
        fail_msg("expected the directory and \"%s\" in: %s", reason, error.text);
}

static void experiences_come_in_the_byte_order_of_their_files(void **state)
{
    const directory *made = *state;
    const vdna_experience sample = sample_experience();
    write_as(made, "b.vdna", "second", sample);
    write_as(made, "a.vdna", "last", sample);
    write_as(made, "B.vdna", "first", sample);
    save_file(path_in(made, "README.txt"), "x", 1);
    save_file(path_in(made, ".hidden.vdna"), "x", 1);
    save_file(path_in(made, ".vdna"), "x", 1);
    save_file(path_in(made, "c.vdna.0.partial"), "x", 1);

    vdna_experience map[3];
    uint32_t count = 0;
    assert_int_equal(vdna_map_count(made->path, NULL, &count), VDNA_OK);
    assert_int_equal(count, 3);
    count = 0;
    assert_int_equal(vdna_map_open(made->path, 3, NULL, map, &count), VDNA_OK);
    assert_int_equal(count, 3);
    assert_string_equal(map[0].name, "first");
    assert_string_equal(map[1].name, "last");
    assert_string_equal(map[2].name, "second");
    for (size_t i = 0; i < 3; i++)
        vdna_experience_close(&map[i]);
}

static void an_empty_or_missing_directory_is_refused(void **state)
{
    const directory *made = *state;
    vdna_error error;
    uint32_t count;
    assert_map_refused(made, VDNA_ERR_EMPTY, "no file ends in .vdna");
    assert_int_equal(vdna_map_count(made->path, NULL, &count), VDNA_OK);
    assert_int_equal(count, 0);
    assert_int_equal(vdna_map_count(path_in(made, "none"), &error, &count), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "none: cannot read the directory: No such file"));
    assert_int_equal(vdna_map_count(NULL, &error, &count), VDNA_ERR_ARG);
    vdna_experience map[1];
    assert_int_equal(vdna_map_open(path_in(made, "none"), 1, &error, map, &count), VDNA_ERR_IO);
    assert_int_equal(vdna_map_open(made->path, 1, &error, NULL, &count), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_open(made->path, 1, &error, map, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_open(NULL, 1, &error, map, &count), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_count(made->path, &error, NULL), VDNA_ERR_ARG);
}

static void a_file_whose_path_is_too_long_is_named(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    vdna_error error;
    uint32_t count;
    char path[4090];
    write_as(made, "winter.vdna", "winter", sample_experience());
    strcpy(path, made->path);
    while (strlen(path) + 2 < sizeof path)
        strcat(path, "/.");
    assert_int_equal(vdna_map_count(path, NULL, &count), VDNA_OK);
    assert_int_equal(count, 1);
    assert_int_equal(vdna_map_open(path, 1, &error, map, &count), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, made->path));
}

static void more_experiences_than_there_is_room_for_are_refused(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    uint32_t count;
    write_as(made, "a.vdna", "a", sample_experience());
    write_as(made, "b.vdna", "b", sample_experience());
    assert_int_equal(vdna_map_open(made->path, 1, NULL, map, &count), VDNA_ERR_NOMEM);
}

static void two_experiences_of_one_name_are_refused(void **state)
{
    const directory *made = *state;
    write_as(made, "a.vdna", "winter", sample_experience());
    write_as(made, "b.vdna", "spring", sample_experience());
    write_as(made, "c.vdna", "winter", sample_experience());
    assert_map_refused(made, VDNA_ERR_MISMATCH, "a.vdna and c.vdna are both named winter");
}

static void one_bad_file_refuses_the_map_and_is_named(void **state)
{
    const directory *made = *state;
    write_as(made, "a.vdna", "winter", sample_experience());
    save_file(path_in(made, "b.vdna"), "not an experience", 17);
    assert_map_refused(made, VDNA_ERR_FORMAT, "/b.vdna: the header claims");
    assert_int_equal(unlink(path_in(made, "b.vdna")), 0);
    assert_int_equal(mkdir(path_in(made, "b.vdna"), 0700), 0);
    assert_map_refused(made, VDNA_ERR_IO, "/b.vdna: not a regular file");
}

static void an_experience_that_does_not_compare_refuses_the_map(void **state)
{
    const directory *made = *state;
    vdna_experience other = sample_experience();
    strcpy(other.identity.preprocessing, "bgr 8x8");
    write_as(made, "a.vdna", "winter", sample_experience());
    write_as(made, "b.vdna", "summer", other);
    assert_map_refused(made, VDNA_ERR_MISMATCH,
                       "winter and summer do not compare: preprocessing is rgb");
}

static void a_comparison_names_the_first_field_that_differs(void **state)
{
    (void)state;
    const vdna_experience sample = sample_experience();
    const float range[6] = {-1, 1, 0, 6, -2.5f, 2.75f};
    struct {
        vdna_experience other;
        const char *reason;
    } cases[] = {
        {sample, "model_sha256 is " SAMPLE_SHA256 " in one"},
        {sample, "precision is fp32 in one and int8 in the other"},
        {sample, "preprocessing is "},
        {sample, "taps is mid:2:4,top:1:1 in one and top:3:1 in the other"},
        {sample, "neurons is 3 in one and 2 in"},
        {sample, "dim is 5 in one and 4 in"},
        {sample, "bins is 4 in one and 8 in"},
        {sample, "range of neuron 2 is -2.5..2.5 in one and -2.5..2.75 in"},
    };
    cases[0].other.identity.model_sha256[5] = cases[1].other.identity.model_sha256[5] = '0';
    strcpy(cases[1].other.identity.precision, "int8");
    strcpy(cases[2].other.identity.preprocessing, "other");
    strcpy(cases[3].other.identity.taps, "top:3:1");
    cases[4].other.identity.neurons = 2;
    cases[5].other.identity.dim = 4;
    cases[6].other.identity.bins = 8;
    cases[7].other.identity.range = range;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        assert_int_equal(vdna_experience_compare(&sample, &cases[i].other, &error),
                         VDNA_ERR_MISMATCH);
        if (!strstr(error.text, cases[i].reason) || !strstr(error.text, "vdna build"))
            fail_msg("expected \"%s\" in: %s", cases[i].reason, error.text);
    }
    vdna_error error = {""};
    assert_int_equal(vdna_experience_compare(&cases[1].other, &sample, &error), VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "precision is int8 in one and fp32 in the other"));
    assert_int_equal(vdna_experience_compare(&sample, NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_compare(NULL, &sample, NULL), VDNA_ERR_ARG);
}

static void names_lengths_and_labels_may_differ(void **state)
{
    (void)state;
    const vdna_experience sample = sample_experience();
    vdna_experience other = sample;
    strcpy(other.name, "summer");
    strcpy(other.identity.backbone, "the-same-network-renamed");
    other.frames = 1;
    other.frame_place = NULL;
    assert_int_equal(vdna_experience_compare(&sample, &other, NULL), VDNA_OK);
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(experiences_come_in_the_byte_order_of_their_files),
        CASE(an_empty_or_missing_directory_is_refused),
        CASE(a_file_whose_path_is_too_long_is_named),
        CASE(more_experiences_than_there_is_room_for_are_refused),
        CASE(two_experiences_of_one_name_are_refused),
        CASE(one_bad_file_refuses_the_map_and_is_named),
        CASE(an_experience_that_does_not_compare_refuses_the_map),
        cmocka_unit_test(a_comparison_names_the_first_field_that_differs),
        cmocka_unit_test(names_lengths_and_labels_may_differ),
    };
    return cmocka_run_group_tests_name("map_directory", tests, NULL, NULL);
}
