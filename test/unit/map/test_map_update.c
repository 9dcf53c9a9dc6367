/* Updates of a map: several experience files that appear together or not at all, despite any
 * interruption. The system calls that change a directory are counted by stand-ins (see
 * CMakeLists.txt), so that a writer can be ended, or refused, at any of them. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "cmocka_all.h"
#include "map_files.h"

/* Fate of the call whose turn it is. */
enum { GOES_ON, ENDS_THE_PROCESS, IS_REFUSED };

static struct {
    int calls_left, fate;
} script = {-1, GOES_ON};

static int is_refused(void)
{
    if (script.calls_left < 0 || script.calls_left-- > 0)
        return 0;
    if (script.fate == ENDS_THE_PROCESS)
        _exit(9);
    errno = EIO;
    return script.fate == IS_REFUSED;
}

ssize_t __real_write(int descriptor, const void *bytes, size_t size);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t size);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t size)
{
    return is_refused() ? -1 : __real_write(descriptor, bytes, size);
}

int __real_fsync(int descriptor);
int __wrap_fsync(int descriptor);
int __wrap_fsync(int descriptor)
{
    return is_refused() ? -1 : __real_fsync(descriptor);
}

int __real_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new)
{
    return is_refused() ? -1 : __real_renameat(from, old, to, new);
}

int __real_unlinkat(int where, const char *name, int flags);
int __wrap_unlinkat(int where, const char *name, int flags);
int __wrap_unlinkat(int where, const char *name, int flags)
{
    return is_refused() ? -1 : __real_unlinkat(where, name, flags);
}

static const char *const names[] = {"night", "summer", "winter"};
enum { NAMES = 3 };

/* One of the three; its first embedding tells which update wrote it. */
static vdna_experience experience_of(const char *name, float version, float *embeddings)
{
    vdna_experience e = sample_experience();
    memcpy(embeddings, e.embeddings, sizeof(float) * e.frames * e.identity.dim);
    embeddings[0] = version;
    e.embeddings = embeddings;
    strcpy(e.name, name);
    return e;
}

/* Write all three in one update. */
static vdna_status update_all(const char *path, float version, vdna_error *error)
{
    vdna_map_update *update;
    vdna_status status = vdna_map_update_open(path, error, &update);
    if (status != VDNA_OK)
        return status;
    for (int i = 0; i < NAMES && status == VDNA_OK; i++) {
        float embeddings[64];
        const vdna_experience e = experience_of(names[i], version, embeddings);
        status = vdna_map_update_add(update, &e, error);
    }
    if (status == VDNA_OK)
        status = vdna_map_update_commit(update, error);
    vdna_map_update_close(update);
    return status;
}

/* The update that wrote all three; fails if they are from different ones. */
static float version_of(const char *path)
{
    vdna_experience open[NAMES];
    uint32_t count = 0;
    vdna_error error = {""};
    const vdna_status status = vdna_map_open(path, NAMES, &error, open, &count);
    if (status != VDNA_OK)
        fail_msg("%s", error.text);
    assert_int_equal(count, NAMES);
    const float version = open[0].embeddings[0];
    for (uint32_t i = 0; i < count; i++) {
        assert_string_equal(open[i].name, names[i]);
        assert_true(open[i].embeddings[0] == version);
        vdna_experience_close(&open[i]);
    }
    return version;
}

static void the_files_of_an_update_appear_together(void **state)
{
    const directory *made = *state;
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), NAMES);
    assert_true(version_of(made->path) == 1);
    assert_int_equal(update_all(made->path, 2, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), NAMES);
    assert_true(version_of(made->path) == 2);
}

static void an_update_that_is_not_committed_leaves_nothing(void **state)
{
    const directory *made = *state;
    vdna_map_update *update;
    const vdna_experience e = sample_experience();
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), 1);
    vdna_map_update_close(update);
    assert_int_equal(files_in(made->path), 0);
}

static void a_directory_in_the_way_of_one_file_leaves_the_map_as_it_was(void **state)
{
    const directory *made = *state;
    vdna_error error;
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
    assert_int_equal(unlink(path_in(made, "winter.vdna")), 0);
    assert_int_equal(mkdir(path_in(made, "winter.vdna"), 0700), 0);
    assert_int_equal(update_all(made->path, 2, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "winter.vdna: is a directory, expected an experience file"));
    assert_int_equal(files_in(made->path), NAMES);
    vdna_experience summer;
    assert_int_equal(vdna_experience_open(path_in(made, "summer.vdna"), NULL, &summer), VDNA_OK);
    assert_true(summer.embeddings[0] == 1);
    vdna_experience_close(&summer);
    assert_int_equal(rmdir(path_in(made, "winter.vdna")), 0);
}

/* Run an update in a process that ends at its n-th call. @return whether it came to its end */
static int survives(const char *path, float version, int calls)
{
    const pid_t child = fork();
    if (child == 0) {
        script.calls_left = calls;
        script.fate = ENDS_THE_PROCESS;
        _exit(update_all(path, version, NULL) == VDNA_OK ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) != 1);
    return WEXITSTATUS(status) == 0;
}

