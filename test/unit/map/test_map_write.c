/* Writing experiences: only valid ones, and the old file or the new one, never a part of one. */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "cmocka_all.h"
#include "map_files.h"

/* Allow files of `bytes`, as a full disk would; more raises SIGXFSZ. */
static void limit_file_size(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes == RLIM_INFINITY ? limit.rlim_max : bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void assert_name(const char *path, const char *name)
{
    vdna_experience e;
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_string_equal(e.name, name);
    vdna_experience_close(&e);
}

static void assert_not_written(const directory *made, const vdna_experience *e,
                               vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    assert_int_equal(vdna_experience_write(e, path_in(made, "new.vdna"), &error), expected);
    if (!strstr(error.text, reason) || !strstr(error.text, "new.vdna: "))
        fail_msg("expected the path and \"%s\" in: %s", reason, error.text);
    assert_int_equal(files_in(made->path), 0);
}

static void an_experience_that_breaks_a_rule_is_not_written(void **state)
{
    const vdna_experience sample = sample_experience();
    const uint32_t mass[3] = {8, 9, 2};
    const float range[6] = {1, 1, 0, 1, 0, 1}, dark[2] = {NAN, 0};
    vdna_experience e = sample;
    memset(e.name, 'a', sizeof e.name);
    assert_not_written(*state, &e, VDNA_ERR_ARG, "name is too long");
    e = sample;
    strcpy(e.identity.preprocessing, "two\nlines");
    assert_not_written(*state, &e, VDNA_ERR_ARG, "preprocessing has a character");
    e = sample;
    strcpy(e.identity.model_sha256, "none");
    assert_not_written(*state, &e, VDNA_ERR_ARG, "model_sha256");
    e = sample;
    e.frames = 0;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "0 frames");
    e = sample;
    e.identity.neurons = 0;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "0 neurons");
    e = sample;
    e.identity.dim = 0;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "embeddings of 0 numbers");
    e = sample;
    e.identity.bins = 1;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "1 bins");
    e.identity.bins = 65537;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "65537 bins");
    e = sample;
    e.frame_grey = NULL;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "frame_grey is missing");
    e = sample;
    e.identity.range = range;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "the range of neuron 0");
    e = sample;
    e.mass = mass;
    assert_not_written(*state, &e, VDNA_ERR_MISMATCH, "the mass of neuron 1 is 9");
    e = sample;
    e.frame_grey = dark;
    assert_not_written(*state, &e, VDNA_ERR_NONFINITE, "the grey level of frame 0");
    e = grid_experience();
    e.last_layer = NULL;
    assert_not_written(*state, &e, VDNA_ERR_ARG,
                       "the last layer has no codes, scales and 7 numbers in a frame");
    e = grid_experience();
    e.last_layer_dim = 0;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "the last layer has codes, scales and 0 numbers");
    e = coded_experience();
    e.embedding_scale = NULL;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "frame_embedding_scale is missing");
    e = coded_experience();
    e.embedding_codes = NULL;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "frame_embedding is missing");
    e = projected_experience();
    e.identity.raw_dim = 4;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "the projection has directions and makes 5 of 4");
    e = pictured_experience();
    e.thumbnail_bytes = 0;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "thumbnails have pictures, ends and 0 bytes");
    e = pictured_experience();
    memset(e.source, 'a', sizeof e.source);
    assert_not_written(*state, &e, VDNA_ERR_ARG, "source is not 0 to 127 printable");
    e = sample;
    e.embeddings = NULL;
    assert_not_written(*state, &e, VDNA_ERR_ARG, "embeddings is missing");
    assert_int_equal(vdna_experience_write(NULL, "x", NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_write(&sample, NULL, NULL), VDNA_ERR_ARG);
}

static void a_name_has_letters_digits_and_three_marks_only(void **state)
{
    static const char allowed[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZ.abcdefghijklmnopqrstuvwxyz_0123456789-";
    vdna_experience e = sample_experience();
    for (int c = 1; c < 256; c++)
        if (!strchr(allowed, c)) {
            e.name[2] = (char)c;
            assert_not_written(*state, &e, VDNA_ERR_ARG, "name has a character");
        }
    const char *path = path_in(*state, "a.vdna");
    for (size_t half = 0; half < sizeof allowed - 1; half += 33) {
        snprintf(e.name, sizeof e.name, "%.33s", allowed + half);
        assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
        assert_name(path, e.name);
    }
}

static void preprocessing_is_printable_ascii(void **state)
{
    vdna_experience e = sample_experience();
    for (int c = 1; c < 256; c++)
        if (c < ' ' || c > '~') {
            e.identity.preprocessing[2] = (char)c;
            assert_not_written(*state, &e, VDNA_ERR_ARG, "preprocessing has a character");
        }
}

static void an_order_need_not_be_said_and_may_not_be_too_long(void **state)
{
    vdna_experience e = sample_experience(), read;
    memset(e.order, 'a', sizeof e.order);
    assert_not_written(*state, &e, VDNA_ERR_ARG, "order is longer than");
    const char *path = path_in(*state, "a.vdna");
    e.order[0] = '\0';
    e.frame_place = NULL;
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &read), VDNA_OK);
    assert_string_equal(read.order, "");
    vdna_experience_close(&read);
    e.frame_position = NULL;
    e.frame_place = sample_experience().frame_place;
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
}

