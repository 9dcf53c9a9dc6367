/* Updates of a map: several experience files that appear together or not at all, whatever happens.
 * A writer is ended, or refused, at each of its system calls. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <sys/file.h>

#include "journal.h"
#include "map_versions.h"
#include "watched_calls.h"

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

static int calls_left;

static int end_the_process(const char *function)
{
    if (calls_left-- == 0)
        _exit(9);
    return skip_the_disk(function);
}

/* Run an update in a process that ends at its n-th call. @return whether it came to its end */
static int survives(const char *path, float version, int calls)
{
    const pid_t child = fork();
    if (child == 0) {
        calls_left = calls;
        watch = end_the_process;
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
    watch = skip_the_disk;
    assert_int_equal(update_all(made->path, version, NULL), VDNA_OK);
    int old = 0, new = 0, calls = 0;
    for (; !survives(made->path, version + 1, calls); calls++) {
        const float found = version_of(made->path);
        assert_true(found == version || found == version + 1);
        *(found == version ? &old : &new) += 1;
        /* Begin the next one where nothing is left behind. */
        version += 2;
        assert_int_equal(update_all(made->path, version, NULL), VDNA_OK);
    }
    watch = NULL;
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
    for (int calls = 0; calls < 1000; calls++) {
        refuse(NULL, calls, EIO);
        status = update_all(made->path, version + 1, NULL);
        const int came_to_it = was_refused();
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

/* Begin an update of `path` and add winter of one version. */
static vdna_map_update *begin(const char *path, float version)
{
    float embeddings[64];
    vdna_map_update *update = NULL;
    const vdna_experience e = experience_of("winter", version, embeddings);
    assert_int_equal(vdna_map_update_open(path, NULL, &update), VDNA_OK);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    return update;
}

static void assert_winter(const directory *made, float version)
{
    vdna_experience winter;
    uint32_t count;
    assert_int_equal(vdna_map_open(made->path, 1, NULL, &winter, &count), VDNA_OK);
    assert_true(winter.embeddings[0] == version);
    vdna_experience_close(&winter);
}

static void an_update_of_nothing_changes_nothing(void **state)
{
    const directory *made = *state;
    vdna_map_update *update;
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    assert_int_equal(files_in(made->path), 0);
}

static void an_update_is_committed_once(void **state)
{
    const directory *made = *state;
    vdna_error error;
    const vdna_experience e = sample_experience();
    vdna_map_update *update = begin(made->path, 1);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, &error), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "this update has been committed; close it"));
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_ERR_ARG);
    vdna_map_update_close(update);
    assert_winter(made, 1);
}

/* What was committed and not finished belongs to the map, whoever tries again. */
static void an_update_that_could_not_be_finished_is_finished_by_the_next(void **state)
{
    const directory *made = *state;
    const vdna_experience e = sample_experience();
    vdna_error error = {""};
    vdna_map_update *update = begin(made->path, 1);
    refuse("renameat", 1, EIO); /* the first is the journal's */
    assert_int_equal(vdna_map_update_commit(update, &error), VDNA_ERR_IO);
    assert_true(was_refused());
    assert_non_null(strstr(error.text, "the update is final, and the next one"));
    assert_winter(made, 1);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_ERR_ARG);
    vdna_map_update_close(update);
    assert_winter(made, 1);
    assert_int_not_equal(access(path_in(made, "winter.vdna"), F_OK), 0);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    vdna_map_update_close(update);
    assert_winter(made, 1);
    assert_int_equal(access(path_in(made, "winter.vdna"), F_OK), 0);
}

static void a_commit_that_failed_before_it_was_final_can_be_tried_again(void **state)
{
    const directory *made = *state;
    vdna_error error = {""};
    vdna_map_update *update = begin(made->path, 1);
    refuse("renameat", 0, EIO);
    assert_int_equal(vdna_map_update_commit(update, &error), VDNA_ERR_IO);
    assert_true(was_refused());
    assert_non_null(strstr(error.text, "the map is unchanged"));
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    assert_winter(made, 1);
}

static void what_was_added_and_is_gone_leaves_the_map_as_it_was(void **state)
{
    const directory *made = *state;
    vdna_error error = {""};
    vdna_map_update *update = begin(made->path, 1);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    update = begin(made->path, 2);
    assert_int_equal(unlink(path_in(made, "winter.vdna.staged")), 0);
    assert_int_equal(vdna_map_update_commit(update, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "winter.vdna.staged: cannot find what was added: No such"));
    vdna_map_update_close(update);
    assert_winter(made, 1);
}

