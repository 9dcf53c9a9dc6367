#include "replace/replace.h"

#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/* Bytes of the longest path that Linux accepts. */
#define PATH_SIZE 4096

/* Most partial files beside one file: concurrent writers and leftovers of crashed ones. */
#define PARTIAL_NAMES 100u

static vdna_status refused(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: cannot %s: %s; the file was not written, an older one is unchanged", path,
                     what, strerror(errno));
}

/* Open the directory that `path` is in. @return a descriptor; -1 and errno */
static int open_directory(const char *path, const char *name)
{
    char directory[PATH_SIZE] = ".";
    const size_t length = (size_t)(name - path);
    if (length >= sizeof directory) {
        errno = ENAMETOOLONG;
        return -1;
    }
    if (length > 0) {
        memcpy(directory, path, length);
        directory[length] = '\0';
    }
    return open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/* Create a new file with the usual access rights. Its name does not end like that of an experience,
 * so a leftover of a crash is never read. */
static int create_partial(vdna_replace *file)
{
    for (unsigned n = 0; n < PARTIAL_NAMES; n++) {
        if ((size_t)snprintf(file->partial, sizeof file->partial, "%s.%u.partial", file->name, n) >=
            sizeof file->partial) {
            errno = ENAMETOOLONG;
            return -1;
        }
        const int descriptor =
            openat(file->directory, file->partial, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        /* The lock tells a live writer's file from a leftover; file systems without locks do
         * without.
         */
        if (descriptor >= 0)
            flock(descriptor, LOCK_EX | LOCK_NB);
        if (descriptor >= 0 || errno != EEXIST)
            return descriptor;
    }
    return -1;
}

/* see replace.h */
vdna_status vdna_replace_begin(const char *path, vdna_error *error, vdna_replace *out_file)
{
    const char *slash = strrchr(path, '/');
    out_file->path = path;
    out_file->name = slash ? slash + 1 : path;
    out_file->directory = open_directory(path, out_file->name);
    if (out_file->directory < 0)
        return refused(path, "open its directory", error);
    out_file->file = create_partial(out_file);
    if (out_file->file >= 0)
        return VDNA_OK;
    const vdna_status status = refused(path, "create a .partial file beside it", error);
    close(out_file->directory);
    return status;
}

/* see replace.h */
vdna_status vdna_replace_write(const vdna_replace *file, const void *bytes, size_t size,
                               vdna_error *error)
{
    const char *at = bytes;
    while (size > 0) {
        const ssize_t written = write(file->file, at, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return refused(file->path, "write", error);
        at += written;
        size -= (size_t)written;
    }
    return VDNA_OK;
}

/* see replace.h */
int vdna_replace_sync(int descriptor)
{
    int result;
    do
        result = fsync(descriptor);
    while (result != 0 && errno == EINTR);
    /* Some file systems cannot sync and say EINVAL: nothing more can be done. */
    return result != 0 && errno == EINVAL ? 0 : result;
}

static void end(vdna_replace *file)
{
    close(file->file);
    close(file->directory);
}

static vdna_status fail_and_abandon(vdna_replace *file, const char *what, vdna_error *error)
{
    const vdna_status status = refused(file->path, what, error);
    vdna_replace_abandon(file);
    return status;
}

/* see replace.h */
vdna_status vdna_replace_commit(vdna_replace *file, int durability, vdna_error *error)
{
    if (durability == VDNA_REPLACE_DURABLE && vdna_replace_sync(file->file) != 0)
        return fail_and_abandon(file, "fsync", error);
    if (renameat(file->directory, file->partial, file->directory, file->name) != 0)
        return fail_and_abandon(file, "rename a complete .partial file to it", error);

    vdna_status status = VDNA_OK;
    if (durability == VDNA_REPLACE_DURABLE && vdna_replace_sync(file->directory) != 0)
        status = vdna_fail(error, VDNA_ERR_IO,
                           "%s: written, but cannot fsync its directory: %s; it may not survive a"
                           " loss of power, write it again",
                           file->path, strerror(errno));
    /* Write errors have been reported by now: closing has nothing to add. */
    end(file);
    return status;
}

/* see replace.h */
vdna_status vdna_replace_stage(vdna_replace *file, vdna_error *error)
{
    if (vdna_replace_sync(file->file) != 0)
        return fail_and_abandon(file, "fsync", error);
    end(file);
    return VDNA_OK;
}

/* see replace.h */
void vdna_replace_abandon(vdna_replace *file)
{
    unlinkat(file->directory, file->partial, 0);
    end(file);
}

/* see replace.h */
int vdna_replace_is_orphan(int directory, const char *name)
{
    const size_t length = strlen(name), ending = strlen(VDNA_REPLACE_ENDING);
    if (length <= ending || strcmp(name + length - ending, VDNA_REPLACE_ENDING) != 0)
        return 0;
    const int file = openat(directory, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return 0;
    const int is_free = flock(file, LOCK_EX | LOCK_NB) == 0;
    close(file);
    return is_free;
}
