#include <dirent.h>
#include <errno.h>
#include <fail.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "growth.h"
#include "journal.h"
#include "members.h"
#include "open.h"
#include "replace/replace.h"

/* How often to read a map that others change meanwhile. An update makes a reader read again when it
 * becomes final and when its journal goes. */
#define READS_MAX 100u

/* Bytes of vdna_map_config in the version that brought it. */
#define OLDEST_CONFIG sizeof(vdna_map_config)

static const vdna_map_config map_open_defaults = {.copy = 0};

/* An experience file of a directory. */
typedef struct listed {
    vdna_map_file names;
    dev_t device; /* both 0 if there is no such file */
    ino_t inode;
    vdna_error *damage; /* allocated: why it is left out; NULL = it is not */
} listed;

/* A directory as it was read once. */
typedef struct listing {
    vdna_journal journal; /* of an update that is final and not finished */
    listed *files;        /* [count], allocated, by the bytes of their names */
    uint32_t count;
} listing;

/* What is wanted of a directory. */
typedef struct request {
    const char *path;
    vdna_experience *experiences; /* to be opened; NULL = only the names are wanted */
    uint32_t capacity;            /* of `experiences` */
    vdna_map_config config;
    uint32_t open; /* experiences that are */
    DIR *stream;
} request;

/* By bytes: strcoll() would depend on the locale. */
static int by_name(const void *a, const void *b)
{
    return strcmp(((const listed *)a)->names.name, ((const listed *)b)->names.name);
}

static void sort(listing *list)
{
    if (list->count > 0)
        qsort(list->files, list->count, sizeof *list->files, by_name);
}

static vdna_status refused(const char *directory, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: cannot read the directory: %s; expected a map, a directory of"
                     " experience files",
                     directory, strerror(errno));
}

static vdna_status no_memory(const char *directory, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", directory);
}

/* Append a file that bears its own name. @return it; NULL if there is no memory left */
static listed *append(listing *list, const char *name)
{
    listed *files = realloc(list->files, ((size_t)list->count + 1) * sizeof *files);
    if (!files)
        return NULL;
    list->files = files;
    listed *file = &files[list->count++];
    file->damage = NULL;
    snprintf(file->names.name, sizeof file->names.name, "%s", name);
    snprintf(file->names.file, sizeof file->names.file, "%s", name);
    return file;
}

static vdna_status read_names(const request *wanted, vdna_error *error, listing *list)
{
    rewinddir(wanted->stream);
    for (;;) {
        errno = 0;
        const struct dirent *entry = readdir(wanted->stream);
        if (!entry)
            return errno == 0 ? VDNA_OK : refused(wanted->path, error);
        if (vdna_members_have(entry->d_name) && !append(list, entry->d_name))
            return no_memory(wanted->path, error);
    }
}

/* Put the staged files of an update that is final in the place of those that they replace. */
static vdna_status follow_journal(const request *wanted, vdna_error *error, listing *list)
{
    const uint32_t sorted = list->count;
    for (uint32_t i = 0; i < list->journal.count; i++) {
        const char *name = list->journal.names[i];
        listed key = {.damage = NULL};
        snprintf(key.names.name, sizeof key.names.name, "%s" VDNA_MAP_EXTENSION, name);
        listed *file = sorted > 0 ? bsearch(&key, list->files, sorted, sizeof key, by_name) : NULL;
        if (!file)
            file = append(list, key.names.name);
        if (!file)
            return no_memory(wanted->path, error);
        snprintf(file->names.file, sizeof file->names.file, "%s" VDNA_JOURNAL_STAGED, name);
    }
    sort(list);
    return VDNA_OK;
}

/* Note which file one of the names of `file` stands for. @return whether there is one */
static int examine(int directory, const char *name, listed *file)
{
    struct stat about;
    const int is_there = fstatat(directory, name, &about, 0) == 0;
    file->device = is_there ? about.st_dev : 0;
    file->inode = is_there ? about.st_ino : 0;
    return is_there;
}