static void a_writer_killed_at_any_call_leaves_the_old_map_or_the_new_one(void **state)
{
    const directory *made = *state;
    float version = 1;
    assert_int_equal(update_all(made->path, version, NULL), VDNA_OK);
    int old = 0, new = 0, calls = 0;
    for (; !survives(made->path, version + 1, calls); calls++) {
        const float found = version_of(made->path);
        assert_true(found == version || found == version + 1);
        *(found == version ? &old : &new) += 1;
        version = found;
    }
    assert_true(version_of(made->path) == version + 1);
    /* Both outcomes occur, so the point of no return lies between; nothing is left behind. */
    assert_true(old > 10 && new > 3);
    assert_int_equal(files_in(made->path), NAMES);
}

static void a_call_that_is_refused_leaves_the_old_map_or_the_new_one(void **state)
{
    const directory *made = *state;
    float version = 1;
    vdna_status status = VDNA_ERR_IO;
    assert_int_equal(update_all(made->path, version, NULL), VDNA_OK);
    for (int calls = 0; calls < 100; calls++) {
        script.calls_left = calls;
        script.fate = IS_REFUSED;
        status = update_all(made->path, version + 1, NULL);
        const int came_to_it = script.calls_left < 0;
        script.calls_left = -1;
        const float found = version_of(made->path);
        assert_true(found == version + 1 || (found == version && status != VDNA_OK));
        version = found;
        if (!came_to_it)
            break;
    }
    assert_int_equal(status, VDNA_OK);
    assert_int_equal(update_all(made->path, version, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), NAMES);
}

static void a_map_has_one_writer_at_a_time(void **state)
{
    const directory *made = *state;
    vdna_map_update *first, *second = NULL;
    vdna_error error;
    assert_int_equal(vdna_map_update_open(made->path, NULL, &first), VDNA_OK);
    assert_int_equal(vdna_map_update_open(made->path, &error, &second), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "another program is changing this map"));
    assert_null(second);
    vdna_map_update_close(first);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &second), VDNA_OK);
    vdna_map_update_close(second);
}

static void leftovers_of_crashed_writers_are_removed_and_files_of_live_ones_are_not(void **state)
{
    const directory *made = *state;
    vdna_map_update *update;
    save_file(path_in(made, "a.vdna.0.partial"), "x", 1);
    save_file(path_in(made, "b.vdna.0.partial"), "x", 1);
    save_file(path_in(made, "notes.partial"), "x", 1);
    const int live = open(path_in(made, "b.vdna.0.partial"), O_RDONLY);
    assert_int_equal(flock(live, LOCK_EX), 0);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    vdna_map_update_close(update);
    close(live);
    assert_int_not_equal(access(path_in(made, "a.vdna.0.partial"), F_OK), 0);
    assert_int_equal(access(path_in(made, "b.vdna.0.partial"), F_OK), 0);
    assert_int_equal(access(path_in(made, "notes.partial"), F_OK), 0);
}

static void a_damaged_journal_is_named(void **state)
{
    static const char *const journals[] = {
        "",
        "vdna-commit 2\n",
        "vdna-commit 1\na.partial",
        "vdna-commit 1\na.partial b.vdna",
        "vdna-commit 1\na.partial  b.vdna\n",
        "vdna-commit 1\n../a.partial b.vdna\n",
        "vdna-commit 1\na.partial ../b.vdna\n",
        "vdna-commit 1\n b.vdna\n",
    };
    const directory *made = *state;
    vdna_error error;
    uint32_t count = 7;
    vdna_map_update *update;
    for (size_t i = 0; i < sizeof journals / sizeof *journals; i++) {
        save_file(path_in(made, ".commit"), journals[i], strlen(journals[i]));
        assert_int_equal(vdna_map_count(made->path, &error, &count), VDNA_ERR_FORMAT);
        assert_non_null(strstr(error.text, "/.commit: is damaged"));
        assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_ERR_FORMAT);
    }
    assert_int_equal(count, 7);
}

static void arguments_that_are_missing_are_refused(void **state)
{
    const directory *made = *state;
    vdna_map_update *update = NULL;
    const vdna_experience e = sample_experience();
    uint32_t count;
    assert_int_equal(vdna_map_update_open(NULL, NULL, &update), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_update_open(made->path, NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_update_open(path_in(made, "none"), NULL, &update), VDNA_ERR_IO);
    assert_int_equal(vdna_map_update_add(NULL, &e, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_update_commit(NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_list(NULL, 0, NULL, NULL, &count), VDNA_ERR_ARG);
    vdna_map_update_close(NULL);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    assert_int_equal(vdna_map_update_add(update, NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_ERR_ARG); /* the same twice */
    vdna_map_update_close(update);
    assert_int_equal(files_in(made->path), 0);
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(the_files_of_an_update_appear_together),
        CASE(an_update_that_is_not_committed_leaves_nothing),
        CASE(a_directory_in_the_way_of_one_file_leaves_the_map_as_it_was),
        CASE(a_writer_killed_at_any_call_leaves_the_old_map_or_the_new_one),
        CASE(a_call_that_is_refused_leaves_the_old_map_or_the_new_one),
        CASE(a_map_has_one_writer_at_a_time),
        CASE(leftovers_of_crashed_writers_are_removed_and_files_of_live_ones_are_not),
        CASE(a_damaged_journal_is_named),
        CASE(arguments_that_are_missing_are_refused),
    };
    return cmocka_run_group_tests_name("map_update", tests, NULL, NULL);
}