static void an_update_stays_in_its_directory(void **state)
{
    const directory *made = *state;
    char before[512];
    float embeddings[64];
    vdna_map_update *update = NULL;
    const vdna_experience e = experience_of("winter", 1, embeddings);
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(made->path), 0);
    assert_int_equal(vdna_map_update_open(".", NULL, &update), VDNA_OK);
    assert_int_equal(chdir(before), 0);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    assert_winter(made, 1);
}

static void an_experience_that_nobody_would_find_is_refused(void **state)
{
    const directory *made = *state;
    vdna_error error;
    vdna_map_update *update;
    vdna_experience e = sample_experience();
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    strcpy(e.name, ".winter");
    assert_int_equal(vdna_map_update_add(update, &e, &error), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "a name that begins with '.' hides its file"));
    strcpy(e.name, "win/ter");
    assert_int_equal(vdna_map_update_add(update, &e, &error), VDNA_ERR_ARG);
    memset(e.name, 'a', sizeof e.name);
    assert_int_equal(vdna_map_update_add(update, &e, &error), VDNA_ERR_ARG);
    vdna_map_update_close(update);
    assert_int_equal(files_in(made->path), 0);
}

static void an_update_has_as_many_experiences_as_a_journal(void **state)
{
    const directory *made = *state;
    vdna_error error;
    vdna_map_update *update;
    vdna_experience e = sample_experience();
    watch = skip_the_disk;
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    for (unsigned i = 0; i < VDNA_JOURNAL_NAMES_MAX; i++) {
        snprintf(e.name, sizeof e.name, "%u", i);
        assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    }
    assert_int_equal(vdna_map_update_add(update, &e, &error), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "at most 4096 experiences in one update"));
    vdna_map_update_close(update);
    watch = NULL;
    assert_int_equal(files_in(made->path), 0);
}

static void a_crash_while_a_journal_is_made_leaves_nothing_for_long(void **state)
{
    const directory *made = *state;
    vdna_map_update *update;
    save_file(path_in(made, ".commit.0.partial"), "vdna-", 5);
    save_file(path_in(made, "winter.vdna.staged"), "x", 1);
    save_file(path_in(made, "winter.vdna.partial"), "not ours", 8);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    vdna_map_update_close(update);
    assert_int_not_equal(access(path_in(made, ".commit.0.partial"), F_OK), 0);
    assert_int_not_equal(access(path_in(made, "winter.vdna.staged"), F_OK), 0);
    assert_int_equal(access(path_in(made, "winter.vdna.partial"), F_OK), 0);
}

/* An interrupted update is older than an experience that is written on its own. */
static void one_experience_is_written_after_an_interrupted_update_is_finished(void **state)
{
    const directory *made = *state;
    vdna_error error = {""};
    float embeddings[64];
    const vdna_experience e = experience_of("winter", 2, embeddings);
    vdna_map_update *update = begin(made->path, 1);
    refuse("renameat", 1, EIO);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_ERR_IO);
    assert_true(was_refused());
    const char *path = path_in(made, "winter.vdna");
    assert_int_equal(vdna_experience_write(&e, path, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "another program is changing this map"));
    assert_winter(made, 1);
    vdna_map_update_close(update);
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    assert_winter(made, 2);
    assert_int_equal(vdna_map_update_open(made->path, NULL, &update), VDNA_OK);
    vdna_map_update_close(update);
    assert_winter(made, 2);
    assert_int_equal(files_in(made->path), 1);
}

static void a_replacement_refused_at_any_call_leaves_the_old_file_or_the_new_one(void **state)
{
    const directory *made = *state;
    const char *path = path_in(made, "winter.vdna");
    float before[64], after[64];
    const vdna_experience old = experience_of("winter", 1, before);
    const vdna_experience new = experience_of("winter", 2, after);
    vdna_status status = VDNA_ERR_IO;
    int olds = 0;
    for (int calls = 0, was = 1; was; calls++) {
        remove_all_files(made);
        assert_int_equal(vdna_experience_write(&old, path, NULL), VDNA_OK);
        refuse(NULL, calls, ENOSPC);
        status = vdna_experience_write(&new, path, NULL);
        was = was_refused();
        vdna_experience found;
        assert_int_equal(vdna_experience_open(path, NULL, &found), VDNA_OK);
        assert_true(found.embeddings[0] == 2 || (found.embeddings[0] == 1 && status != VDNA_OK));
        olds += found.embeddings[0] == 1;
        vdna_experience_close(&found);
    }
    assert_int_equal(status, VDNA_OK);
    assert_true(olds > 3);
}