static void examine_all(const request *wanted, listing *list)
{
    const int directory = dirfd(wanted->stream);
    for (uint32_t i = 0; i < list->count; i++) {
        listed *file = &list->files[i];
        /* A staged file that is not there has got its name. */
        if (!examine(directory, file->names.file, file) &&
            examine(directory, file->names.name, file))
            memcpy(file->names.file, file->names.name, sizeof file->names.file);
    }
}

static void free_listing(listing *list)
{
    vdna_journal_free(&list->journal);
    for (uint32_t i = 0; i < list->count; i++)
        free(list->files[i].damage);
    free(list->files);
    list->files = NULL;
    list->count = 0;
}

/* List a directory. The journal comes first: whatever it lists is complete.
 * @param out_list  empty after an error */
static vdna_status list(const request *wanted, vdna_error *error, listing *out_list)
{
    memset(out_list, 0, sizeof *out_list);
    vdna_status status =
        vdna_journal_read(dirfd(wanted->stream), wanted->path, error, &out_list->journal);
    if (status == VDNA_OK)
        status = read_names(wanted, error, out_list);
    sort(out_list);
    if (status == VDNA_OK)
        status = follow_journal(wanted, error, out_list);
    if (status == VDNA_OK)
        examine_all(wanted, out_list);
    else
        free_listing(out_list);
    return status;
}

static int is_same_journal(const vdna_journal *a, const vdna_journal *b)
{
    if (a->count != b->count)
        return 0;
    for (uint32_t i = 0; i < a->count; i++)
        if (strcmp(a->names[i], b->names[i]) != 0)
            return 0;
    return 1;
}

static int is_same_file(const listed *a, const listed *b)
{
    return a->inode == b->inode && a->device == b->device;
}

static int is_same(const listing *a, const listing *b)
{
    if (a->count != b->count || !is_same_journal(&a->journal, &b->journal))
        return 0;
    for (uint32_t i = 0; i < a->count; i++)
        if (by_name(&a->files[i], &b->files[i]) != 0 || !is_same_file(&a->files[i], &b->files[i]))
            return 0;
    return 1;
}

static vdna_status too_many(const char *directory, uint32_t count, uint32_t capacity,
                            vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_NOMEM,
                     "%s: %" PRIu32 " experiences, expected at most %" PRIu32
                     "; move some to another directory",
                     directory, count, capacity);
}

static vdna_status check_count(const char *directory, uint32_t count, uint32_t capacity,
                               vdna_error *error)
{
    if (count == 0)
        return vdna_fail(error, VDNA_ERR_EMPTY,
                         "%s: no file ends in " VDNA_MAP_EXTENSION
                         ", expected at least one experience; make one with `vdna build`",
                         directory);
    return count > capacity ? too_many(directory, count, capacity, error) : VDNA_OK;
}

/* Open a file that was listed, and note which one that turned out to be. */
static vdna_status open_file(const request *wanted, listed *file, vdna_error *error,
                             vdna_experience *out_experience)
{
    char path[VDNA_REPLACE_PATH_SIZE];
    const char *const name = file->names.file;
    if ((size_t)snprintf(path, sizeof path, "%s/%s", wanted->path, name) >= sizeof path)
        return vdna_fail(error, VDNA_ERR_IO, "%s: the path of %s is too long", wanted->path, name);
    /* NOLINTBEGIN(clang-analyzer-unix.StdCLibraryFunctions): dirfd() of a stream cannot fail */
    int descriptor = openat(dirfd(wanted->stream), name, VDNA_OPEN_FLAGS);
    /* A staged file may have got its name just now. */
    if (descriptor < 0 && errno == ENOENT)
        descriptor = openat(dirfd(wanted->stream), file->names.name, VDNA_OPEN_FLAGS);
    /* NOLINTEND(clang-analyzer-unix.StdCLibraryFunctions) */
    struct stat about;
    if (descriptor >= 0 && fstat(descriptor, &about) == 0) {
        file->device = about.st_dev;
        file->inode = about.st_ino;
    }
    return vdna_open_descriptor(descriptor, &wanted->config, path, error, out_experience);
}

