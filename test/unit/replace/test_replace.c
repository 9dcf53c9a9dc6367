/* Files that are replaced at once or not at all, and what other processes do meanwhile. What a full
 * or broken disk does is in test_map_write.c and test_map_refusals.c. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <sys/file.h>

#include "cmocka_all.h"
#include "map_files.h"
#include "replace/replace.h"
#include "watched_calls.h"

static void assert_holds(const char *path, const char *text)
{
    unsigned char bytes[64];
    const size_t size = load_file(path, bytes, sizeof bytes);
    assert_int_equal(size, strlen(text));
    assert_memory_equal(bytes, text, size);
}

static vdna_replace begun(const char *path)
{
    vdna_replace file;
    assert_int_equal(vdna_replace_begin(path, NULL, &file), VDNA_OK);
    assert_int_equal(vdna_replace_write(&file, "new", 3, NULL), VDNA_OK);
    return file;
}

static unsigned fsyncs;

static int count_fsyncs(const char *function)
{
    fsyncs += strcmp(function, "fsync") == 0;
    return 0;
}

static void a_file_has_its_name_when_it_is_complete(void **state)
{
    const char *path = path_in(*state, "a");
    save_file(path, "old", 3);
    fsyncs = 0;
    watch = count_fsyncs;
    vdna_replace file = begun(path);
    assert_holds(path, "old");
    assert_holds(path_in(*state, "a.0.partial"), "new");
    assert_int_equal(vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, NULL), VDNA_OK);
    watch = NULL;
    assert_int_equal(fsyncs, 2); /* the file, its directory */
    assert_holds(path, "new");
    assert_int_equal(files_in(((const directory *)*state)->path), 1);
}

static void what_can_be_made_again_does_not_wait_for_the_disk(void **state)
{
    const char *path = path_in(*state, "a");
    vdna_replace file = begun(path);
    fsyncs = 0;
    watch = count_fsyncs;
    assert_int_equal(vdna_replace_commit(&file, VDNA_REPLACE_QUICK, NULL), VDNA_OK);
    watch = NULL;
    assert_int_equal(fsyncs, 0);
    assert_holds(path, "new");
}

static void a_link_is_not_replaced_by_a_file(void **state)
{
    const char *path = path_in(*state, "link");
    save_file(path_in(*state, "a"), "old", 3);
    for (int dangling = 0; dangling < 2; dangling++) {
        unlink(path);
        assert_int_equal(symlink(dangling ? "nowhere" : "a", path), 0);
        vdna_error error;
        vdna_replace file;
        assert_int_equal(vdna_replace_begin(path, &error, &file), VDNA_ERR_IO);
        assert_non_null(strstr(error.text, "link: is a symbolic link"));
        char target[16];
        assert_true(readlink(path, target, sizeof target) > 0);
    }
    assert_holds(path_in(*state, "a"), "old");
    assert_int_equal(files_in(((const directory *)*state)->path), 2);
}

static void a_device_is_not_replaced_by_a_file(void **state)
{
    (void)state;
    vdna_replace file;
    assert_int_equal(vdna_replace_begin("/dev/null", NULL, &file), VDNA_ERR_IO);
}

static void a_file_that_is_abandoned_leaves_nothing(void **state)
{
    vdna_replace file = begun(path_in(*state, "a"));
    vdna_replace_abandon(&file);
    assert_int_equal(files_in(((const directory *)*state)->path), 0);
}

static void a_staged_file_is_complete_under_another_name(void **state)
{
    const char *path = path_in(*state, "a");
    save_file(path, "old", 3);
    save_file(path_in(*state, "a.staged"), "older", 5);
    vdna_replace file = begun(path);
    fsyncs = 0;
    watch = count_fsyncs;
    assert_int_equal(vdna_replace_stage(&file, "a.staged", NULL), VDNA_OK);
    watch = NULL;
    assert_int_equal(fsyncs, 1); /* the file */
    assert_holds(path, "old");
    assert_holds(path_in(*state, "a.staged"), "new");
    assert_int_equal(files_in(((const directory *)*state)->path), 2);
}

static void a_file_that_cannot_be_staged_is_gone(void **state)
{
    static const char *const calls[] = {"fsync", "renameat"};
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        vdna_error error;
        vdna_replace file = begun(path_in(*state, "a"));
        refuse(calls[i], 0, EIO);
        assert_int_equal(vdna_replace_stage(&file, "a.staged", &error), VDNA_ERR_IO);
        assert_true(was_refused());
        assert_non_null(strstr(error.text, "Input/output error; the file was not written"));
        assert_int_equal(files_in(((const directory *)*state)->path), 0);
    }
}

static void a_directory_that_is_open_is_written_to_wherever_it_is(void **state)
{
    const directory *made = *state;
    char elsewhere[80];
    vdna_replace file;
    vdna_error error;
    const int open_directory = open(made->path, O_RDONLY | O_DIRECTORY);
    snprintf(elsewhere, sizeof elsewhere, "%s-moved", made->path);
    assert_int_equal(rename(made->path, elsewhere), 0);
    assert_int_equal(vdna_replace_begin_in(open_directory, "no/such/place/a", NULL, &file),
                     VDNA_OK);
    assert_int_equal(vdna_replace_write(&file, "new", 3, NULL), VDNA_OK);
    assert_int_equal(vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, NULL), VDNA_OK);
    assert_int_equal(rename(elsewhere, made->path), 0);
    assert_holds(path_in(made, "a"), "new");
    close(open_directory);

    assert_int_equal(vdna_replace_begin_in(-1, "place/a", &error, &file), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "place/a: cannot open its directory: Bad file descriptor"));
}

