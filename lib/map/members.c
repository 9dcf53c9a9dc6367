#include "members.h"

#include <errno.h>
#include <fail.h>
#include <stdlib.h>
#include <string.h>

#include "open.h"
#include "replace/replace.h"

/* see members.h */
int vdna_members_have(const char *file)
{
    const size_t length = strlen(file), ending = strlen(VDNA_MAP_EXTENSION);
    return length > ending && file[0] != '.' &&
           strcmp(file + length - ending, VDNA_MAP_EXTENSION) == 0;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(a, b);
}

static int is_added(const vdna_journal *added, const char *name)
{
    return bsearch(name, added->names, added->count, sizeof *added->names, compare_names) != NULL;
}

/* Whether the update puts another file in the place of this one. */
static int is_replaced(const vdna_journal *added, const char *file)
{
    char name[VDNA_MAP_FILE_SIZE];
    snprintf(name, sizeof name, "%.*s", (int)(strlen(file) - strlen(VDNA_MAP_EXTENSION)), file);
    return is_added(added, name);
}

static vdna_status read_header_of(int directory, const char *path, const char *file,
                                  vdna_error *error, vdna_experience *out)
{
    char whole[VDNA_REPLACE_PATH_SIZE + VDNA_MAP_FILE_SIZE];
    snprintf(whole, sizeof whole, "%s/%s", path, file);
    return vdna_open_header(openat(directory, file, VDNA_OPEN_FLAGS), whole, error, out);
}

static vdna_status check_alike(const char *path, const char *file, const vdna_experience *there,
                               const vdna_experience *added, vdna_error *error)
{
    if (strcmp(there->comparable, added->comparable) == 0)
        return VDNA_OK;
    vdna_error reason;
    if (vdna_identity_compare(&there->identity, &added->identity, &reason) == VDNA_OK)
        vdna_fail(&reason, VDNA_ERR_MISMATCH, "the ranges, or the projections, differ");
    return vdna_fail(error, VDNA_ERR_MISMATCH,
                     "%s/%s: does not compare with %s, which is to be added: %s; make that with the"
                     " backbone, bins and ranges of the map, or replace all of its experiences in"
                     " one update; the map is unchanged",
                     path, file, added->name, reason.text);
}

/* Check an experience that stays. */
static vdna_status check_staying(int directory, const char *path, const char *file,
                                 const vdna_journal *added, const vdna_experience *first,
                                 vdna_error *error)
{
    vdna_experience there;
    if (read_header_of(directory, path, file, NULL, &there) != VDNA_OK)
        return VDNA_OK;
    if (is_added(added, there.name))
        return vdna_fail(error, VDNA_ERR_MISMATCH,
                         "%s/%s: is already called %s, as what is to be added; choose another name;"
                         " the map is unchanged",
                         path, file, there.name);
    return check_alike(path, file, &there, first, error);
}

/* Check those that are added against the first of them. */
static vdna_status check_added(int directory, const char *path, const vdna_journal *added,
                               vdna_error *error, vdna_experience *out_first)
{
    vdna_experience next;
    for (uint32_t i = 0; i < added->count; i++) {
        vdna_experience *const there = i == 0 ? out_first : &next;
        char file[VDNA_MAP_FILE_SIZE];
        snprintf(file, sizeof file, "%s" VDNA_JOURNAL_STAGED, added->names[i]);
        vdna_error reason;
        vdna_status status = read_header_of(directory, path, file, &reason, there);
        if (status != VDNA_OK)
            return vdna_fail(error, status, "%s; the map is unchanged", reason.text);
        status = check_alike(path, file, there, out_first, error);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}

static vdna_status cannot_list(const char *path, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO, "%s: cannot read the directory: %s; the map is unchanged",
                     path, strerror(errno));
}

static vdna_status check_listed(DIR *listing, const char *path, const vdna_journal *added,
                                const vdna_experience *first, vdna_error *error)
{
    rewinddir(listing);
    for (;;) {
        errno = 0;
        const struct dirent *entry = readdir(listing);
        if (!entry)
            return errno == 0 ? VDNA_OK : cannot_list(path, error);
        if (!vdna_members_have(entry->d_name) || is_replaced(added, entry->d_name))
            continue;
        const vdna_status status =
            check_staying(dirfd(listing), path, entry->d_name, added, first, error);
        if (status != VDNA_OK)
            return status;
    }
}

/* see members.h */
vdna_status vdna_members_check(DIR *listing, const char *path, const vdna_journal *added,
                               vdna_error *error)
{
    vdna_experience first;
    const vdna_status status = check_added(dirfd(listing), path, added, error, &first);
    return status == VDNA_OK ? check_listed(listing, path, added, &first, error) : status;
}