static void a_position_lacks_all_of_its_numbers_or_none(void **state)
{
    const double some[][2][3] = {
        {{NAN, 1, 1}}, {{NAN, NAN, 1}}, {{1, NAN, 1}}, {{NAN, 1, NAN}}, {{1, 1, NAN}}};
    vdna_experience e = sample_experience();
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        e.frame_position = some[i][0];
        assert_not_written(*state, &e, VDNA_ERR_NONFINITE, "the position of frame 0");
    }
}

static void counts_of_many_neurons_are_all_added_up(void **state)
{
    /* One sample a neuron, in its second bin. */
    enum { NEURONS = 2500 };
    static float range[2 * NEURONS];
    static uint32_t counts[2 * NEURONS], mass[NEURONS];
    for (size_t n = 0; n < NEURONS; n++) {
        range[2 * n + 1] = 1;
        counts[NEURONS + n] = mass[n] = 1;
    }
    vdna_experience e = sample_experience();
    strcpy(e.identity.taps, "many:2500:1");
    e.identity.neurons = NEURONS;
    e.identity.bins = 2;
    e.frames = 1;
    e.identity.range = range;
    e.counts = counts;
    e.mass = mass;
    for (size_t n = 0; n < NEURONS; n += 100) {
        char reason[64];
        snprintf(reason, sizeof reason, "the counts of neuron %zu add up to 2, expected its mass 1",
                 n);
        counts[n] = 1;
        assert_not_written(*state, &e, VDNA_ERR_MISMATCH, reason);
        counts[n] = 0;
    }
    assert_int_equal(vdna_experience_write(&e, path_in(*state, "a.vdna"), NULL), VDNA_OK);
}

static void a_killed_writer_leaves_the_old_file(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    vdna_experience e = sample_experience();
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    strcpy(e.name, "summer");

    const pid_t child = fork();
    if (child == 0) {
        setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
        signal(SIGXFSZ, SIG_DFL);
        limit_file_size(1000);
        vdna_experience_write(&e, path, NULL);
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);

    /* The written part is there, and is no experience of the map. */
    uint32_t count;
    assert_int_equal(files_in(((const directory *)*state)->path), 2);
    assert_int_equal(vdna_map_count(((const directory *)*state)->path, NULL, &count), VDNA_OK);
    assert_int_equal(count, 1);
    assert_name(path, "winter");
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    assert_name(path, "summer");
}

static void the_partial_file_of_another_writer_is_left_alone(void **state)
{
    const directory *made = *state;
    const vdna_experience e = sample_experience();
    unsigned char kept[8];
    save_file(path_in(made, "a.vdna.0.partial"), "not mine", 8);
    assert_int_equal(vdna_experience_write(&e, path_in(made, "a.vdna"), NULL), VDNA_OK);
    assert_int_equal(load_file(path_in(made, "a.vdna.0.partial"), kept, sizeof kept), 8);
    assert_memory_equal(kept, "not mine", 8);
    assert_int_equal(files_in(made->path), 2);
}

static void the_leftovers_of_a_hundred_crashes_are_named(void **state)
{
    const directory *made = *state;
    const vdna_experience e = sample_experience();
    vdna_error error;
    for (int i = 0; i < 100; i++) {
        char name[32];
        snprintf(name, sizeof name, "a.vdna.%d.partial", i);
        save_file(path_in(made, name), "x", 1);
    }
    assert_int_equal(vdna_experience_write(&e, path_in(made, "a.vdna"), &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "cannot create a .partial file beside it: File exists"));
    assert_int_equal(files_in(made->path), 100);
}

static void a_full_disk_leaves_the_old_file_and_no_other(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    vdna_experience e = sample_experience();
    vdna_error error;
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    strcpy(e.name, "summer");

    signal(SIGXFSZ, SIG_IGN);
    limit_file_size(1000);
    const vdna_status status = vdna_experience_write(&e, path, &error);
    limit_file_size(RLIM_INFINITY);
    assert_int_equal(status, VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "a.vdna: cannot write: File too large"));
    assert_int_equal(files_in(((const directory *)*state)->path), 1);
    assert_name(path, "winter");
}

