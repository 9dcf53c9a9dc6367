#include "replace/replace.h"

#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Writers of one file at a time, and files that crashed writers left, until no name is free. */
#define PARTIAL_NAMES 100u

/* A file that is not complete yet is called "NAME.0.partial". */
#define PARTIAL_ENDING ".partial"

static vdna_status refused(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: cannot %s: %s; the file was not written, an older one is unchanged", path,
                     what, strerror(errno));
}

/* Open the directory that `path` is in. @return a descriptor; -1 and errno */
static int open_directory(const char *path, const char *name)
{
    char directory[VDNA_REPLACE_PATH_SIZE] = ".";
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

/* Whether an open file still has its name, which may be another file's by now. */
static int is_named(int file, int directory, const char *name)
{
    struct stat opened = {.st_ino = 0}, named = {.st_ino = 0};
    fstat(file, &opened);
    fstatat(directory, name, &named, AT_SYMLINK_NOFOLLOW);
    return opened.st_ino == named.st_ino;
}

/* Lock a new file; the lock tells it from one that a crash left. Where there are no locks, nobody
 * removes what crashes left, so do without.
 * @return whether the file is ours: 0 if somebody took it for such a leaving before it was locked
 */
static int keep(int file, int directory, const char *name)
{
    return (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) &&
           is_named(file, directory, name);
}

/* Create a file that was not there, with the access rights of any new file. The name does not end
 * as an experience does, so one that a crash leaves behind is never read. */
static int create_partial(vdna_replace *file)
{
    for (unsigned n = 0; n < PARTIAL_NAMES; n++) {
        if ((size_t)snprintf(file->partial, sizeof file->partial, "%s.%u" PARTIAL_ENDING,
                             file->name, n) >= sizeof file->partial) {
            errno = ENAMETOOLONG;
            return -1;
        }
        const int descriptor =
            openat(file->directory, file->partial, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno != EEXIST)
            return -1;
        if (descriptor >= 0 && keep(descriptor, file->directory, file->partial))
            return descriptor;
        if (descriptor >= 0)
            close(descriptor);
    }
    errno = EEXIST;
    return -1;
}

/* Whether there is something at `name` that renaming would destroy: a link, or /dev/null. What
 * becomes of a directory, rename() says. */
static int is_special(int directory, const char *name)
{
    struct stat found;
    return fstatat(directory, name, &found, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISREG(found.st_mode) &&
           !S_ISDIR(found.st_mode);
}

/* Begin in a directory that was just opened; -1 and errno if that failed. */
static vdna_status begin(int directory, const char *path, const char *name, vdna_error *error,
                         vdna_replace *out_file)
{
    if (directory < 0)
        return refused(path, "open its directory", error);
    if (is_special(directory, name)) {
        close(directory);
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: is a symbolic link or a device, which a file would replace; give the"
                         " path of the file itself, or remove it first",
                         path);
    }
    out_file->path = path;
    out_file->name = name;
    out_file->directory = directory;
    out_file->file = create_partial(out_file);
    if (out_file->file >= 0)
        return VDNA_OK;
    const vdna_status status = refused(path, "create a .partial file beside it", error);
    close(directory);
    return status;
}

static const char *last_part(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* see replace.h */
vdna_status vdna_replace_begin(const char *path, vdna_error *error, vdna_replace *out_file)
{
    const char *name = last_part(path);
    return begin(open_directory(path, name), path, name, error, out_file);
}

/* see replace.h */
vdna_status vdna_replace_begin_in(int directory, const char *path, vdna_error *error,
                                  vdna_replace *out_file)
{
    const int own = fcntl(directory, F_DUPFD_CLOEXEC, 0);
    return begin(own, path, last_part(path), error, out_file);
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

/* Give the new file a name, that of `path` or another, in place of what had it. */
static vdna_status take_name(vdna_replace *file, const char *name, int durability,
                             vdna_error *error)
{
    if (durability == VDNA_REPLACE_DURABLE && vdna_replace_sync(file->file) != 0)
        return fail_and_abandon(file, "fsync", error);
    if (renameat(file->directory, file->partial, file->directory, name) != 0)
        return fail_and_abandon(file, "rename a complete .partial file to it", error);
    return VDNA_OK;
}

/* see replace.h */
vdna_status vdna_replace_commit(vdna_replace *file, int durability, vdna_error *error)
{
    vdna_status status = take_name(file, file->name, durability, error);
    if (status != VDNA_OK)
        return status;
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
vdna_status vdna_replace_stage(vdna_replace *file, const char *name, vdna_error *error)
{
    const vdna_status status = take_name(file, name, VDNA_REPLACE_DURABLE, error);
    if (status == VDNA_OK)
        end(file);
    return status;
}

/* see replace.h */
void vdna_replace_abandon(vdna_replace *file)
{
    unlinkat(file->directory, file->partial, 0);
    end(file);
}

/* see replace.h */
size_t vdna_replace_target(const char *partial)
{
    static const char digits[] = "0123456789";
    const char *at = strrchr(partial, '.');
    if (!at || strcmp(at, PARTIAL_ENDING) != 0)
        return 0;
    const char *number = at;
    while (number > partial && strchr(digits, number[-1]))
        number--;
    return number < at && number > partial && number[-1] == '.' ? (size_t)(number - 1 - partial)
                                                                : 0;
}

/* see replace.h */
void vdna_replace_remove_orphan(int directory, const char *name)
{
    const int file = openat(directory, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return;
    /* With the lock, no writer can come to have this file; with the name checked after that, none
     * has another one of its name. */
    if (flock(file, LOCK_EX | LOCK_NB) == 0 && is_named(file, directory, name))
        unlinkat(directory, name, 0);
    close(file);
}
