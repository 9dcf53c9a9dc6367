/* Changes of a map on a machine that loses its power. Of a directory, the disk has what was synced;
 * of each change since then it may have the result or not, in any combination. Of a file that was
 * not synced itself it may have all, nothing, or parts. Every directory that this can leave must be
 * one state that the map was to have, and the next update must go on from there: also when the
 * power goes again meanwhile. Writers that leave out a step must be caught by this. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>

#include "map_versions.h"

enum {
    CHANGES_MAX = 128,
    FILES_MAX = 40,
    NAME_SIZE = 64,
    BYTES_MAX = 2048,
    NEVER = CHANGES_MAX + 1
};

typedef enum change_kind { SYNC, CREATE, RENAME, REMOVE } change_kind;

typedef struct change {
    change_kind kind;
    char name[NAME_SIZE];
    char old[NAME_SIZE]; /* RENAME: name before */
    int file;            /* CREATE, RENAME: which one has `name` then */
} change;

typedef struct content {
    unsigned char bytes[BYTES_MAX];
    size_t size;
    int synced_at; /* number of changes before it was on the disk */
} content;

/* What a disk may have of a file that was not synced. */
typedef enum remains { ALL, NOTHING, ZEROS, FIRST_HALF, SECOND_HALF, REMAINS } remains;

/* A directory: which file has each name. */
typedef struct entries {
    char names[FILES_MAX][NAME_SIZE];
    int files[FILES_MAX];
    int count;
} entries;

/* A step that a wrong writer leaves out. The first four are numbers of an update's syncs of the
 * directory. */
typedef enum omission {
    SYNC_AFTER_RECOVERY,
    SYNC_BEFORE_THE_JOURNAL,
    SYNC_AFTER_THE_JOURNAL,
    SYNC_BEFORE_THE_JOURNAL_GOES,
    SYNCS_OF_EXPERIENCES,
    SYNC_OF_THE_JOURNAL,
    THE_JOURNAL,
    OMISSIONS,
    NONE = OMISSIONS
} omission;

/* What happened to a directory. */
typedef struct story {
    int is_recorded;
    enum { WORKS, STOPS_AT_A_JOURNAL, REFUSES_TO_SYNC } disk;
    omission left_out;
    entries before;
    change changes[CHANGES_MAX];
    int count;
    content files[FILES_MAX];
    int file_count;
    int syncs; /* of the directory, in this update */
} story;

static story past;

static int *find(entries *in, const char *name)
{
    for (int i = 0; i < in->count; i++)
        if (strcmp(in->names[i], name) == 0)
            return &in->files[i];
    return NULL;
}

static void unlink_from(entries *in, const char *name)
{
    int *file = find(in, name);
    if (!file)
        return;
    const int at = (int)(file - in->files), last = --in->count;
    memmove(in->names[at], in->names[last], NAME_SIZE);
    in->files[at] = in->files[last];
}

static void link_into(entries *in, const char *name, int file)
{
    unlink_from(in, name);
    assert_in_range(in->count, 0, FILES_MAX - 1);
    snprintf(in->names[in->count], NAME_SIZE, "%s", name);
    in->files[in->count++] = file;
}

static void apply(entries *to, const change *made)
{
    if (made->kind == REMOVE)
        unlink_from(to, made->name);
    if (made->kind == RENAME)
        unlink_from(to, made->old);
    if (made->kind == RENAME || made->kind == CREATE)
        link_into(to, made->name, made->file);
}

/* What the directory is now. */
static entries present(void)
{
    entries now = past.before;
    for (int i = 0; i < past.count; i++)
        apply(&now, &past.changes[i]);
    return now;
}

static change *record(change_kind kind, const char *name)
{
    assert_in_range(past.count, 0, CHANGES_MAX - 1);
    change *made = &past.changes[past.count++];
    memset(made, 0, sizeof *made);
    made->kind = kind;
    snprintf(made->name, NAME_SIZE, "%s", name);
    return made;
}

/* Whether the wrong writer does not make this change. */
static int is_left_out(const char *name)
{
    return past.left_out == THE_JOURNAL && strcmp(name, ".commit") == 0;
}

int __real_openat(int where, const char *name, int flags, mode_t mode);
int __wrap_openat(int where, const char *name, int flags, mode_t mode);
int __wrap_openat(int where, const char *name, int flags, mode_t mode)
{
    const int file = __real_openat(where, name, flags, mode);
    if (past.is_recorded && file >= 0 && (flags & O_CREAT)) {
        assert_in_range(past.file_count, 0, FILES_MAX - 1);
        past.files[past.file_count].synced_at = NEVER;
        record(CREATE, name)->file = past.file_count++;
    }
    return file;
}

