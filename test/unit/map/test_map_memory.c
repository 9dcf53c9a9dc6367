/* Experiences in memory of the caller, as in flash: read where they are, and only valid ones. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>

#include <vdna/int8.h>

#include "cmocka_all.h"
#include "edited_file.h"

/* What `experience` is as a file, aligned. */
typedef struct flash {
    int64_t words[FILE_SIZE / sizeof(int64_t)];
    size_t size;
} flash;

static flash flash_of(const vdna_experience *experience)
{
    flash made = {.size = 0};
    const directory folder = make_directory();
    const char *path = path_in(&folder, "sample");
    assert_int_equal(vdna_experience_write(experience, path, NULL), VDNA_OK);
    made.size = load_file(path, (unsigned char *)made.words, sizeof made.words);
    remove_directory(&folder);
    return made;
}

static void assert_refused(const void *bytes, size_t size, vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    vdna_experience e, untouched;
    memset(&e, 0xAA, sizeof e);
    untouched = e;
    assert_int_equal(vdna_experience_open_memory(bytes, size, &error, &e), expected);
    assert_memory_equal(&e, &untouched, sizeof e);
    if (!strstr(error.text, reason) || !strstr(error.text, "experience in memory: "))
        fail_msg("expected \"%s\" in: %s", reason, error.text);
}

static void everything_points_into_the_bytes(void **state)
{
    (void)state;
    const vdna_experience sample = sample_experience();
    const flash f = flash_of(&sample), before = f;
    const char *const begin = (const char *)f.words, *const end = begin + f.size;
    vdna_experience e;
    assert_int_equal(vdna_experience_open_memory(f.words, f.size, NULL, &e), VDNA_OK);
    assert_string_equal(e.name, "winter");
    assert_memory_equal(e.counts, sample.counts, 4 * 3 * sizeof(uint32_t));
    assert_memory_equal(e.embeddings, sample.embeddings, 2 * 5 * sizeof(float));
    const void *const pointers[] = {e.counts,      e.mass,        e.identity.range, e.embeddings,
                                    e.frame_utime, e.frame_place, e.frame_position, e.frame_grey};
    for (size_t p = 0; p < sizeof pointers / sizeof *pointers; p++)
        assert_true((const char *)pointers[p] > begin && (const char *)pointers[p] < end);
    assert_null(e.file_bytes);
    assert_int_equal(e.file_size, 0);

    vdna_experience_close(&e);
    assert_null(e.counts);
    assert_memory_equal(&f, &before, sizeof f);
}

static void codes_stay_codes(void **state)
{
    (void)state;
    const vdna_experience coded = coded_experience();
    const flash f = flash_of(&coded);
    float decoded[5];
    vdna_experience e;
    assert_int_equal(vdna_experience_open_memory(f.words, f.size, NULL, &e), VDNA_OK);
    assert_null(e.embeddings);
    vdna_int8_decode(e.embedding_codes + 5, 5, e.embedding_scale[1], decoded);
    assert_memory_equal(decoded, coded.embeddings + 5, sizeof decoded);

    /* It is whole without the floats: what is written of it is the same file. */
    const flash again = flash_of(&e);
    assert_int_equal(again.size, f.size);
    assert_memory_equal(again.words, f.words, f.size);
    vdna_experience_close(&e);
}

/* A code of -128 with the greatest scale is beyond what an embedding may be. */
static void codes_are_checked_as_floats_are(void **state)
{
    (void)state;
    enum { DIM = 600 };
    static int8_t codes[2 * DIM];
    static const float scale[2] = {1, VDNA_EMBEDDING_MAX / 127};
    vdna_experience e = coded_experience();
    e.identity.dim = DIM;
    strcpy(e.identity.embedding, "mid grid=1x300 last=top centred");
    e.embeddings = NULL;
    e.embedding_codes = codes;
    e.embedding_scale = scale;
    flash_of(&e);
    const size_t places[] = {0, DIM - 1};
    for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
        vdna_error error = {""};
        memset(codes, 0, sizeof codes);
        codes[DIM + places[p]] = -128;
        assert_int_equal(vdna_experience_write(&e, "/nowhere/x", &error), VDNA_ERR_ARG);
        assert_non_null(strstr(error.text, "the embedding of frame 1 has a number beyond 1e+15"));
    }
}

static void bytes_that_are_not_aligned_are_refused(void **state)
{
    (void)state;
    const vdna_experience sample = sample_experience();
    const flash f = flash_of(&sample);
    int64_t room[FILE_SIZE / sizeof(int64_t) + 1];
    for (size_t shift = 1; shift < VDNA_EXPERIENCE_ALIGNMENT; shift++) {
        char *const moved = (char *)room + shift;
        memcpy(moved, f.words, f.size);
        assert_refused(moved, f.size, VDNA_ERR_ARG, "expected a multiple of 8");
    }
}

static void bytes_are_checked_as_those_of_a_file_are(void **state)
{
    (void)state;
    const vdna_experience sample = sample_experience();
    flash f = flash_of(&sample);
    assert_refused(f.words, 0, VDNA_ERR_FORMAT, "; rebuild it");
    assert_refused(f.words, f.size - 1, VDNA_ERR_FORMAT, "; rebuild it");
    ((unsigned char *)f.words)[f.size - 5] ^= 1;
    assert_refused(f.words, f.size, VDNA_ERR_CHECKSUM, "; copy it again");
}

static void what_is_not_there_is_refused(void **state)
{
    (void)state;
    const int64_t word = 0;
    vdna_experience e;
    assert_refused(NULL, 8, VDNA_ERR_ARG, "no bytes");
    assert_int_equal(vdna_experience_open_memory(&word, 8, NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_open_memory(&word, 8, NULL, &e), VDNA_ERR_FORMAT);
}

static void *open_it(void *argument)
{
    const flash *f = argument;
    vdna_experience e;
    return vdna_experience_open_memory(f->words, f->size, NULL, &e) == VDNA_OK ? argument : NULL;
}

/* A thread with less stack than that has no room: the page behind it cannot be written. */
static void the_stack_that_the_header_states_is_enough(void **state)
{
    (void)state;
    const vdna_experience coded = coded_experience();
    flash f = flash_of(&coded);
    pthread_attr_t small;
    pthread_t thread;
    void *opened = NULL;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip(); /* they need more */
#endif
    assert_int_equal(pthread_attr_init(&small), 0);
    assert_int_equal(pthread_attr_setstacksize(&small, 128 * 1024), 0);
    assert_int_equal(pthread_create(&thread, &small, open_it, &f), 0);
    assert_int_equal(pthread_join(thread, &opened), 0);
    assert_ptr_equal(opened, &f);
    pthread_attr_destroy(&small);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_points_into_the_bytes),
        cmocka_unit_test(codes_stay_codes),
        cmocka_unit_test(codes_are_checked_as_floats_are),
        cmocka_unit_test(bytes_that_are_not_aligned_are_refused),
        cmocka_unit_test(bytes_are_checked_as_those_of_a_file_are),
        cmocka_unit_test(what_is_not_there_is_refused),
        cmocka_unit_test(the_stack_that_the_header_states_is_enough),
    };
    return cmocka_run_group_tests_name("map_memory", tests, NULL, NULL);
}