static void without_locks_a_map_is_updated_all_the_same(void **state)
{
    const directory *made = *state;
    refuse("flock", 0, ENOLCK);
    vdna_map_update *update = begin(made->path, 1);
    assert_true(was_refused());
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    assert_winter(made, 1);
}

static void a_call_that_an_update_cannot_do_without_is_named(void **state)
{
    static const refused_call cases[] = {
        {"calloc", ENOMEM, VDNA_ERR_NOMEM, "no memory left"},
        {"realloc", ENOMEM, VDNA_ERR_NOMEM, "winter.vdna: no memory left"},
        {"fsync", EIO, VDNA_ERR_IO, ": cannot fsync this directory: Input/output error"},
        {"openat", EACCES, VDNA_ERR_IO, ".commit: cannot open: Permission denied"},
        {"write", ENOSPC, VDNA_ERR_IO, "winter.vdna: cannot write: No space left on device"},
    };
    const directory *made = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        float embeddings[64];
        const vdna_experience e = experience_of("winter", 1, embeddings);
        vdna_map_update *update = NULL;
        refuse(cases[i].call, 0, cases[i].refusal);
        vdna_status status = vdna_map_update_open(made->path, &error, &update);
        if (status == VDNA_OK)
            status = vdna_map_update_add(update, &e, &error);
        assert_true(was_refused());
        assert_int_equal(status, cases[i].expected);
        assert_non_null(strstr(error.text, cases[i].reason));
        assert_non_null(strstr(error.text, made->path));
        vdna_map_update_close(update);
        assert_int_equal(files_in(made->path), 0);
    }
}

/* Add one experience to a map. */
static vdna_status add_one(const char *path, const vdna_experience *e, vdna_error *error)
{
    vdna_map_update *update = NULL;
    assert_int_equal(vdna_map_update_open(path, NULL, &update), VDNA_OK);
    assert_int_equal(vdna_map_update_add(update, e, NULL), VDNA_OK);
    const vdna_status status = vdna_map_update_commit(update, error);
    vdna_map_update_close(update);
    return status;
}

/* Check that a map of `winter` refuses an experience for this reason, and stays as it was. */
static void assert_does_not_join(const directory *made, const vdna_experience *e,
                                 const char *reason)
{
    vdna_error error = {""};
    assert_int_equal(add_one(made->path, e, &error), VDNA_ERR_MISMATCH);
    if (!strstr(error.text, made->path) || !strstr(error.text, reason) ||
        !strstr(error.text, "; the map is unchanged"))
        fail_msg("expected the path and \"%s\" in: %s", reason, error.text);
    assert_int_equal(files_in(made->path), 1);
    assert_winter(made, 1);
}

static void an_experience_that_does_not_compare_with_the_map_is_refused(void **state)
{
    static const float other_range[3][2] = {{-1, 1}, {0, 6}, {-2.5f, 3}};
    const directory *made = *state;
    float embeddings[64];
    vdna_experience e = experience_of("winter", 1, embeddings);
    assert_int_equal(add_one(made->path, &e, NULL), VDNA_OK);
    e = experience_of("summer", 2, embeddings);
    assert_does_not_join(made, &e,
                         "winter.vdna: does not compare with summer, which is to be added: "
                         "preprocessing is update 1 in one and update 2 in the other");
    e = experience_of("summer", 1, embeddings);
    e.identity.range = other_range[0];
    assert_does_not_join(made, &e, "the ranges, or the projections, differ");
    e.identity.range = sample_experience().identity.range;
    assert_int_equal(add_one(made->path, &e, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), 2);
}

static void experiences_of_one_update_compare_with_one_another(void **state)
{
    const directory *made = *state;
    float embeddings[64];
    vdna_error error = {""};
    vdna_map_update *update = begin(made->path, 1);
    const vdna_experience e = experience_of("summer", 2, embeddings);
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
    assert_int_equal(vdna_map_update_commit(update, &error), VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "winter.vdna.staged: does not compare with summer"));
    assert_non_null(strstr(error.text, "; the map is unchanged"));
    vdna_map_update_close(update);
    assert_int_equal(files_in(made->path), 0);
}

