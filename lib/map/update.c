#include <dirent.h>
#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <vdna/map_trust.h>

#include "journal.h"
#include "members.h"
#include "write.h"

struct vdna_map_update {
    DIR *listing;
    int directory; /* its descriptor, locked by flock(), which ends with the process */
    int is_final;  /* committed, even if not all new files have their names yet */
    char path[VDNA_REPLACE_PATH_SIZE];
    vdna_journal added; /* whose new files are staged; sorted when they are committed */
};

static vdna_status lock(const vdna_map_update *update, vdna_error *error)
{
    /* A file system without locks: as good as it gets. */
    if (flock(update->directory, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
        return VDNA_OK;
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: another program is changing this map; wait until it has ended, then try"
                     " again",
                     update->path);
}

static int ends_in(const char *text, size_t length, const char *ending)
{
    const size_t size = strlen(ending);
    return length >= size && memcmp(text + length - size, ending, size) == 0;
}

/* Whether a writer of ours may have left this file in a map. */
static int is_leaving(const char *name)
{
    const size_t target = vdna_replace_target(name);
    return ends_in(name, strlen(name), VDNA_JOURNAL_STAGED) ||
           ends_in(name, target, VDNA_MAP_EXTENSION) || ends_in(name, target, VDNA_JOURNAL_FILE) ||
           ends_in(name, target, VDNA_MAP_TRUST_FILE);
}

/* Remove what writers left that are gone. Best effort: nothing reads such files. */
static void remove_leavings(const vdna_map_update *update)
{
    const struct dirent *entry;
    while ((entry = readdir(update->listing)))
        if (is_leaving(entry->d_name))
            vdna_replace_remove_orphan(update->directory, entry->d_name);
}

/* Finish an update that was interrupted after becoming final, and remove other leftovers. */
static vdna_status recover(const vdna_map_update *update, vdna_error *error)
{
    vdna_journal interrupted;
    vdna_status status = vdna_journal_read(update->directory, update->path, error, &interrupted);
    if (status == VDNA_OK && interrupted.count > 0)
        status = vdna_journal_finish(update->directory, update->path, &interrupted, error);
    vdna_journal_free(&interrupted);
    if (status != VDNA_OK)
        return status;
    remove_leavings(update);
    /* An old journal that came back after a loss of power would make files final that are only
     * staged, by this update and under the names of the old one. */
    if (vdna_replace_sync(update->directory) != 0)
        return vdna_fail(error, VDNA_ERR_IO, "%s: cannot fsync this directory: %s", update->path,
                         strerror(errno));
    return VDNA_OK;
}

static vdna_status open_directory(vdna_map_update *update, const char *directory, vdna_error *error)
{
    if ((size_t)snprintf(update->path, sizeof update->path, "%s", directory) >= sizeof update->path)
        return vdna_fail(error, VDNA_ERR_IO, "%.100s...: the path is too long", directory);
    update->listing = opendir(directory);
    if (!update->listing)
        return vdna_fail(error, VDNA_ERR_IO, "%s: cannot open this map directory: %s", directory,
                         strerror(errno));
    update->directory = dirfd(update->listing);
    const vdna_status status = lock(update, error);
    return status == VDNA_OK ? recover(update, error) : status;
}

/* see vdna/map.h */
vdna_status vdna_map_update_open(const char *directory, vdna_error *error,
                                 vdna_map_update **out_update)
{
    if (!directory || !out_update)
        return vdna_fail(error, VDNA_ERR_ARG, "map to update: no directory or no place for it");
    vdna_map_update *update = calloc(1, sizeof *update);
    if (!update)
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", directory);
    const vdna_status status = open_directory(update, directory, error);
    if (status == VDNA_OK)
        *out_update = update;
    else
        vdna_map_update_close(update);
    return status;
}

static vdna_status check_is_open(const vdna_map_update *update, vdna_error *error)
{
    if (!update->is_final)
        return VDNA_OK;
    return vdna_fail(error, VDNA_ERR_ARG,
                     "%s: this update has been committed; close it and open another", update->path);
}

/* What update_add() refuses besides what no experience may be. */
static vdna_status check_addition(const vdna_map_update *update, const vdna_experience *experience,
                                  const char *path, vdna_error *error)
{
    vdna_status status = check_is_open(update, error);
    if (status == VDNA_OK)
        status = vdna_write_check(experience, path, error);
    if (status != VDNA_OK)
        return status;
    if (experience->name[0] == '.')
        return vdna_fail(error, VDNA_ERR_ARG,
                         "%s: a name that begins with '.' hides its file from the readers of a"
                         " map; choose another",
                         path);
    if (update->added.count == VDNA_JOURNAL_NAMES_MAX)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "%s: expected at most %u experiences in one update; commit what there is,"
                         " and open another",
                         update->path, VDNA_JOURNAL_NAMES_MAX);
    return VDNA_OK;
}

