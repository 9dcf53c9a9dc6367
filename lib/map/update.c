#include <dirent.h>
#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "journal.h"
#include "write.h"

/* Bytes of the longest path that Linux accepts. */
#define PATH_SIZE 4096

struct vdna_map_update {
    int directory; /* locked by flock(), which ends with the process */
    char path[PATH_SIZE];
    vdna_journal staged; /* complete new files */
};

static vdna_status lock(const vdna_map_update *update, vdna_error *error)
{
    if (flock(update->directory, LOCK_EX | LOCK_NB) == 0)
        return VDNA_OK;
    if (errno == EWOULDBLOCK)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: another program is changing this map; wait until it has ended, then"
                         " try again",
                         update->path);
    /* The file system has no locks: go on without. */
    return VDNA_OK;
}

/* Remove the leftovers of dead writers. Best effort: nothing reads such files. */
static void remove_orphans(const vdna_map_update *update)
{
    DIR *listing = opendir(update->path);
    if (!listing)
        return;
    for (const struct dirent *entry = readdir(listing); entry; entry = readdir(listing))
        if (strstr(entry->d_name, VDNA_MAP_EXTENSION ".") &&
            vdna_replace_is_orphan(update->directory, entry->d_name))
            unlinkat(update->directory, entry->d_name, 0);
    closedir(listing);
}

/* Finish an update that was interrupted after becoming final, and remove other leftovers. */
static vdna_status recover(const vdna_map_update *update, vdna_error *error)
{
    vdna_journal interrupted;
    vdna_status status = vdna_journal_read(update->directory, update->path, error, &interrupted);
    if (status != VDNA_OK)
        return status;
    if (interrupted.entries)
        status = vdna_journal_finish(update->directory, update->path, &interrupted, error);
    vdna_journal_free(&interrupted);
    if (status == VDNA_OK)
        remove_orphans(update);
    return status;
}

static vdna_status open_directory(vdna_map_update *update, const char *directory, vdna_error *error)
{
    if ((size_t)snprintf(update->path, sizeof update->path, "%s", directory) >= sizeof update->path)
        return vdna_fail(error, VDNA_ERR_IO, "%.100s...: the path is too long", directory);
    update->directory = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (update->directory < 0)
        return vdna_fail(error, VDNA_ERR_IO, "%s: cannot open this map directory: %s", directory,
                         strerror(errno));
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
    update->directory = -1;
    const vdna_status status = open_directory(update, directory, error);
    if (status == VDNA_OK)
        *out_update = update;
    else
        vdna_map_update_close(update);
    return status;
}

/* A place for one more staged file; NULL if there is no memory left. */
static vdna_journal_entry *next_entry(vdna_journal *staged)
{
    const size_t count = (size_t)staged->count + 1;
    vdna_journal_entry *entries = realloc(staged->entries, count * sizeof *entries);
    if (!entries)
        return NULL;
    staged->entries = entries;
    return &entries[staged->count];
}

/* see vdna/map.h */
vdna_status vdna_map_update_add(vdna_map_update *update, const vdna_experience *experience,
                                vdna_error *error)
{
    if (!update || !experience)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "experience to add to a map: it or the map is missing");
    vdna_journal_entry *entry = next_entry(&update->staged);
    char path[PATH_SIZE];
    if (!entry)
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", update->path);
    const int length = snprintf(path, sizeof path, "%s/%.*s" VDNA_MAP_EXTENSION, update->path,
                                (int)sizeof experience->name, experience->name);
    if ((size_t)length >= sizeof path)
        return vdna_fail(error, VDNA_ERR_IO, "%s: the path is too long", update->path);

    vdna_replace file;
    vdna_status status = vdna_write_beside(experience, path, error, &file);
    if (status != VDNA_OK)
        return status;
    memcpy(entry->partial, file.partial, sizeof entry->partial);
    snprintf(entry->name, sizeof entry->name, "%s", file.name);
    status = vdna_replace_stage(&file, error);
    if (status == VDNA_OK)
        update->staged.count++;
    return status;
}

/* Refuse what a rename would refuse, before anything has changed. */
static vdna_status check_places(const vdna_map_update *update, vdna_error *error)
{
    for (uint32_t i = 0; i < update->staged.count; i++) {
        const char *name = update->staged.entries[i].name;
        struct stat about;
        if (fstatat(update->directory, name, &about, AT_SYMLINK_NOFOLLOW) == 0 &&
            S_ISDIR(about.st_mode))
            return vdna_fail(error, VDNA_ERR_IO,
                             "%s/%s: is a directory, expected an experience file or nothing; remove"
                             " it; the map is unchanged",
                             update->path, name);
        for (uint32_t j = 0; j < i; j++)
            if (strcmp(name, update->staged.entries[j].name) == 0)
                return vdna_fail(error, VDNA_ERR_ARG, "%s/%s: added twice in one update",
                                 update->path, name);
    }
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_map_update_commit(vdna_map_update *update, vdna_error *error)
{
    if (!update)
        return vdna_fail(error, VDNA_ERR_ARG, "map to update: it is missing");
    vdna_status status = check_places(update, error);
    /* The names of the new files must be on disk before the journal that lists them. */
    if (status == VDNA_OK && vdna_replace_sync(update->directory) != 0)
        status = vdna_fail(error, VDNA_ERR_IO,
                           "%s: cannot fsync this directory: %s; the map is"
                           " unchanged",
                           update->path, strerror(errno));
    if (status == VDNA_OK)
        status = vdna_journal_write(update->path, &update->staged, error);
    if (status != VDNA_OK)
        return status;
    status = vdna_journal_finish(update->directory, update->path, &update->staged, error);
    /* Final even if the last step failed: the new files are no longer ours to remove. */
    update->staged.count = 0;
    return status;
}

/* see vdna/map.h */
void vdna_map_update_close(vdna_map_update *update)
{
    if (!update)
        return;
    for (uint32_t i = 0; i < update->staged.count; i++)
        unlinkat(update->directory, update->staged.entries[i].partial, 0);
    vdna_journal_free(&update->staged);
    if (update->directory >= 0)
        close(update->directory);
    free(update);
}