static void only_names_of_incomplete_files_are_taken_for_them(void **state)
{
    static const struct {
        const char *name;
        size_t target;
    } cases[] = {
        {"winter.vdna.0.partial", 11},
        {"a.99.partial", 1},
        {".commit.12.partial", 7},
        {"winter.vdna.partial", 0}, /* another writer's */
        {"winter.vdna..partial", 0},
        {"winter.vdna0.partial", 0},
        {"winter.vdna.0.partial.gz", 0},
        {"winter.vdna.0.part", 0},
        {"12.partial", 0},
        {".0.partial", 0},
        {".partial", 0},
        {"partial", 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (vdna_replace_target(cases[i].name) != cases[i].target)
            fail_msg("%s: expected %zu", cases[i].name, cases[i].target);
}

/* Remove an orphan of the test's directory. @return whether it is gone */
static int is_removed(const directory *made, const char *name)
{
    const int opened = open(made->path, O_RDONLY | O_DIRECTORY);
    vdna_replace_remove_orphan(opened, name);
    close(opened);
    return access(path_in(made, name), F_OK) != 0;
}

static void an_orphan_is_removed_and_the_file_of_a_live_writer_is_not(void **state)
{
    const directory *made = *state;
    vdna_replace live = begun(path_in(made, "a"));
    save_file(path_in(made, "a.1.partial"), "x", 1);
    assert_false(is_removed(made, "a.0.partial"));
    assert_true(is_removed(made, "a.1.partial"));
    assert_int_equal(vdna_replace_commit(&live, VDNA_REPLACE_DURABLE, NULL), VDNA_OK);
    assert_holds(path_in(made, "a"), "new");
    is_removed(made, "none.0.partial"); /* it is not there: nothing happens */
    assert_int_equal(files_in(made->path), 1);
}

static void without_locks_files_are_written_and_no_orphan_is_removed(void **state)
{
    const directory *made = *state;
    refuse("flock", 0, ENOLCK);
    vdna_replace file = begun(path_in(made, "a"));
    assert_true(was_refused());
    assert_string_equal(file.partial, "a.0.partial");
    assert_int_equal(vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, NULL), VDNA_OK);
    save_file(path_in(made, "a.0.partial"), "x", 1);
    refuse("flock", 0, ENOLCK);
    assert_false(is_removed(made, "a.0.partial"));
    assert_true(was_refused());
}

/* What somebody does who takes a new file for an orphan, between its creation and its lock. */
static struct {
    const directory *made;
    int is_to_remove, lock, times;
} cleaner;

static int clean(const char *function)
{
    if (strcmp(function, "flock") != 0 || cleaner.times-- <= 0)
        return 0;
    if (cleaner.is_to_remove)
        assert_true(is_removed(cleaner.made, "a.0.partial"));
    else
        cleaner.lock = open(path_in(cleaner.made, "a.0.partial"), O_RDONLY);
    assert_int_equal(cleaner.is_to_remove ? 0 : flock(cleaner.lock, LOCK_EX | LOCK_NB), 0);
    return 0;
}

static void a_new_file_that_somebody_takes_for_an_orphan_gets_another_name(void **state)
{
    const directory *made = *state;
    for (int is_to_remove = 0; is_to_remove < 2; is_to_remove++) {
        cleaner.made = made;
        cleaner.is_to_remove = is_to_remove;
        cleaner.times = 1;
        watch = clean;
        vdna_replace file = begun(path_in(made, "a"));
        watch = NULL;
        assert_string_equal(file.partial, "a.1.partial");
        assert_int_equal(vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, NULL), VDNA_OK);
        assert_holds(path_in(made, "a"), "new");
        if (!is_to_remove)
            close(cleaner.lock);
        unlink(path_in(made, "a.0.partial"));
    }
}

/* The writer of what looked like an orphan gives it its name, and another begins one of the same
 * name, before the orphan's lock is tried. */
static int begin_another(const char *function)
{
    if (strcmp(function, "flock") != 0 || cleaner.times-- <= 0)
        return 0;
    assert_int_equal(rename(path_in(cleaner.made, "a.0.partial"), path_in(cleaner.made, "a")), 0);
    save_file(path_in(cleaner.made, "a.0.partial"), "another", 7);
    return 0;
}

static void a_file_that_came_in_the_place_of_an_orphan_is_left_alone(void **state)
{
    const directory *made = *state;
    save_file(path_in(made, "a.0.partial"), "first", 5);
    cleaner.made = made;
    cleaner.times = 1;
    watch = begin_another;
    assert_false(is_removed(made, "a.0.partial"));
    watch = NULL;
    assert_holds(path_in(made, "a"), "first");
    assert_holds(path_in(made, "a.0.partial"), "another");
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(a_file_has_its_name_when_it_is_complete),
        CASE(what_can_be_made_again_does_not_wait_for_the_disk),
        CASE(a_link_is_not_replaced_by_a_file),
        CASE(a_device_is_not_replaced_by_a_file),
        CASE(a_file_that_is_abandoned_leaves_nothing),
        CASE(a_staged_file_is_complete_under_another_name),
        CASE(a_file_that_cannot_be_staged_is_gone),
        CASE(a_directory_that_is_open_is_written_to_wherever_it_is),
        cmocka_unit_test(only_names_of_incomplete_files_are_taken_for_them),
        CASE(an_orphan_is_removed_and_the_file_of_a_live_writer_is_not),
        CASE(without_locks_files_are_written_and_no_orphan_is_removed),
        CASE(a_new_file_that_somebody_takes_for_an_orphan_gets_another_name),
        CASE(a_file_that_came_in_the_place_of_an_orphan_is_left_alone),
    };
    return cmocka_run_group_tests_name("replace", tests, NULL, NULL);
}
