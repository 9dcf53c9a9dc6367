/* A map is a directory: its experiences in order, under different names, comparable. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "cmocka_all.h"
#include "edited_file.h"
#include "journal.h"
#include "map_files.h"
#include "watched_calls.h"

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

/* What is left out of a map that is opened. */
typedef struct left_out {
    unsigned count;
    char reasons[4][512];
} left_out;

static void note(void *context, const char *reason)
{
    left_out *noted = context;
    assert_in_range(noted->count, 0, 3);
    snprintf(noted->reasons[noted->count++], sizeof *noted->reasons, "%s", reason);
}

static vdna_map_config config_of(uint32_t copy, left_out *noted)
{
    vdna_map_config config;
    vdna_map_config_init(&config);
    config.copy = copy;
    if (noted)
        config.left_out = note;
    config.context = noted;
    return config;
}

static void one_bad_file_is_left_out_and_named_if_wanted(void **state)
{
    const directory *made = *state;
    vdna_experience map[5];
    uint32_t count = 0;
    left_out noted = {.count = 0};
    const vdna_map_config config = config_of(0, &noted);
    save_file(path_in(made, "a.vdna"), "not an experience", 17);
    write_as(made, "b.vdna", "winter", sample_experience());
    assert_int_equal(mkdir(path_in(made, "c.vdna"), 0700), 0);
    write_as(made, "d.vdna", "spring", sample_experience());
    write_as(made, "e.vdna", "summer", sample_experience());
    unsigned char bytes[4096];
    const size_t size = load_file(path_in(made, "e.vdna"), bytes, sizeof bytes);
    bytes[size - 1] ^= 1;
    save_file(path_in(made, "e.vdna"), bytes, size);

    assert_int_equal(vdna_map_open_as(&config, made->path, 5, NULL, map, &count), VDNA_OK);
    assert_int_equal(count, 2);
    assert_string_equal(map[0].name, "winter");
    assert_string_equal(map[1].name, "spring");
    vdna_experience_close(&map[0]);
    vdna_experience_close(&map[1]);
    assert_int_equal(noted.count, 3);
    assert_non_null(strstr(noted.reasons[0], "/a.vdna: the header claims"));
    assert_non_null(strstr(noted.reasons[1], "/c.vdna: not a regular file"));
    assert_non_null(strstr(noted.reasons[2], "/e.vdna: the bytes have CRC-32C"));
}

static void a_map_of_bad_files_alone_is_refused_for_the_first(void **state)
{
    const directory *made = *state;
    vdna_experience map[2];
    vdna_error error = {""};
    uint32_t count = 77;
    left_out noted = {.count = 0};
    const vdna_map_config config = config_of(0, &noted);
    save_file(path_in(made, "a.vdna"), "not an experience", 17);
    save_file(path_in(made, "b.vdna"), "", 0);
    assert_int_equal(vdna_map_open_as(&config, made->path, 2, &error, map, &count),
                     VDNA_ERR_FORMAT);
    assert_non_null(strstr(error.text, "/a.vdna: the header claims"));
    assert_int_equal(count, 77);
    assert_int_equal(noted.count, 0);
}

/* Two of one name, and two that do not compare, are a mistake in a map, not damage. */
static void what_is_not_damage_refuses_the_map_all_the_same(void **state)
{
    const directory *made = *state;
    vdna_experience map[4], other = sample_experience();
    vdna_error error = {""};
    uint32_t count = 77;
    left_out noted = {.count = 0};
    const vdna_map_config config = config_of(0, &noted);
    save_file(path_in(made, "a.vdna"), "not an experience", 17);
    write_as(made, "b.vdna", "winter", sample_experience());
    save_file(path_in(made, "c.vdna"), "not an experience", 17);
    write_as(made, "d.vdna", "winter", sample_experience());
    assert_int_equal(vdna_map_open_as(&config, made->path, 4, &error, map, &count),
                     VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "b.vdna and d.vdna are both named winter"));
    strcpy(other.identity.preprocessing, "bgr 8x8");
    write_as(made, "d.vdna", "summer", other);
    assert_int_equal(vdna_map_open_as(&config, made->path, 4, &error, map, &count),
                     VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "winter and summer do not compare"));
    assert_int_equal(noted.count, 0);
}

