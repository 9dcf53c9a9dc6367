/* Readers of a map while others change it: each read is the map of one moment. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <sys/file.h>
#include <time.h>

#include "map_versions.h"
#include "watched_calls.h"

/* Whether a call changes a directory, or waits until it is on the disk. */
static int is_change(const char *function)
{
    return strcmp(function, "renameat") == 0 || strcmp(function, "unlinkat") == 0 ||
           strcmp(function, "openat") == 0;
}

static int changes_left;

/* Let a writer crash before one of its changes; -1 = never. A writer all of whose further calls are
 * refused leaves what one leaves that is killed, and takes less time than a process. */
static int crash_before_a_change(const char *function)
{
    if (changes_left > 0 && is_change(function))
        changes_left--;
    else if (changes_left == 0 && is_change(function))
        changes_left = -2;
    return changes_left == -2 ? EIO : skip_the_disk(function);
}

/* Update the map as another process does. @return whether it came to its end */
static int update_elsewhere(const char *path, float version, int changes)
{
    changes_left = changes;
    watch = crash_before_a_change;
    const vdna_status status = update_all(path, version, NULL);
    watch = NULL;
    const int has_crashed = changes_left == -2;
    assert_true(has_crashed || status == VDNA_OK);
    return !has_crashed;
}

/* What happens while a map is read: an update before one of the reader's calls. */
static struct {
    const char *path;
    float version;
    int calls_left, changes, came_to_its_end;
} event;

static int let_it_happen(const char *function)
{
    (void)function;
    if (event.calls_left-- == 0)
        event.came_to_its_end = update_elsewhere(event.path, event.version, event.changes);
    return 0;
}

/* @return whether the event came while the map was read */
static int read_during_an_update(const char *path, float version, int calls, int changes,
                                 float *out_found, uint32_t *out_count)
{
    event.path = path;
    event.version = version;
    event.calls_left = calls;
    event.changes = changes;
    watch = let_it_happen;
    *out_found = version_of_some(path, out_count);
    watch = NULL;
    return event.calls_left < 0;
}

/* A map of one experience becomes one of three: a mixture would have the wrong number. */
static void an_update_at_any_call_of_a_reader_is_seen_whole_or_not_at_all(void **state)
{
    const directory *made = *state;
    int olds = 0, news = 0;
    event.came_to_its_end = 0;
    for (int changes = 0; !event.came_to_its_end; changes++) {
        int happened = 1;
        for (int calls = 0; happened; calls++) {
            float found;
            uint32_t count;
            remove_all_files(made);
            watch = skip_the_disk;
            assert_int_equal(update_some(made->path, 1, 1, NULL), VDNA_OK);
            happened = read_during_an_update(made->path, 2, calls, changes, &found, &count);
            assert_int_equal(count, found == 1 ? 1 : NAMES);
            *(found == 1 ? &olds : &news) += 1;
        }
    }
    assert_true(olds > 100 && news > 50);
}

/* An update that another has to finish: by then, or until it crashes as well after two renames. */
static void the_end_of_an_interrupted_update_at_any_call_of_a_reader_changes_nothing(void **state)
{
    static const int ends[] = {3, 8};
    const directory *made = *state;
    int has_ended = 0, olds = 0, news = 0;
    for (int changes = 6; !has_ended; changes++)
        for (int calls = 0, reads = 1; reads > 0; calls++) {
            reads = 0;
            for (size_t end = 0; end < sizeof ends / sizeof *ends; end++) {
                float found;
                uint32_t count;
                remove_all_files(made);
                watch = skip_the_disk;
                assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
                has_ended = update_elsewhere(made->path, 2, changes);
                const float before = version_of(made->path);
                reads += read_during_an_update(made->path, 3, calls, ends[end], &found, &count);
                assert_true(found == before);
                *(found == 1 ? &olds : &news) += 1;
            }
        }
    assert_true(olds > 50 && news > 50);
}

/* A writer whose steps come between the calls of a reader. */
static struct {
    vdna_map_update *update;
    const char *path;
    int journals_read, is_done;
} steps;

