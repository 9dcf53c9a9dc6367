#include <dirent.h>
#include <errno.h>
#include <fail.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <vdna/map.h>

/* Bytes of the longest path that Linux takes. */
#define PATH_SIZE 4096

/* The experience files of a directory, by the bytes of their names. */
typedef struct listing {
    struct dirent **entries;
    uint32_t count;
} listing;

/* Hidden files are left out: tools that copy put their own beside, as "._winter.vdna". */
static int is_experience(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name), ending = strlen(VDNA_MAP_EXTENSION);
    return length > ending && entry->d_name[0] != '.' &&
           strcmp(entry->d_name + length - ending, VDNA_MAP_EXTENSION) == 0;
}

/* Not alphasort(), whose order depends on the locale. */
static int by_bytes(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static vdna_status list(const char *directory, vdna_error *error, listing *out_list)
{
    const int count = scandir(directory, &out_list->entries, is_experience, by_bytes);
    if (count < 0)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: cannot read the directory: %s; expected a map, a directory of"
                         " experience files",
                         directory, strerror(errno));
    out_list->count = (uint32_t)count;
    return VDNA_OK;
}

static void free_list(listing *files)
{
    for (uint32_t i = 0; i < files->count; i++)
        free(files->entries[i]);
    free(files->entries);
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
    free_list(&files);
    return VDNA_OK;
}

static vdna_status check_count(const char *directory, uint32_t count, uint32_t capacity,
                               vdna_error *error)
{
    if (count == 0)
        return vdna_fail(error, VDNA_ERR_EMPTY,
                         "%s: no file ends in " VDNA_MAP_EXTENSION
                         ", expected at least one experience; make one with `vdna build`",
                         directory);
    if (count > capacity)
        return vdna_fail(error, VDNA_ERR_NOMEM,
                         "%s: %" PRIu32 " experiences, expected at most %" PRIu32
                         "; move some to another directory",
                         directory, count, capacity);
    return VDNA_OK;
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
static vdna_status check_last(const char *directory, const struct dirent *const *entries,
                              const vdna_experience *experiences, uint32_t last, vdna_error *error)
{
    for (uint32_t i = 0; i < last; i++)
        if (strcmp(experiences[i].name, experiences[last].name) == 0)
            return vdna_fail(error, VDNA_ERR_MISMATCH,
                             "%s: %s and %s are both named %s, expected different names; remove or"
                             " rebuild one of them",
                             directory, entries[i]->d_name, entries[last]->d_name,
                             experiences[i].name);
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
        status = open_file(directory, files->entries[open]->d_name, error, &out_experiences[open]);
        if (status == VDNA_OK)
            status = check_last(directory, (const struct dirent *const *)files->entries,
                                out_experiences, open++, error);
    }
    while (status != VDNA_OK && open > 0)
        vdna_experience_close(&out_experiences[--open]);
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
    free_list(&files);
    return status;
}