static void a_config_that_says_nothing_of_ours_is_refused(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    vdna_error error = {""};
    uint32_t count = 77;
    vdna_map_config config = config_of(2, NULL);
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, map, &count), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "copy or no_thumbnails is neither 0 nor 1"));
    config = config_of(0, NULL);
    config.no_thumbnails = 2;
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, map, &count), VDNA_ERR_ARG);
    config = config_of(0, NULL);
    config.struct_size++;
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, map, &count), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_open_as(NULL, made->path, 1, &error, map, &count), VDNA_ERR_ARG);
}

/* In place: the same file with other bytes, another length, or none. */
static void a_copy_stays_when_its_file_is_changed_in_place(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    uint32_t count = 0;
    const vdna_map_config config = config_of(1, NULL);
    const char *path = path_in(made, "a.vdna");
    write_as(made, "a.vdna", "winter", coded_experience());
    unsigned char before[4096];
    const size_t size = load_file(path, before, sizeof before);
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, NULL, map, &count), VDNA_OK);
    FILE *file = fopen(path, "r+b");
    assert_true(file && fputs("other bytes", file) > 0 && fclose(file) == 0);
    assert_memory_equal(map[0].file_bytes, before, size);
    assert_int_equal(truncate(path, 0), 0);
    assert_int_equal(map[0].file_size, size);
    assert_memory_equal(map[0].file_bytes, before, size);
    vdna_experience_close(&map[0]);
}

/* Open the only file of a map without its thumbnails, and check that nothing else is missing.
 * @param size  of the file
 * @return bytes held of it */
static size_t open_without_thumbnails(const directory *made, uint32_t copy, size_t size)
{
    vdna_experience map[1];
    uint32_t count = 0;
    vdna_map_config config = config_of(copy, NULL);
    config.no_thumbnails = 1;
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, NULL, map, &count), VDNA_OK);
    assert_true(!map[0].thumbnails && !map[0].thumbnail_end && map[0].thumbnail_bytes == 0);
    const vdna_experience sample = sample_experience();
    assert_memory_equal(map[0].embeddings, sample.embeddings, 2 * 5 * sizeof(float));
    assert_memory_equal(map[0].frame_grey, sample.frame_grey, 2 * sizeof(float));
    const size_t held = map[0].file_size, page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t kept = (held + page - 1) / page * page;
    const uintptr_t end = (uintptr_t)map[0].file_bytes + kept;
    if (kept < size) /* nothing is mapped there any more */
        assert_true(msync((void *)end, page, MS_ASYNC) != 0 && errno == ENOMEM);
    vdna_experience_close(&map[0]);
    return held;
}

static void thumbnails_are_held_by_no_memory_if_nobody_wants_them(void **state)
{
    const directory *made = *state;
    static const uint8_t thumbnails[2 * VDNA_THUMBNAIL_MAX];
    static const uint32_t end[2] = {VDNA_THUMBNAIL_MAX, 2 * VDNA_THUMBNAIL_MAX};
    static unsigned char bytes[4 * VDNA_THUMBNAIL_MAX];
    vdna_experience large = pictured_experience();
    large.thumbnails = thumbnails;
    large.thumbnail_end = end;
    large.thumbnail_bytes = sizeof thumbnails;
    write_as(made, "a.vdna", "winter", large);
    const size_t size = load_file(path_in(made, "a.vdna"), bytes, sizeof bytes);
    for (uint32_t copy = 0; copy < 2; copy++)
        assert_int_equal(open_without_thumbnails(made, copy, size), size - sizeof thumbnails - 4);

    /* Thumbnails of a few bytes are on a page with the rest. */
    write_as(made, "a.vdna", "winter", pictured_experience());
    const size_t small = load_file(path_in(made, "a.vdna"), bytes, sizeof bytes);
    assert_int_equal(open_without_thumbnails(made, 1, small), small - 8 - 4);

    /* Another order of the tensors: the last one in use counts. */
    edited_file f = {.directory = *made};
    f.size = load_file(path_in(made, "a.vdna"), f.bytes, sizeof f.bytes);
    edit_header(&f, "frame_utime", "acme");
    edit_header(&f, "frame_place", "frame_utime");
    edit_header(&f, "acme", "frame_place");
    save_file(path_in(made, "a.vdna"), f.bytes, f.size);
    assert_int_equal(open_without_thumbnails(made, 1, f.size), f.size - 8 - 4);

    /* A file without any is held as it is. */
    write_as(made, "a.vdna", "winter", sample_experience());
    const size_t plain = load_file(path_in(made, "a.vdna"), bytes, sizeof bytes);
    assert_int_equal(open_without_thumbnails(made, 1, plain), plain);
}

static const char *cut_short;