static void add(vdna_map_update *update, const char *name, float version)
{
    float embeddings[64];
    vdna_experience e = experience_of(name, version, embeddings);
    strcpy(e.identity.preprocessing, "the same");
    assert_int_equal(vdna_map_update_add(update, &e, NULL), VDNA_OK);
}

static vdna_map_update *begin(const char *path)
{
    vdna_map_update *update = NULL;
    assert_int_equal(vdna_map_update_open(path, NULL, &update), VDNA_OK);
    return update;
}

/* Commit an update, which is stuck when some of its files have got their names. */
static void commit_in_part(vdna_map_update *update, int renames)
{
    refuse("renameat", 1 + renames, EIO); /* the first is the journal's */
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_ERR_IO);
    assert_true(was_refused());
}

/* When the journal has been read for the first time, finish its update and stage the next; when it
 * has been found missing, commit that in part. */
static int step(const char *function)
{
    if (strcmp(function, "openat") == 0)
        steps.journals_read++;
    if (strcmp(function, "readdir") != 0 || steps.is_done)
        return 0;
    if (steps.journals_read == 1 && !steps.update) {
        steps.update = begin(steps.path);
        add(steps.update, "night", 3);
        add(steps.update, "summer", 3);
    }
    if (steps.journals_read > 1) {
        commit_in_part(steps.update, 1);
        steps.is_done = 1;
    }
    return 0;
}

/* The reader follows the old journal to a file of the next update, which is not final; and then
 * finds that file under its name, but another one not yet renamed. */
static void a_journal_that_goes_before_another_comes_does_not_lead_to_a_mixture(void **state)
{
    const directory *made = *state;
    vdna_experience open[2];
    uint32_t count = 0;
    vdna_map_update *update = begin(made->path);
    add(update, "night", 1);
    add(update, "summer", 1);
    assert_int_equal(vdna_map_update_commit(update, NULL), VDNA_OK);
    vdna_map_update_close(update);
    update = begin(made->path);
    add(update, "night", 2);
    commit_in_part(update, 0);
    vdna_map_update_close(update);

    memset(&steps, 0, sizeof steps);
    steps.path = made->path;
    watch = step;
    assert_int_equal(vdna_map_open(made->path, 2, NULL, open, &count), VDNA_OK);
    watch = NULL;
    assert_true(steps.is_done);
    assert_true(open[0].embeddings[0] == 3 && open[1].embeddings[0] == 3);
    vdna_experience_close(&open[0]);
    vdna_experience_close(&open[1]);
    vdna_map_update_close(steps.update);
}

/* Updates that come, crash and are finished between the calls of one read, at random, and which
 * versions the map had meanwhile. */
static struct {
    const char *path;
    uint64_t random;
    unsigned events_left;
    float last; /* the version of the last attempt */
    float current[5];
    unsigned versions;
} story;

static unsigned pick(unsigned limit)
{
    story.random ^= story.random >> 12;
    story.random ^= story.random << 25;
    story.random ^= story.random >> 27;
    return (unsigned)((story.random * 2685821657736338717u) >> 33) % limit;
}

static int tell_the_story(const char *function)
{
    const int is_of_files = strcmp(function, "openat") == 0 || strcmp(function, "fstatat") == 0 ||
                            strcmp(function, "readdir") == 0;
    if (is_of_files && story.events_left > 0 && pick(8) == 0) {
        story.events_left--;
        update_elsewhere(story.path, ++story.last, pick(3) == 0 ? -1 : (int)pick(24));
        story.current[story.versions++] = version_of(story.path);
    }
    return 0;
}

static void a_read_among_updates_and_crashes_is_a_version_that_was_there_meanwhile(void **state)
{
    const directory *made = *state;
    int skipped = 0;
    story.path = made->path;
    story.random = 1;
    story.last = 1;
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
    for (int reads = 0; reads < 120; reads++) {
        story.events_left = 4;
        story.versions = 1;
        story.current[0] = version_of(made->path);
        watch = tell_the_story;
        const float found = version_of(made->path);
        watch = NULL;
        unsigned at = 0;
        while (at < story.versions && story.current[at] != found)
            at++;
        assert_true(at < story.versions);
        skipped += at > 0;
    }
    assert_true(skipped > 25);
}

/* Update in a loop until the other end of a pipe is closed, with rests in which a slow reader comes
 * to its end: without one a map would always change while it is read. */