static vdna_status stage(const vdna_map_update *update, const vdna_experience *experience,
                         const char *path, vdna_error *error)
{
    vdna_replace file;
    char staged[VDNA_MAP_FILE_SIZE];
    snprintf(staged, sizeof staged, "%s" VDNA_JOURNAL_STAGED, experience->name);
    vdna_status status = vdna_replace_begin_in(update->directory, path, error, &file);
    if (status == VDNA_OK)
        status = vdna_write_into(&file, experience, error);
    return status == VDNA_OK ? vdna_replace_stage(&file, staged, error) : status;
}

/* see vdna/map.h */
vdna_status vdna_map_update_add(vdna_map_update *update, const vdna_experience *experience,
                                vdna_error *error)
{
    if (!update || !experience)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "experience to add to a map: it or the map is missing");
    char path[VDNA_REPLACE_PATH_SIZE + VDNA_MAP_FILE_SIZE];
    snprintf(path, sizeof path, "%s/%.*s" VDNA_MAP_EXTENSION, update->path,
             (int)sizeof experience->name, experience->name);
    vdna_status status = check_addition(update, experience, path, error);
    if (status != VDNA_OK)
        return status;
    if (!vdna_journal_add(&update->added, experience->name))
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", path);
    status = stage(update, experience, path, error);
    if (status != VDNA_OK)
        update->added.count--;
    return status;
}

/* Refuse what a rename would refuse, while nothing has happened yet. */
static vdna_status check_place(const vdna_map_update *update, const char *name, vdna_error *error)
{
    struct stat about;
    char file[VDNA_MAP_FILE_SIZE];
    snprintf(file, sizeof file, "%s" VDNA_JOURNAL_STAGED, name);
    if (fstatat(update->directory, file, &about, AT_SYMLINK_NOFOLLOW) != 0)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s/%s: cannot find what was added: %s; the map is"
                         " unchanged",
                         update->path, file, strerror(errno));
    snprintf(file, sizeof file, "%s" VDNA_MAP_EXTENSION, name);
    if (fstatat(update->directory, file, &about, AT_SYMLINK_NOFOLLOW) == 0 &&
        S_ISDIR(about.st_mode))
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s/%s: is a directory, expected an experience file or nothing; remove"
                         " it; the map is unchanged",
                         update->path, file);
    return VDNA_OK;
}

static vdna_status check_places(vdna_map_update *update, vdna_error *error)
{
    const char *twice = vdna_journal_sort(&update->added);
    if (twice)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "%s/%s" VDNA_MAP_EXTENSION ": added twice in one update", update->path,
                         twice);
    vdna_status status = VDNA_OK;
    for (uint32_t i = 0; i < update->added.count && status == VDNA_OK; i++)
        status = check_place(update, update->added.names[i], error);
    return status;
}

/* Put the journal in its place. The names of the staged files must be on the disk before it. */
static vdna_status make_final(vdna_map_update *update, vdna_error *error)
{
    if (vdna_replace_sync(update->directory) != 0)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: cannot fsync this directory: %s; the map is unchanged", update->path,
                         strerror(errno));
    const vdna_status status =
        vdna_journal_write(update->directory, update->path, &update->added, error);
    update->is_final = status == VDNA_OK;
    return status;
}

/* see vdna/map.h */
vdna_status vdna_map_update_commit(vdna_map_update *update, vdna_error *error)
{
    if (!update)
        return vdna_fail(error, VDNA_ERR_ARG, "map to update: it is missing");
    vdna_status status = check_is_open(update, error);
    if (status != VDNA_OK || update->added.count == 0)
        return status;
    status = check_places(update, error);
    if (status == VDNA_OK)
        status = vdna_members_check(update->listing, update->path, &update->added, error);
    if (status == VDNA_OK)
        status = make_final(update, error);
    if (status == VDNA_OK)
        status = vdna_journal_finish(update->directory, update->path, &update->added, error);
    return status;
}

/* Remove what was added and not committed. */
static void discard(const vdna_map_update *update)
{
    for (uint32_t i = 0; i < update->added.count; i++) {
        char staged[VDNA_MAP_FILE_SIZE];
        snprintf(staged, sizeof staged, "%s" VDNA_JOURNAL_STAGED, update->added.names[i]);
        /* NOLINTNEXTLINE(clang-analyzer-unix.StdCLibraryFunctions): open, if anything was added */
        unlinkat(update->directory, staged, 0);
    }
}

/* see vdna/map.h */
void vdna_map_update_close(vdna_map_update *update)
{
    if (!update)
        return;
    if (!update->is_final)
        discard(update);
    vdna_journal_free(&update->added);
    if (update->listing)
        closedir(update->listing);
    free(update);
}