/* Check the last experience, that of the last file, against those before it; all compare if each
 * does with the first. */
static vdna_status check_last(const request *wanted, const listed *files, uint32_t last_file,
                              vdna_error *error)
{
    const vdna_experience *const first = wanted->experiences, *const last =
                                                                  first + wanted->open - 1;
    const vdna_experience *other = first;
    for (uint32_t i = 0; i < last_file; i++) {
        if (files[i].damage)
            continue;
        if (strcmp(other->name, last->name) == 0)
            return vdna_fail(error, VDNA_ERR_MISMATCH,
                             "%s: %s and %s are both named %s, expected different names; remove or"
                             " rebuild one of them",
                             wanted->path, files[i].names.name, files[last_file].names.name,
                             last->name);
        other++;
    }
    vdna_error reason;
    if (last > first && vdna_experience_compare(first, last, &reason) != VDNA_OK)
        return vdna_fail(error, VDNA_ERR_MISMATCH, "%s: %s", wanted->path, reason.text);
    return VDNA_OK;
}

static void close_files(request *wanted)
{
    for (uint32_t i = 0; i < wanted->open; i++)
        vdna_experience_close(&wanted->experiences[i]);
    wanted->open = 0;
}

/* Whether a file that could not be opened is to be left out. */
static int is_left_out(const request *wanted, vdna_status status)
{
    return wanted->config.left_out &&
           (status == VDNA_ERR_FORMAT || status == VDNA_ERR_CHECKSUM || status == VDNA_ERR_IO);
}

/* Note why a file is left out. */
static vdna_status leave_out(const request *wanted, listed *file, const vdna_error *reason,
                             vdna_error *error)
{
    file->damage = malloc(sizeof *file->damage);
    if (!file->damage)
        return no_memory(wanted->path, error);
    *file->damage = *reason;
    return VDNA_OK;
}

/* Open what was listed, as far as it goes. */
static vdna_status open_files(request *wanted, const listing *list, vdna_error *error)
{
    vdna_error reason;
    vdna_status first_damage = VDNA_OK;
    vdna_status status = check_count(wanted->path, list->count, wanted->capacity, error);
    for (uint32_t i = 0; i < list->count && status == VDNA_OK; i++) {
        listed *file = &list->files[i];
        status = open_file(wanted, file, &reason, &wanted->experiences[wanted->open]);
        if (status == VDNA_OK) {
            wanted->open++;
            status = check_last(wanted, list->files, i, error);
        } else if (is_left_out(wanted, status)) {
            first_damage = first_damage == VDNA_OK ? status : first_damage;
            status = leave_out(wanted, file, &reason, error);
        } else {
            vdna_fail(error, status, "%s", reason.text);
        }
    }
    if (status == VDNA_OK && wanted->open == 0)
        return vdna_fail(error, first_damage, "%s", list->files[0].damage->text);
    return status;
}

static void report_left_out(const request *wanted, const listing *list)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (list->files[i].damage)
            wanted->config.left_out(wanted->config.context, list->files[i].damage->text);
}

/* Read a map between two listings. If they are the same, so was the map at the moment when the
 * second one began: a file that is open cannot come back as another, so no name can have stood for
 * one, then for another, then for the first again. Hence they stay open until then, whether all
 * went well or not. Time stamps are too coarse to tell.
 * @param out_list  the second listing, to be freed
 * @param out_is_settled  0 if anything changed
 * @return VDNA_OK, and all are open if that was wanted and nothing changed; otherwise none is */