static int cut_at_the_second_read(const char *function)
{
    static int reads;
    if (strcmp(function, "read") == 0 && reads++ == 0)
        assert_int_equal(truncate(cut_short, 100), 0);
    return 0;
}

static void a_file_cut_short_while_it_is_copied_is_damaged(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    vdna_error error = {""};
    uint32_t count = 77;
    const vdna_map_config config = config_of(1, NULL);
    write_as(made, "a.vdna", "winter", sample_experience());
    cut_short = path_in(made, "a.vdna");
    watch = cut_at_the_second_read;
    const vdna_status status = vdna_map_open_as(&config, made->path, 1, &error, map, &count);
    watch = NULL;
    assert_true(status == VDNA_ERR_FORMAT || status == VDNA_ERR_CHECKSUM);
    assert_non_null(strstr(error.text, "/a.vdna: "));
}

static void a_copy_that_cannot_be_made_is_named(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    vdna_error error = {""};
    uint32_t count = 77;
    const vdna_map_config config = config_of(1, NULL);
    write_as(made, "a.vdna", "winter", sample_experience());
    refuse("read", 0, EIO);
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, map, &count), VDNA_ERR_IO);
    assert_true(was_refused());
    assert_non_null(strstr(error.text, "/a.vdna: cannot read: Input/output error"));
    refuse("read", 0, EINTR);
    assert_int_equal(vdna_map_open_as(&config, made->path, 1, &error, map, &count), VDNA_OK);
    assert_true(was_refused());
    vdna_experience_close(&map[0]);
}

/* Neither what has to be decoded nor a reason for leaving something out. */
static void without_memory_a_map_is_refused_and_nothing_left_out(void **state)
{
    const directory *made = *state;
    vdna_experience map[2];
    vdna_error error = {""};
    left_out noted = {.count = 0};
    const vdna_map_config config = config_of(0, &noted);
    write_as(made, "a.vdna", "winter", coded_experience());
    save_file(path_in(made, "b.vdna"), "not an experience", 17);
    uint32_t count = 77, refused = 0;
    for (int calls = 0, was = 1; was; calls++) {
        refuse("malloc", calls, ENOMEM);
        const vdna_status status = vdna_map_open_as(&config, made->path, 2, &error, map, &count);
        was = was_refused();
        refused += status == VDNA_ERR_NOMEM;
        assert_true(status == VDNA_OK || status == VDNA_ERR_NOMEM);
        if (status == VDNA_OK)
            vdna_experience_close(&map[0]);
    }
    assert_true(refused > 1);
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
        {sample, "embedding is one whole output in one and mid grid=1x5 in the other"},
        {sample, "dim is 5 in one and 4 in"},
        {sample, "bins is 4 in one and 8 in"},
        {sample, "range of neuron 2 is -2.5..2.5 in one and -2.5..2.75 in"},
    };
    cases[0].other.identity.model_sha256[5] = cases[1].other.identity.model_sha256[5] = '0';
    strcpy(cases[1].other.identity.precision, "int8");
    strcpy(cases[2].other.identity.preprocessing, "other");
    strcpy(cases[3].other.identity.taps, "top:3:1");
    cases[4].other.identity.neurons = 2;
    strcpy(cases[5].other.identity.embedding, "mid grid=1x5");
    cases[6].other.identity.dim = 4;
    cases[7].other.identity.bins = 8;
    cases[8].other.identity.range = range;
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

static void assert_listed(const directory *made, const char *const (*expected)[2], uint32_t count)
{
    vdna_map_file files[8];
    uint32_t found = 0;
    assert_int_equal(vdna_map_count(made->path, NULL, &found), VDNA_OK);
    assert_int_equal(found, count);
    found = 77;
    assert_int_equal(vdna_map_list(made->path, count, NULL, files, &found), VDNA_OK);
    assert_int_equal(found, count);
    for (uint32_t i = 0; i < count; i++) {
        assert_string_equal(files[i].name, expected[i][0]);
        assert_string_equal(files[i].file, expected[i][1]);
    }
}

static void files_are_listed_in_the_byte_order_of_their_names(void **state)
{
    static const char *const expected[][2] = {
        {"B.vdna", "B.vdna"}, {"a.vdna", "a.vdna"}, {"b.vdna", "b.vdna"}};
    const directory *made = *state;
    assert_listed(made, NULL, 0);
    save_file(path_in(made, "b.vdna"), "need not be valid", 17);
    save_file(path_in(made, "a.vdna"), "x", 1);
    save_file(path_in(made, "B.vdna"), "x", 1);
    save_file(path_in(made, "c.vdna.0.partial"), "x", 1);
    save_file(path_in(made, "c.vdna.staged"), "x", 1);
    assert_listed(made, expected, 3);
}

