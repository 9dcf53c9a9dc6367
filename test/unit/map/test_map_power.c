/* Updates of a map on a machine that loses its power. Of a directory, the disk has what was synced;
 * of each change since then it may have the result or not, in any combination. A file that was not
 * synced itself is empty. Every directory that this can leave must be one version of the map, and
 * the next update must go on from there. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>

#include "map_versions.h"

enum { CHANGES_MAX = 128, FILES_MAX = 32, NAME_SIZE = 64, BYTES_MAX = 2048 };

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

/* What happened to a directory that was empty. */
static struct {
    int is_recorded;
    enum { WORKS, STOPS_AT_A_JOURNAL, REFUSES_TO_SYNC } disk;
    change changes[CHANGES_MAX];
    int count;
    content files[FILES_MAX];
    int file_count;
} past;

/* A directory: which file has each name. */
typedef struct entries {
    char names[FILES_MAX][NAME_SIZE];
    int files[FILES_MAX];
    int count;
} entries;

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
    entries now = {.count = 0};
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

int __real_openat(int where, const char *name, int flags, mode_t mode);
int __wrap_openat(int where, const char *name, int flags, mode_t mode);
int __wrap_openat(int where, const char *name, int flags, mode_t mode)
{
    const int file = __real_openat(where, name, flags, mode);
    if (past.is_recorded && file >= 0 && (flags & O_CREAT)) {
        assert_in_range(past.file_count, 0, FILES_MAX - 1);
        past.files[past.file_count].synced_at = CHANGES_MAX;
        record(CREATE, name)->file = past.file_count++;
    }
    return file;
}

int __real_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new);
int __wrap_renameat(int from, const char *old, int to, const char *new)
{
    const int result = __real_renameat(from, old, to, new);
    if (past.is_recorded && result == 0) {
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
    if (past.is_recorded && result == 0)
        record(REMOVE, name);
    return result;
}

/* The file that a descriptor is of: the last one that was created, as one is written at a time. */
static void record_content(int descriptor)
{
    content *file = &past.files[past.file_count - 1];
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    file->size = load_file(path, file->bytes, BYTES_MAX);
    assert_in_range(file->size, 1, BYTES_MAX - 1);
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
    if (past.is_recorded && S_ISDIR(about.st_mode))
        record(SYNC, "");
    else if (past.is_recorded)
        record_content(descriptor);
    return 0;
}

/* Make a directory as the disk may have it when the power goes after `count` changes.
 * @param lost  a bit for each change since the last sync: it is not on the disk */
static void make_after_loss(const directory *made, int count, int synced, unsigned lost)
{
    entries on_disk = {.count = 0};
    for (int i = 0; i < count; i++)
        if (i < synced || !(lost >> (i - synced) & 1))
            apply(&on_disk, &past.changes[i]);
    for (int i = 0; i < on_disk.count; i++) {
        const content *file = &past.files[on_disk.files[i]];
        save_file(path_in(made, on_disk.names[i]), file->bytes,
                  file->synced_at <= count ? file->size : 0);
    }
}

/* What an update promised that had returned, and what one may have done that had not. */
typedef struct promise {
    int changes; /* made before this held */
    float oldest, newest;
} promise;

static void check_after_loss(const directory *made, const promise *promised)
{
    const float found = version_of(made->path);
    assert_true(found >= promised->oldest && found <= promised->newest);
    assert_int_equal(update_all(made->path, 9, NULL), VDNA_OK);
    assert_true(version_of(made->path) == 9);
    assert_int_equal(files_in(made->path), NAMES);
    assert_int_not_equal(access(path_in(made, ".commit"), F_OK), 0);
}

/* Lose the power after each change, with each combination of those that are not on the disk.
 * @param promises  in order; the last one has more changes than there are
 * @return how many combinations there were */
static int lose_power_everywhere(const directory *made, const promise *promises)
{
    int losses = 0, synced = 0;
    past.is_recorded = 0;
    for (int count = promises->changes; count <= past.count; count++) {
        while (promises[1].changes <= count)
            promises++;
        for (int i = synced; i < count; i++)
            if (past.changes[i].kind == SYNC)
                synced = i + 1;
        assert_in_range(count - synced, 0, 10);
        for (unsigned lost = 0; lost < 1u << (count - synced); lost++, losses++) {
            remove_all_files(made);
            make_after_loss(made, count, synced, lost);
            check_after_loss(made, promises);
        }
    }
    return losses;
}

static void begin_to_record(const directory *made)
{
    memset(&past, 0, sizeof past);
    past.is_recorded = 1;
    assert_int_equal(update_all(made->path, 1, NULL), VDNA_OK);
}

static void power_lost_during_two_updates_leaves_one_version(void **state)
{
    const directory *made = *state;
    begin_to_record(made);
    promise promises[] = {{past.count, 1, 2}, {0, 2, 2}, {0, 3, 3}, {CHANGES_MAX + 1, 0, 0}};
    assert_int_equal(update_all(made->path, 2, NULL), VDNA_OK);
    promises[1] = (promise){past.count, 2, 3};
    assert_int_equal(update_all(made->path, 3, NULL), VDNA_OK);
    promises[2].changes = past.count;
    assert_in_range(lose_power_everywhere(made, promises), 200, 2000);
}

/* A journal that readers see and the disk may not have yet. */
static void power_lost_after_a_crash_that_left_a_journal_leaves_one_version(void **state)
{
    const directory *made = *state;
    vdna_error error;
    begin_to_record(made);
    promise promises[] = {{past.count, 1, 3}, {0, 3, 3}, {CHANGES_MAX + 1, 0, 0}};
    past.disk = STOPS_AT_A_JOURNAL;
    assert_int_equal(update_all(made->path, 2, &error), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "cannot fsync this directory: Input/output error; the "
                                       "update is final, and the next one of this map"));
    assert_true(version_of(made->path) == 2);
    past.disk = WORKS;
    assert_int_equal(update_all(made->path, 3, NULL), VDNA_OK);
    promises[1].changes = past.count;
    assert_in_range(lose_power_everywhere(made, promises), 200, 2000);
}

int main(void)
{
#define CASE(test) \
    cmocka_unit_test_setup_teardown(test, set_up_directory_in_memory, tear_down_directory)
    const struct CMUnitTest tests[] = {
        CASE(power_lost_during_two_updates_leaves_one_version),
        CASE(power_lost_after_a_crash_that_left_a_journal_leaves_one_version),
    };
    return cmocka_run_group_tests_name("map_power", tests, NULL, NULL);
}