static void update_for_ever(const char *path, int stop)
{
    const struct timespec rest = {.tv_nsec = 2000000};
    char byte;
    changes_left = -1;
    watch = crash_before_a_change;
    for (float version = 2; read(stop, &byte, 1) != 0; version++) {
        if (update_all(path, version, NULL) != VDNA_OK)
            _exit(1);
        nanosleep(&rest, NULL);
    }
    _exit(0);
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void readers_and_a_writer_in_two_loops_never_meet_half_an_update(void **state)
{
    const directory *made = *state;
    int stop[2];
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
    assert_int_equal(pipe(stop), 0);
    assert_int_equal(fcntl(stop[0], F_SETFL, O_NONBLOCK), 0);
    const pid_t writer = fork();
    if (writer == 0) {
        close(stop[1]);
        update_for_ever(made->path, stop[0]);
    }
    int reads = 0, versions = 0;
    float last = 0;
    const double begin = seconds(), usual = begin + 1.5, longest = begin + 60;
    /* A sanitizer or a busy machine makes both loops slow: they meet as often all the same. */
    for (double now = begin; now < usual || ((reads <= 20 || versions <= 10) && now < longest);
         now = seconds()) {
        vdna_map_file files[NAMES];
        uint32_t count = 0;
        assert_int_equal(vdna_map_list(made->path, NAMES, NULL, files, &count), VDNA_OK);
        assert_int_equal(count, NAMES);
        const float version = version_of(made->path);
        assert_true(version >= last);
        versions += version > last;
        last = version;
        reads++;
    }
    int status;
    close(stop[1]);
    assert_int_equal(waitpid(writer, &status, 0), writer);
    assert_int_equal(status, 0);
    assert_true(reads > 20 && versions > 10);
}

static struct {
    const char *names[2];
    unsigned readdirs;
} restless;

/* Rename a file before each listing, of which all have as many entries: ".", "..", NAMES, no more.
 */
static int rename_a_file(const char *function)
{
    if (strcmp(function, "readdir") == 0 && restless.readdirs++ % (2 + NAMES + 1) == 0) {
        const unsigned turn = restless.readdirs / (2 + NAMES + 1) % 2;
        assert_int_equal(rename(restless.names[turn], restless.names[!turn]), 0);
    }
    return 0;
}

static void a_map_that_never_rests_is_an_error(void **state)
{
    const directory *made = *state;
    vdna_experience open[NAMES];
    vdna_error error = {""};
    uint32_t count = 77;
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
    restless.names[0] = path_in(made, "night.vdna");
    restless.names[1] = path_in(made, "evening.vdna");
    restless.readdirs = 0;
    memset(open, 0, sizeof open);
    watch = rename_a_file;
    assert_int_equal(vdna_map_open(made->path, NAMES, &error, open, &count), VDNA_ERR_IO);
    watch = NULL;
    assert_int_equal(restless.readdirs, 100 * 2 * (2 + NAMES + 1));
    assert_non_null(strstr(error.text, "changed each of the 100 times that it was read"));
    assert_int_equal(count, 77);
    for (int i = 0; i < NAMES; i++)
        assert_null(open[i].file_bytes);
}

static int tear_down(void **state)
{
    watch = NULL; /* a test that failed may have left a watcher */
    return tear_down_directory(state);
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_directory, tear_down)
#define CASE_IN_MEMORY(test) \
    cmocka_unit_test_setup_teardown(test, set_up_directory_in_memory, tear_down)
    const struct CMUnitTest tests[] = {
        CASE_IN_MEMORY(an_update_at_any_call_of_a_reader_is_seen_whole_or_not_at_all),
        CASE_IN_MEMORY(the_end_of_an_interrupted_update_at_any_call_of_a_reader_changes_nothing),
        CASE(a_journal_that_goes_before_another_comes_does_not_lead_to_a_mixture),
        CASE(a_read_among_updates_and_crashes_is_a_version_that_was_there_meanwhile),
        CASE(readers_and_a_writer_in_two_loops_never_meet_half_an_update),
        CASE(a_map_that_never_rests_is_an_error),
    };
    return cmocka_run_group_tests_name("map_concurrency", tests, NULL, NULL);
}