int __real_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new)
{
    const int result = __real_renameat(from, old, to, new);
    if (past.is_recorded && result == 0 && !is_left_out(new)) {
        entries now = present();
        change *made = record(RENAME, new);
        snprintf(made->old, NAME_SIZE, "%s", old);
        made->file = *find(&now, old);
        if (past.disk == STOPS_AT_A_JOURNAL && strcmp(new, ".commit") == 0)
            past.disk = REFUSES_TO_SYNC;
    }
    return result;
}

int __real_unlinkat(int where, const char *name, int flags);
int __wrap_unlinkat(int where, const char *name, int flags);
int __wrap_unlinkat(int where, const char *name, int flags)
{
    const int result = __real_unlinkat(where, name, flags);
    if (past.is_recorded && result == 0 && !is_left_out(name))
        record(REMOVE, name);
    return result;
}

/* Note what a file has. It is the one that was created last, as one is written at a time. */
static void record_content(int descriptor)
{
    content *file = &past.files[past.file_count - 1];
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    file->size = load_file(path, file->bytes, BYTES_MAX);
    assert_in_range(file->size, 1, BYTES_MAX - 1);
    const int is_journal = memcmp(file->bytes, "vdna-commit", 11) == 0;
    if (past.left_out != (is_journal ? SYNC_OF_THE_JOURNAL : SYNCS_OF_EXPERIENCES))
        file->synced_at = past.count;
}

/* Only recorded: to wait for the disk would show nothing. */
int __wrap_fsync(int descriptor);
int __wrap_fsync(int descriptor)
{
    struct stat about;
    if (past.disk == REFUSES_TO_SYNC) {
        errno = EIO;
        return -1;
    }
    assert_int_equal(fstat(descriptor, &about), 0);
    if (past.is_recorded && !S_ISDIR(about.st_mode))
        record_content(descriptor);
    else if (past.is_recorded && past.syncs++ != (int)past.left_out)
        record(SYNC, "");
    return 0;
}

/* A loss of power. */
typedef struct loss {
    int count;       /* changes before it */
    int synced;      /* of those, so many are on the disk for certain */
    unsigned lost;   /* a bit for each other one: it is not */
    remains remains; /* of each file that was not synced */
} loss;

static void save_remains(const char *path, const content *file, remains left)
{
    unsigned char bytes[BYTES_MAX] = {0};
    const size_t half = file->size / 2;
    if (left == ALL || left == FIRST_HALF)
        memcpy(bytes, file->bytes, left == ALL ? file->size : half);
    if (left == SECOND_HALF)
        memcpy(bytes + half, file->bytes + half, file->size - half);
    const int is_short = left == NOTHING || left == FIRST_HALF;
    save_file(path, bytes, !is_short ? file->size : left == NOTHING ? 0 : half);
}

/* Make a directory as the disk may have it.
 * @return whether it has files that were not synced */
static int make_after(const story *told, const directory *made, const loss *of)
{
    int has_remains = 0;
    entries on_disk = told->before;
    for (int i = 0; i < of->count; i++)
        if (i < of->synced || !(of->lost >> (i - of->synced) & 1))
            apply(&on_disk, &told->changes[i]);
    remove_all_files(made);
    for (int i = 0; i < on_disk.count; i++) {
        const content *file = &told->files[on_disk.files[i]];
        const int is_synced = file->synced_at <= of->count;
        save_remains(path_in(made, on_disk.names[i]), file, is_synced ? ALL : of->remains);
        has_remains |= !is_synced;
    }
    return has_remains;
}

/* The version of each experience of a map; 0 = there is none. */
typedef struct map_state {
    float version[NAMES];
} map_state;

static map_state all_of(float version)
{
    return (map_state){{version, version, version}};
}

/* @return whether the map can be opened */
static int read_state(const char *path, map_state *out_state)
{
    vdna_experience open[NAMES];
    uint32_t count = 0;
    memset(out_state, 0, sizeof *out_state);
    if (vdna_map_open(path, NAMES, NULL, open, &count) != VDNA_OK)
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        for (int n = 0; n < NAMES; n++)
            if (strcmp(open[i].name, names[n]) == 0)
                out_state->version[n] = open[i].embeddings[0];
        vdna_experience_close(&open[i]);
    }
    return 1;
}

/* What had been promised to a writer, and what it may have done besides. */
typedef struct promise {
    int changes;        /* made before this held */
    int oldest, newest; /* states that the map may have */
} promise;

/* What a map was to be by turns. */
typedef struct plan {
    map_state states[10];
    promise promises[10]; /* in order; that of the end has `changes` NEVER */
    int next;             /* the state that may come next, and the promise to be made next */
} plan;

/* All experiences compare, whatever their versions, so that a mixture could be opened. */
static vdna_experience version_named(const char *name, float version, float *embeddings)
{
    vdna_experience e = experience_of(name, version, embeddings);
    strcpy(e.identity.preprocessing, "the same");
    return e;
}