static void a_place_that_cannot_be_written_is_named(void **state)
{
    const directory *made = *state;
    const vdna_experience e = sample_experience();
    vdna_error error;
    assert_int_equal(vdna_experience_write(&e, path_in(made, "none/a.vdna"), &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "none/a.vdna: cannot open its directory: No such file"));

    /* Nothing is left behind when the last step, the rename, fails. */
    assert_int_equal(mkdir(path_in(made, "taken"), 0700), 0);
    assert_int_equal(vdna_experience_write(&e, path_in(made, "taken"), &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "cannot rename"));
    assert_int_equal(vdna_experience_write(&e, path_in(made, "taken/"), &error), VDNA_ERR_IO);
    assert_int_equal(files_in(made->path), 1);
    assert_int_equal(files_in(path_in(made, "taken")), 0);
}

static void a_path_that_is_too_long_is_refused(void **state)
{
    (void)state;
    const vdna_experience e = sample_experience();
    vdna_error error;
    /* A name that leaves no room for ".0.partial". */
    char name[251] = "", path[5000] = "";
    memset(name, 'a', sizeof name - 1);
    assert_int_equal(vdna_experience_write(&e, name, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "File name too long"));
    memset(path, 'a', sizeof path - 1);
    path[sizeof path - 2] = '/';
    assert_int_equal(vdna_experience_write(&e, path, &error), VDNA_ERR_IO);
}

static void a_read_only_directory_is_named(void **state)
{
    const directory *made = *state;
    const vdna_experience e = sample_experience();
    vdna_error error;
    /* root may write anywhere: become another user meanwhile. */
    const uid_t user = geteuid();
    assert_int_equal(chmod(made->path, 0555), 0);
    assert_int_equal(user == 0 ? seteuid(65534) : 0, 0);
    const vdna_status status = vdna_experience_write(&e, path_in(made, "a.vdna"), &error);
    assert_int_equal(seteuid(user), 0);
    assert_int_equal(chmod(made->path, 0755), 0);
    assert_int_equal(status, VDNA_ERR_IO);
    assert_non_null(strstr(error.text, ".partial file beside it: Permission denied"));
}

static void a_new_file_has_the_usual_access_rights(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    const vdna_experience e = sample_experience();
    struct stat about;
    const mode_t mask = umask(027);
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    umask(mask);
    assert_int_equal(stat(path, &about), 0);
    assert_int_equal(about.st_mode & 0777, 0640);
}

static void a_relative_path_is_written_where_the_program_is(void **state)
{
    const vdna_experience e = sample_experience();
    char before[512];
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(((const directory *)*state)->path), 0);
    const vdna_status status = vdna_experience_write(&e, "here.vdna", NULL);
    assert_int_equal(chdir(before), 0);
    assert_int_equal(status, VDNA_OK);
    assert_name(path_in(*state, "here.vdna"), "winter");
}

static void an_open_experience_can_be_written_over_itself(void **state)
{
    const char *path = path_in(*state, "a.vdna");
    const vdna_experience sample = sample_experience();
    vdna_experience e;
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    strcpy(e.name, "renamed");
    strcpy(e.comparable, "computed, not read");
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    vdna_experience_close(&e);
    assert_name(path, "renamed");
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(an_experience_that_breaks_a_rule_is_not_written),
        CASE(a_name_has_letters_digits_and_three_marks_only),
        CASE(preprocessing_is_printable_ascii),
        CASE(an_order_need_not_be_said_and_may_not_be_too_long),
        CASE(a_position_lacks_all_of_its_numbers_or_none),
        CASE(counts_of_many_neurons_are_all_added_up),
        CASE(a_killed_writer_leaves_the_old_file),
        CASE(the_partial_file_of_another_writer_is_left_alone),
        CASE(the_leftovers_of_a_hundred_crashes_are_named),
        CASE(a_full_disk_leaves_the_old_file_and_no_other),
        CASE(a_place_that_cannot_be_written_is_named),
        cmocka_unit_test(a_path_that_is_too_long_is_refused),
        CASE(a_read_only_directory_is_named),
        CASE(a_new_file_has_the_usual_access_rights),
        CASE(a_relative_path_is_written_where_the_program_is),
        CASE(an_open_experience_can_be_written_over_itself),
    };
    return cmocka_run_group_tests_name("map_write", tests, NULL, NULL);
}
