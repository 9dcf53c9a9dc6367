#include <dirent.h>
#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "journal.h"

/* Bytes of the longest path that Linux accepts. */
#define PATH_SIZE 4096

/* The experience files of a directory, sorted by the bytes of their names. */
typedef struct listing {
    vdna_map_file *files; /* [count], allocated */
    uint32_t count;
} listing;

/* Hidden files are left out: copying tools put their own beside ours, such as "._winter.vdna". */
static int is_experience(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name), ending = strlen(VDNA_MAP_EXTENSION);
    return length > ending && length < VDNA_MAP_FILE_SIZE && entry->d_name[0] != '.' &&
           strcmp(entry->d_name + length - ending, VDNA_MAP_EXTENSION) == 0;
}

/* By bytes: strcoll() would depend on the locale. */
static int by_name(const void *a, const void *b)
{
    return strcmp(((const vdna_map_file *)a)->name, ((const vdna_map_file *)b)->name);
}

static vdna_status refused(const char *directory, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: cannot read the directory: %s; expected a map, a directory of"
                     " experience files",
                     directory, strerror(errno));
}

/* Append a file under its own name. @return 0 if there is no memory left */
static int append(listing *list, const char *name)
{
    vdna_map_file *files = realloc(list->files, ((size_t)list->count + 1) * sizeof *files);
    if (!files)
        return 0;
    list->files = files;
    vdna_map_file *file = &files[list->count++];
    snprintf(file->name, sizeof file->name, "%s", name);
    snprintf(file->file, sizeof file->file, "%s", name);
    return 1;
}

static vdna_map_file *find(const listing *list, const char *name)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (strcmp(list->files[i].name, name) == 0)
            return &list->files[i];
    return NULL;
}

/* Let the files of an interrupted update replace the old ones in the list. */
static int apply(const vdna_journal *journal, int directory, listing *list)
{
    for (uint32_t i = 0; i < journal->count; i++) {
        const vdna_journal_entry *entry = &journal->entries[i];
        struct stat about;
        if (fstatat(directory, entry->partial, &about, AT_SYMLINK_NOFOLLOW) != 0)
            continue; /* it has its name already */
        if (!find(list, entry->name) && !append(list, entry->name))
            return 0;
        memcpy(find(list, entry->name)->file, entry->partial, sizeof entry->partial);
    }
    return 1;
}

static vdna_status fill(DIR *stream, const char *directory, vdna_error *error, listing *list)
{
    vdna_journal journal;
    const vdna_status status = vdna_journal_read(dirfd(stream), directory, error, &journal);
    if (status != VDNA_OK)
        return status;
    int filled = 1;
    for (const struct dirent *entry = readdir(stream); entry && filled; entry = readdir(stream))
        if (is_experience(entry))
            filled = append(list, entry->d_name);
    if (filled)
        filled = apply(&journal, dirfd(stream), list);
    vdna_journal_free(&journal);
    return filled ? VDNA_OK : vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", directory);
}

static vdna_status list(const char *directory, vdna_error *error, listing *out_list)
{
    out_list->files = NULL;
    out_list->count = 0;
    DIR *stream = opendir(directory);
    if (!stream)
        return refused(directory, error);
    const vdna_status status = fill(stream, directory, error, out_list);
    closedir(stream);
    if (status != VDNA_OK) {
        free(out_list->files);
        return status;
    }
    if (out_list->count > 0)
        qsort(out_list->files, out_list->count, sizeof *out_list->files, by_name);
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_map_count(const char *directory, vdna_error *error, uint32_t *out_count)
{
    if (!directory || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to count: no directory or no place for it");
    listing files;
    const vdna_status status = list(directory, error, &files);
    if (status != VDNA_OK)
        return status;
    *out_count = files.count;
    free(files.files);
    return VDNA_OK;
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

static vdna_status open_file(const char *directory, const char *name, vdna_error *error,
                             vdna_experience *out_experience)
{
    char path[PATH_SIZE];
    if ((size_t)snprintf(path, sizeof path, "%s/%s", directory, name) >= sizeof path)
        return vdna_fail(error, VDNA_ERR_IO, "%s: the path of %s is too long", directory, name);
    return vdna_experience_open(path, error, out_experience);
}

/* Check experience `last` against those before it; all compare if each does with the first. */
static vdna_status check_last(const char *directory, const vdna_map_file *files,
                              const vdna_experience *experiences, uint32_t last, vdna_error *error)
{
    for (uint32_t i = 0; i < last; i++)
        if (strcmp(experiences[i].name, experiences[last].name) == 0)
            return vdna_fail(error, VDNA_ERR_MISMATCH,
                             "%s: %s and %s are both named %s, expected different names; remove or"
                             " rebuild one of them",
                             directory, files[i].name, files[last].name, experiences[i].name);
    vdna_error reason;
    if (last > 0 &&
        vdna_experience_compare(&experiences[0], &experiences[last], &reason) != VDNA_OK)
        return vdna_fail(error, VDNA_ERR_MISMATCH, "%s: %s", directory, reason.text);
    return VDNA_OK;
}

static vdna_status open_files(const char *directory, const listing *files, vdna_error *error,
                              vdna_experience *out_experiences)
{
    uint32_t open = 0;
    vdna_status status = VDNA_OK;
    while (status == VDNA_OK && open < files->count) {
        status = open_file(directory, files->files[open].file, error, &out_experiences[open]);
        if (status == VDNA_OK)
            status = check_last(directory, files->files, out_experiences, open++, error);
    }
    while (status != VDNA_OK && open > 0)
        vdna_experience_close(&out_experiences[--open]);
    return status;
}

/* see vdna/map.h */
vdna_status vdna_map_list(const char *directory, uint32_t capacity, vdna_error *error,
                          vdna_map_file *out_files, uint32_t *out_count)
{
    if (!directory || (capacity > 0 && !out_files) || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to list: no directory or no place for it");
    listing files;
    vdna_status status = list(directory, error, &files);
    if (status != VDNA_OK)
        return status;
    if (files.count > capacity)
        status = too_many(directory, files.count, capacity, error);
    else if (files.count > 0)
        memcpy(out_files, files.files, files.count * sizeof *out_files);
    if (status == VDNA_OK)
        *out_count = files.count;
    free(files.files);
    return status;
}

/* see vdna/map.h */
vdna_status vdna_map_open(const char *directory, uint32_t capacity, vdna_error *error,
                          vdna_experience *out_experiences, uint32_t *out_count)
{
    if (!directory || !out_experiences || !out_count)
        return vdna_fail(error, VDNA_ERR_ARG, "map to open: no directory or no place for it");
    listing files;
    vdna_status status = list(directory, error, &files);
    if (status != VDNA_OK)
        return status;
    status = check_count(directory, files.count, capacity, error);
    if (status == VDNA_OK)
        status = open_files(directory, &files, error, out_experiences);
    if (status == VDNA_OK)
        *out_count = files.count;
    free(files.files);
    return status;
}