static vdna_status update_to(const directory *made, float version)
{
    vdna_map_update *update = NULL;
    past.syncs = 0;
    vdna_status status = vdna_map_update_open(made->path, NULL, &update);
    for (int i = 0; i < NAMES && status == VDNA_OK; i++) {
        float embeddings[64];
        const vdna_experience e = version_named(names[i], version, embeddings);
        status = vdna_map_update_add(update, &e, NULL);
    }
    if (status == VDNA_OK)
        status = vdna_map_update_commit(update, NULL);
    vdna_map_update_close(update);
    return status;
}

static void replace_one(const directory *made, const char *name, float version)
{
    char file[32];
    float embeddings[64];
    const vdna_experience e = version_named(name, version, embeddings);
    snprintf(file, sizeof file, "%s.vdna", name);
    assert_int_equal(vdna_experience_write(&e, path_in(made, file), NULL), VDNA_OK);
}

/* As a person does, who waits for no disk. */
static void delete_one(const directory *made, const char *file)
{
    const int where = open(made->path, O_RDONLY | O_DIRECTORY);
    assert_int_equal(unlinkat(where, file, 0), 0);
    close(where);
}

/* Begin to record, with what there is as what the disk has. */
static void begin_to_record(const directory *made)
{
    memset(&past, 0, sizeof past);
    past.left_out = NONE;
    DIR *listing = opendir(made->path);
    for (const struct dirent *entry; (entry = readdir(listing)) != NULL;)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            char name[NAME_SIZE];
            content *file = &past.files[past.file_count];
            snprintf(name, sizeof name, "%.*s", NAME_SIZE - 1, entry->d_name);
            file->size = load_file(path_in(made, name), file->bytes, BYTES_MAX);
            link_into(&past.before, name, past.file_count++);
        }
    closedir(listing);
    past.is_recorded = 1;
}

/* A plan that begins with all experiences of one version, and goes on to another. */
static plan plan_from(map_state first, map_state second)
{
    return (plan){.states = {first, second}, .promises = {{0, 0, 1}}, .next = 1};
}

/* From now on the newest state is certain, and the next one may come. */
static void promise_next(plan *made, int oldest, map_state next)
{
    made->promises[made->next] = (promise){past.count, oldest, made->next + 1};
    made->states[++made->next] = next;
}

/* From now on nothing else happens. */
static void promise_last(plan *made)
{
    made->promises[made->next] = (promise){past.count, made->next, made->next};
    made->promises[made->next + 1].changes = NEVER;
}

static int is_promised(const plan *made, int count, const map_state *found)
{
    const promise *now = made->promises;
    while (now[1].changes <= count)
        now++;
    for (int i = now->oldest; i <= now->newest; i++)
        if (memcmp(&made->states[i], found, sizeof *found) == 0)
            return 1;
    return 0;
}

/* Update what a loss of power left. @return whether that works, and leaves nothing behind */
static int can_go_on(const directory *made)
{
    const map_state expected = all_of(9);
    map_state found;
    return update_to(made, 9) == VDNA_OK && read_state(made->path, &found) &&
           memcmp(&found, &expected, sizeof found) == 0 && files_in(made->path) == NAMES &&
           access(path_in(made, ".commit"), F_OK) != 0;
}

/* What comes of all losses of power that there can be. */
typedef struct losses {
    long states, wrong;
    int apart; /* lose the power again while every so many-th state is updated; 0 = never */
    int first; /* states after the first loss */
} losses;

static void lose_power_everywhere(const directory *made, const plan *planned, losses *out);

/* Lose the power again at any moment of the update that follows a loss. */
static void lose_power_again(const directory *made, const map_state *left, losses *out)
{
    const story first = past;
    plan planned = plan_from(*left, all_of(9));
    begin_to_record(made);
    assert_int_equal(update_to(made, 9), VDNA_OK);
    promise_last(&planned);
    losses again = {.apart = 0};
    lose_power_everywhere(made, &planned, &again);
    out->states += again.states;
    out->wrong += again.wrong;
    past = first;
}

/* @return whether the loss leaves files that were not synced, of which other parts may remain */
static int lose_power(const directory *made, const plan *planned, const loss *of, losses *out)
{
    map_state found;
    const int has_remains = make_after(&past, made, of);
    const int is_right = read_state(made->path, &found) && is_promised(planned, of->count, &found);
    const int is_to_be_lost_again = out->apart > 0 && out->first++ % out->apart == 0;
    out->states++;
    if (is_right && is_to_be_lost_again)
        lose_power_again(made, &found, out);
    else if (!is_right || !can_go_on(made))
        out->wrong++;
    return has_remains;
}