static vdna_status read_once(request *wanted, vdna_error *error, listing *out_list,
                             int *out_is_settled)
{
    listing before;
    vdna_status found = VDNA_OK, status = list(wanted, error, &before);
    if (status == VDNA_OK && wanted->experiences)
        found = open_files(wanted, &before, error);
    if (status == VDNA_OK)
        status = list(wanted, error, out_list);
    *out_is_settled = status != VDNA_OK || is_same(&before, out_list);
    if (status == VDNA_OK)
        status = found;
    if (status != VDNA_OK || !*out_is_settled)
        close_files(wanted);
    else
        report_left_out(wanted, &before);
    free_listing(&before);
    return status;
}

/* Read a map until it does not change meanwhile. @param out_list  to be freed after VDNA_OK */
static vdna_status read_map(request *wanted, vdna_error *error, listing *out_list)
{
    int is_settled = 0;
    vdna_status status = VDNA_OK;
    wanted->stream = opendir(wanted->path);
    if (!wanted->stream)
        return refused(wanted->path, error);
    for (unsigned reads = 0; reads < READS_MAX && !is_settled; reads++) {
        memset(out_list, 0, sizeof *out_list);
        status = read_once(wanted, error, out_list, &is_settled);
        if (status != VDNA_OK || !is_settled)
            free_listing(out_list);
    }
    closedir(wanted->stream);
    if (!is_settled)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: changed each of the %u times that it was read; wait until whatever"
                         " changes it has ended, then try again",
                         wanted->path, READS_MAX);
    return status;
}

/* see vdna/map.h */
vdna_status vdna_map_count(const char *directory, vdna_error *error, uint32_t *out_count)
{
    if (!directory || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to count: no directory or no place for it");
    listing files;
    request wanted = {.path = directory};
    const vdna_status status = read_map(&wanted, error, &files);
    if (status != VDNA_OK)
        return status;
    *out_count = files.count;
    free_listing(&files);
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_map_list(const char *directory, uint32_t capacity, vdna_error *error,
                          vdna_map_file *out_files, uint32_t *out_count)
{
    if (!directory || (capacity > 0 && !out_files) || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to list: no directory or no place for it");
    listing files;
    request wanted = {.path = directory};
    vdna_status status = read_map(&wanted, error, &files);
    if (status != VDNA_OK)
        return status;
    if (files.count <= capacity) {
        for (uint32_t i = 0; i < files.count; i++)
            out_files[i] = files.files[i].names;
        *out_count = files.count;
    } else {
        status = too_many(directory, files.count, capacity, error);
    }
    free_listing(&files);
    return status;
}

/* see vdna/map.h */
void vdna_map_config_init(vdna_map_config *config)
{
    vdna_config_write(config, OLDEST_CONFIG, &map_open_defaults, sizeof map_open_defaults);
}

/* see vdna/map.h */
vdna_status vdna_map_open_as(const vdna_map_config *config, const char *directory,
                             uint32_t capacity, vdna_error *error, vdna_experience *out_experiences,
                             uint32_t *out_count)
{
    if (!directory || !out_experiences || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to open: no directory or no place for it");
    listing files;
    request wanted = {directory, out_experiences, capacity, map_open_defaults, 0, NULL};
    if (!vdna_config_read(config, OLDEST_CONFIG, &wanted.config, sizeof wanted.config) ||
        wanted.config.copy > 1 || wanted.config.no_thumbnails > 1)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "%s: cannot be opened as wanted: copy or no_thumbnails is neither 0 nor 1,"
                         " or the config is not from vdna_map_config_init()",
                         directory);
    const vdna_status status = read_map(&wanted, error, &files);
    if (status != VDNA_OK)
        return status;
    *out_count = wanted.open;
    free_listing(&files);
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_map_open(const char *directory, uint32_t capacity, vdna_error *error,
                          vdna_experience *out_experiences, uint32_t *out_count)
{
    vdna_map_config config;
    vdna_map_config_init(&config);
    return vdna_map_open_as(&config, directory, capacity, error, out_experiences, out_count);
}