static void the_name_of_an_experience_in_a_file_of_another_name_is_taken(void **state)
{
    const directory *made = *state;
    float embeddings[64];
    vdna_error error = {""};
    vdna_experience e = experience_of("winter", 1, embeddings);
    assert_int_equal(vdna_experience_write(&e, path_in(made, "old.vdna"), NULL), VDNA_OK);
    assert_int_equal(add_one(made->path, &e, &error), VDNA_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "old.vdna: is already called winter"));
    assert_non_null(strstr(error.text, "; the map is unchanged"));
    assert_int_equal(files_in(made->path), 1);
    strcpy(e.name, "old"); /* which replaces it */
    assert_int_equal(add_one(made->path, &e, NULL), VDNA_OK);
    assert_int_equal(files_in(made->path), 1);
}

/* A damaged experience is no reason to lose a new one; readers say which is damaged. */
static void a_damaged_experience_and_other_files_hinder_no_addition(void **state)
{
    const directory *made = *state;
    float embeddings[64];
    const vdna_experience e = experience_of("winter", 1, embeddings);
    save_file(path_in(made, "cut.vdna"), "x", 1);
    save_file(path_in(made, ".hidden.vdna"), "x", 1);
    save_file(path_in(made, ".vdna"), "x", 1);
    save_file(path_in(made, "notes.txt"), "x", 1);
    assert_int_equal(add_one(made->path, &e, NULL), VDNA_OK);
    assert_int_equal(access(path_in(made, "winter.vdna"), F_OK), 0);
}

/* Of each function the calls of a commit, before the update is final. */
static void a_map_that_cannot_be_listed_stays_as_it_was(void **state)
{
    static const refused_call cases[] = {
        {"openat", EACCES, VDNA_ERR_IO, "winter.vdna.staged: cannot open: Permission denied"},
        {"readdir", EIO, VDNA_ERR_IO, "cannot read the directory: Input/output error"},
    };
    const directory *made = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vdna_error error = {""};
        vdna_map_update *update = begin(made->path, 1);
        refuse(cases[i].call, 0, cases[i].refusal);
        assert_int_equal(vdna_map_update_commit(update, &error), cases[i].expected);
        assert_true(was_refused());
        assert_non_null(strstr(error.text, cases[i].reason));
        assert_non_null(strstr(error.text, "; the map is unchanged"));
        assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
        vdna_map_update_close(update);
        assert_int_equal(unlink(path_in(made, "winter.vdna")), 0);
    }
}

static void a_path_that_is_too_long_is_refused(void **state)
{
    vdna_error error;
    vdna_map_update *update;
    static char path[5000];
    (void)state;
    memset(path, 'a', sizeof path - 1);
    assert_int_equal(vdna_map_update_open(path, &error, &update), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "aaa...: the path is too long"));
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
        CASE(an_update_of_nothing_changes_nothing),
        CASE(an_update_is_committed_once),
        CASE(an_update_that_could_not_be_finished_is_finished_by_the_next),
        CASE(a_commit_that_failed_before_it_was_final_can_be_tried_again),
        CASE(what_was_added_and_is_gone_leaves_the_map_as_it_was),
        CASE(an_update_stays_in_its_directory),
        CASE(an_experience_that_nobody_would_find_is_refused),
        cmocka_unit_test_setup_teardown(an_update_has_as_many_experiences_as_a_journal,
                                        set_up_directory_in_memory, tear_down_directory),
        CASE(a_crash_while_a_journal_is_made_leaves_nothing_for_long),
        CASE(one_experience_is_written_after_an_interrupted_update_is_finished),
        CASE(a_replacement_refused_at_any_call_leaves_the_old_file_or_the_new_one),
        CASE(without_locks_a_map_is_updated_all_the_same),
        CASE(a_call_that_an_update_cannot_do_without_is_named),
        CASE(an_experience_that_does_not_compare_with_the_map_is_refused),
        CASE(experiences_of_one_update_compare_with_one_another),
        CASE(the_name_of_an_experience_in_a_file_of_another_name_is_taken),
        CASE(a_damaged_experience_and_other_files_hinder_no_addition),
        CASE(a_map_that_cannot_be_listed_stays_as_it_was),
        cmocka_unit_test(a_path_that_is_too_long_is_refused),
    };
    return cmocka_run_group_tests_name("map_update", tests, NULL, NULL);
}