/* Lose the power after each change, with each combination of those that are not on the disk, and
 * each remainder of the files that are not. */
static void lose_power_everywhere(const directory *made, const plan *planned, losses *out)
{
    loss of = {.count = planned->promises[0].changes};
    past.is_recorded = 0;
    for (; of.count <= past.count; of.count++) {
        for (int i = of.synced; i < of.count; i++)
            if (past.changes[i].kind == SYNC)
                of.synced = i + 1;
        assert_in_range(of.count - of.synced, 0, 16);
        for (of.lost = 0; of.lost < 1u << (of.count - of.synced); of.lost++)
            for (of.remains = ALL; of.remains < REMAINS; of.remains++)
                if (!lose_power(made, planned, &of, out))
                    break;
    }
}

/* Two updates; then one experience is replaced, another is deleted, and all are updated twice. */
static plan change_a_map(const directory *made, omission left_out)
{
    assert_int_equal(update_to(made, 1), VDNA_OK);
    begin_to_record(made);
    past.left_out = left_out;
    plan planned = plan_from(all_of(1), all_of(2));
    assert_int_equal(update_to(made, 2), VDNA_OK);
    promise_next(&planned, 1, all_of(3));
    assert_int_equal(update_to(made, 3), VDNA_OK);
    promise_next(&planned, 2, (map_state){{3, 3, 4}});
    replace_one(made, "winter", 4);
    promise_next(&planned, 3, (map_state){{3, 0, 4}});
    delete_one(made, "summer.vdna");
    promise_next(&planned, 3, all_of(5));
    assert_int_equal(update_to(made, 5), VDNA_OK);
    promise_next(&planned, 5, all_of(6));
    assert_int_equal(update_to(made, 6), VDNA_OK);
    promise_last(&planned);
    return planned;
}

/* With VDNA_ALL, the power goes again after each loss. */
static int apart(void)
{
    return getenv("VDNA_ALL") ? 1 : 50;
}

static void power_lost_at_any_moment_leaves_what_was_there_or_was_to_come(void **state)
{
    const directory *made = *state;
    const plan planned = change_a_map(made, NONE);
    losses found = {.apart = apart()};
    lose_power_everywhere(made, &planned, &found);
    print_message("%ld states\n", found.states);
    assert_int_equal(found.wrong, 0);
    assert_true(found.states > (apart() == 1 ? 100000 : 2000));
}

/* A journal that readers see and the disk may not have yet. */
static void power_lost_after_a_crash_that_left_a_journal_leaves_one_version(void **state)
{
    const directory *made = *state;
    map_state found;
    assert_int_equal(update_to(made, 1), VDNA_OK);
    begin_to_record(made);
    plan planned = plan_from(all_of(1), all_of(2));
    past.disk = STOPS_AT_A_JOURNAL;
    assert_int_equal(update_to(made, 2), VDNA_ERR_IO);
    assert_true(read_state(made->path, &found) && found.version[0] == 2);
    past.disk = WORKS;
    promise_next(&planned, 0, all_of(3));
    assert_int_equal(update_to(made, 3), VDNA_OK);
    promise_last(&planned);
    losses all = {.apart = apart()};
    lose_power_everywhere(made, &planned, &all);
    assert_int_equal(all.wrong, 0);
    assert_true(all.states > 200);
}

static void a_writer_that_leaves_out_a_step_is_caught(void **state)
{
    const directory *made = *state;
    for (omission left_out = 0; left_out < OMISSIONS; left_out++) {
        remove_all_files(made);
        const plan planned = change_a_map(made, left_out);
        losses found = {.apart = 0};
        lose_power_everywhere(made, &planned, &found);
        print_message("step %d left out: %ld of %ld states wrong\n", (int)left_out, found.wrong,
                      found.states);
        assert_true(found.wrong > 0);
    }
}

static void an_update_on_a_disk_that_does_not_sync_says_that_it_is_final(void **state)
{
    const directory *made = *state;
    vdna_error error;
    begin_to_record(made);
    past.disk = STOPS_AT_A_JOURNAL;
    assert_int_equal(update_all(made->path, 2, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "cannot fsync this directory: Input/output error; the "
                                       "update is final, and the next one of this map"));
    assert_true(version_of(made->path) == 2);
}

int main(void)
{
#define CASE(test) \
    cmocka_unit_test_setup_teardown(test, set_up_directory_in_memory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(power_lost_at_any_moment_leaves_what_was_there_or_was_to_come),
        CASE(power_lost_after_a_crash_that_left_a_journal_leaves_one_version),
        CASE(a_writer_that_leaves_out_a_step_is_caught),
        CASE(an_update_on_a_disk_that_does_not_sync_says_that_it_is_final),
    };
    return cmocka_run_group_tests_name("map_power", tests, NULL, NULL);
}