static void a_list_without_a_place_is_refused(void **state)
{
    const directory *made = *state;
    vdna_map_file files[1];
    vdna_error error;
    uint32_t count = 77;
    save_file(path_in(made, "a.vdna"), "x", 1);
    save_file(path_in(made, "b.vdna"), "x", 1);
    assert_int_equal(vdna_map_list(NULL, 1, NULL, files, &count), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_list(made->path, 1, NULL, NULL, &count), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_list(made->path, 1, NULL, files, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_list(made->path, 1, &error, files, &count), VDNA_ERR_NOMEM);
    assert_non_null(strstr(error.text, "2 experiences, expected at most 1"));
    assert_int_equal(vdna_map_list(made->path, 0, NULL, NULL, &count), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_map_list(path_in(made, "none"), 1, NULL, files, &count), VDNA_ERR_IO);
    assert_int_equal(count, 77);
}

/* Write the journal of an update of some experiences that was interrupted. */
static void interrupt(const directory *made, const char *const *names, size_t count)
{
    vdna_journal journal = {NULL, 0};
    const int place = open(made->path, O_RDONLY | O_DIRECTORY);
    for (size_t i = 0; i < count; i++)
        assert_true(vdna_journal_add(&journal, names[i]));
    assert_int_equal(vdna_journal_write(place, made->path, &journal, NULL), VDNA_OK);
    vdna_journal_free(&journal);
    close(place);
}

static void an_interrupted_update_is_read_in_all_its_states(void **state)
{
    static const char *const expected[][2] = {{"night.vdna", "night.vdna.staged"},
                                              {"spring.vdna", "spring.vdna"},
                                              {"summer.vdna", "summer.vdna"},
                                              {"winter.vdna", "winter.vdna.staged"}};
    static const char *const names[] = {"night", "summer", "winter"};
    const directory *made = *state;
    const vdna_experience sample = sample_experience();
    write_as(made, "spring.vdna", "spring", sample); /* not updated */
    write_as(made, "summer.vdna", "summer", sample); /* renamed */
    write_as(made, "winter.vdna", "old", sample);    /* to be replaced */
    write_as(made, "winter.vdna.staged", "winter", sample);
    write_as(made, "night.vdna.staged", "night", sample);   /* new, to be renamed */
    write_as(made, "autumn.vdna.staged", "autumn", sample); /* not final */
    interrupt(made, names, 3);
    assert_listed(made, expected, 4);

    static const char *const opened[] = {"night", "spring", "summer", "winter"};
    vdna_experience map[4];
    uint32_t count = 0;
    assert_int_equal(vdna_map_open(made->path, 4, NULL, map, &count), VDNA_OK);
    assert_int_equal(count, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(map[i].name, opened[i]);
        vdna_experience_close(&map[i]);
    }
}

static void an_interrupted_update_may_be_all_of_a_map(void **state)
{
    static const char *const expected[][2] = {{"night.vdna", "night.vdna.staged"}};
    static const char *const names[] = {"night"};
    const directory *made = *state;
    write_as(made, "night.vdna.staged", "night", sample_experience());
    interrupt(made, names, 1);
    assert_listed(made, expected, 1);
}

static void an_experience_of_an_interrupted_update_that_is_gone_is_named(void **state)
{
    static const char *const names[] = {"night"};
    const directory *made = *state;
    interrupt(made, names, 1);
    assert_map_refused(made, VDNA_ERR_IO, "night.vdna.staged: cannot open: No such file");
}

static void a_damaged_staged_file_is_named(void **state)
{
    static const char *const names[] = {"night"};
    const directory *made = *state;
    save_file(path_in(made, "night.vdna.staged"), "not an experience", 17);
    interrupt(made, names, 1);
    assert_map_refused(made, VDNA_ERR_FORMAT, "/night.vdna.staged: the header claims");
}

static void a_link_to_an_experience_is_one_and_a_broken_one_is_named(void **state)
{
    const directory *made = *state;
    write_as(made, "elsewhere", "winter", sample_experience());
    assert_int_equal(symlink("elsewhere", path_in(made, "winter.vdna")), 0);
    vdna_experience map[1];
    uint32_t count = 0;
    assert_int_equal(vdna_map_open(made->path, 1, NULL, map, &count), VDNA_OK);
    assert_int_equal(count, 1);
    vdna_experience_close(&map[0]);
    assert_int_equal(unlink(path_in(made, "elsewhere")), 0);
    assert_map_refused(made, VDNA_ERR_IO, "/winter.vdna: cannot open: No such file");
}

/* Replaced as another tool does it: by a rename, without an update. */
static struct {
    const directory *made;
    const char *from, *to;
    int reads_left;
} replacement;

static int replace_later(const char *function)
{
    if (strcmp(function, "openat") == 0 && replacement.reads_left-- == 0)
        assert_int_equal(rename(replacement.from, replacement.to), 0);
    return 0;
}

static void a_file_that_another_tool_replaces_meanwhile_is_read_again(void **state)
{
    const directory *made = *state;
    /* A reader's calls of openat(): the journal, both experiences, the journal. */
    for (int reads = 0; reads < 4; reads++) {
        vdna_experience map[2];
        uint32_t count = 0;
        write_as(made, "a.vdna", "a", sample_experience());
        write_as(made, "b.vdna", "old", sample_experience());
        write_as(made, "new", "new", sample_experience());
        replacement.from = path_in(made, "new");
        replacement.to = path_in(made, "b.vdna");
        replacement.reads_left = reads;
        watch = replace_later;
        assert_int_equal(vdna_map_open(made->path, 2, NULL, map, &count), VDNA_OK);
        watch = NULL;
        assert_true(replacement.reads_left < 0);
        assert_string_equal(map[1].name, "new");
        for (uint32_t i = 0; i < count; i++)
            vdna_experience_close(&map[i]);
    }
}

/* A reader lists one file and opens another; then the first is there again. */
static int come_and_go(const char *function)
{
    if (strcmp(function, "openat") == 0 && --replacement.reads_left == 2)
        assert_int_equal(rename(replacement.from, replacement.to), 0);
    else if (strcmp(function, "openat") == 0 && replacement.reads_left == 1)
        assert_int_equal(rename(path_in(replacement.made, "kept"), replacement.to), 0);
    return 0;
}

static void a_file_that_was_there_for_a_moment_is_not_part_of_the_map(void **state)
{
    const directory *made = *state;
    vdna_experience map[1];
    uint32_t count;
    write_as(made, "a.vdna", "old", sample_experience());
    write_as(made, "new", "new", sample_experience());
    replacement.made = made;
    replacement.from = path_in(made, "new");
    replacement.to = path_in(made, "a.vdna");
    replacement.reads_left = 4;
    assert_int_equal(link(replacement.to, path_in(made, "kept")), 0);
    watch = come_and_go;
    assert_int_equal(vdna_map_open(made->path, 1, NULL, map, &count), VDNA_OK);
    watch = NULL;
    assert_true(replacement.reads_left < 1);
    assert_string_equal(map[0].name, "old");
    vdna_experience_close(&map[0]);
}

static unsigned opened_before_a_close;

static int count_opened(const char *function)
{
    static unsigned opened;
    opened = strcmp(function, "opendir") == 0 ? 0 : opened + (strcmp(function, "openat") == 0);
    if (strcmp(function, "munmap") == 0 && opened_before_a_close == 0)
        opened_before_a_close = opened;
    return 0;
}

/* A file system may give a new file the number of one that is gone, and ext4 does so after a while:
 * then a reader would take it for what it had opened. */
static void files_stay_open_until_the_map_is_listed_again(void **state)
{
    const directory *made = *state;
    vdna_experience other = sample_experience();
    strcpy(other.identity.preprocessing, "other");
    write_as(made, "a.vdna", "a", sample_experience());
    write_as(made, "b.vdna", "b", other);
    opened_before_a_close = 0;
    watch = count_opened;
    assert_map_refused(made, VDNA_ERR_MISMATCH, "a and b do not compare");
    watch = NULL;
    assert_int_equal(opened_before_a_close, 4); /* journal, a, b, journal */
}

/* Another update becomes final, and is interrupted, between two listings. */
static int interrupt_again(const char *function)
{
    static const char *const names[] = {"winter"};
    if (strcmp(function, "openat") == 0 && replacement.reads_left-- == 0)
        interrupt(replacement.made, names, 1);
    return 0;
}

static void a_journal_that_another_one_replaces_meanwhile_is_read_again(void **state)
{
    static const char *const names[] = {"night"};
    const directory *made = *state;
    vdna_map_file files[2];
    uint32_t count = 0;
    save_file(path_in(made, "night.vdna"), "x", 1);
    save_file(path_in(made, "winter.vdna"), "x", 1);
    save_file(path_in(made, "winter.vdna.staged"), "x", 1);
    interrupt(made, names, 1);
    replacement.made = made;
    replacement.reads_left = 1;
    watch = interrupt_again;
    assert_int_equal(vdna_map_list(made->path, 2, NULL, files, &count), VDNA_OK);
    watch = NULL;
    assert_true(replacement.reads_left < -1); /* two listings more */
    assert_string_equal(files[1].file, "winter.vdna.staged");
}

static void a_call_that_is_refused_while_a_map_is_read_is_an_error(void **state)
{
    static const refused_call cases[] = {
        {"opendir", EACCES, VDNA_ERR_IO, ": cannot read the directory: Permission denied"},
        {"readdir", EIO, VDNA_ERR_IO, ": cannot read the directory: Input/output error"},
        {"openat", EMFILE, VDNA_ERR_IO, ": cannot open: Too many open files"},
        {"fstat", EIO, VDNA_ERR_IO, ": cannot examine: Input/output error"},
        {"malloc", ENOMEM, VDNA_ERR_NOMEM, "no memory"},
        {"realloc", ENOMEM, VDNA_ERR_NOMEM, "no memory left"},
    };
    static const char *const names[] = {"night"};
    const directory *made = *state;
    /* Files of codes take memory besides their pages. */
    write_as(made, "a.vdna", "a", coded_experience());
    write_as(made, "b.vdna", "b", coded_experience());
    write_as(made, "night.vdna.staged", "night", coded_experience());
    interrupt(made, names, 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned errors = 0;
        for (int calls = 0, was = 1; was; calls++) {
            vdna_experience map[3] = {{.file_bytes = NULL}};
            vdna_error error = {""};
            uint32_t count = 77;
            refuse(cases[i].call, calls, cases[i].refusal);
            const vdna_status status = vdna_map_open(made->path, 3, &error, map, &count);
            was = was_refused();
            if (status != VDNA_OK) {
                assert_int_equal(status, cases[i].expected);
                assert_non_null(strstr(error.text, cases[i].reason));
                assert_non_null(strstr(error.text, made->path));
                assert_int_equal(count, 77);
                errors++;
            }
            for (size_t e = 0; e < 3; e++) {
                assert_int_equal(map[e].file_bytes != NULL, status == VDNA_OK);
                vdna_experience_close(&map[e]);
            }
            assert_in_range(calls, 0, 200);
        }
        assert_true(errors > 0);
    }
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
        CASE(one_bad_file_is_left_out_and_named_if_wanted),
        CASE(a_map_of_bad_files_alone_is_refused_for_the_first),
        CASE(what_is_not_damage_refuses_the_map_all_the_same),
        CASE(a_config_that_says_nothing_of_ours_is_refused),
        CASE(a_copy_stays_when_its_file_is_changed_in_place),
        CASE(thumbnails_are_held_by_no_memory_if_nobody_wants_them),
        CASE(a_file_cut_short_while_it_is_copied_is_damaged),
        CASE(a_copy_that_cannot_be_made_is_named),
        CASE(without_memory_a_map_is_refused_and_nothing_left_out),
        CASE(an_experience_that_does_not_compare_refuses_the_map),
        CASE(files_are_listed_in_the_byte_order_of_their_names),
        CASE(a_list_without_a_place_is_refused),
        CASE(an_interrupted_update_is_read_in_all_its_states),
        CASE(an_interrupted_update_may_be_all_of_a_map),
        CASE(an_experience_of_an_interrupted_update_that_is_gone_is_named),
        CASE(a_damaged_staged_file_is_named),
        CASE(a_link_to_an_experience_is_one_and_a_broken_one_is_named),
        CASE(a_file_that_another_tool_replaces_meanwhile_is_read_again),
        CASE(a_file_that_was_there_for_a_moment_is_not_part_of_the_map),
        CASE(files_stay_open_until_the_map_is_listed_again),
        CASE(a_journal_that_another_one_replaces_meanwhile_is_read_again),
        CASE(a_call_that_is_refused_while_a_map_is_read_is_an_error),
        cmocka_unit_test(a_comparison_names_the_first_field_that_differs),
        cmocka_unit_test(names_lengths_and_labels_may_differ),
    };
    return cmocka_run_group_tests_name("map_directory", tests, NULL, NULL);
}
