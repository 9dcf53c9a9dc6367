/* Stand-ins for the system calls of the code under test (see vdna_watch_calls() in
 * test/unit/CMakeLists.txt). Before each, a watcher may refuse it, do something else first, or end
 * the process. */
#ifndef WATCHED_CALLS_H
#define WATCHED_CALLS_H

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>

#include <vdna/status.h>

/* Asked before each call. @return 0 = let it be made; PRETENDED; or an errno: it fails with that */
typedef int watcher(const char *function);

/* The call is not made, and yet succeeds: for calls of which nobody sees a result. */
#define PRETENDED (-1)

static watcher *watch;

/* What a watcher does itself is not watched. */
static int ask(const char *function)
{
    watcher *const asked = watch;
    const int errno_before = errno;
    if (!asked)
        return 0;
    watch = NULL;
    const int answer = asked(function);
    watch = asked;
    errno = answer > 0 ? answer : errno_before;
    return answer;
}

/* Wait for no disk: what a crashed process wrote is there all the same. */
static inline int skip_the_disk(const char *function)
{
    return strcmp(function, "fsync") == 0 ? PRETENDED : 0;
}

/* Refuse one call: the (calls + 1)th of a function, of which NULL is any. */
static struct {
    const char *function;
    int calls, refusal;
} refusals;

static int refuse_one(const char *function)
{
    if (refusals.function && strcmp(function, refusals.function) != 0)
        return 0;
    return refusals.calls-- == 0 ? refusals.refusal : 0;
}

/* A call that is refused, and what comes of it. */
typedef struct refused_call {
    const char *call;
    int refusal; /* errno */
    vdna_status expected;
    const char *reason; /* words of the error */
} refused_call;

static inline void refuse(const char *function, int calls, int refusal)
{
    refusals.function = function;
    refusals.calls = calls;
    refusals.refusal = refusal;
    watch = refuse_one;
}

/* @return whether the call that was to be refused has come */
static inline int was_refused(void)
{
    watch = NULL;
    return refusals.calls < 0;
}

#define STAND_IN(type, function, failure, parameters, arguments)   \
    type __real_##function parameters;                             \
    type __wrap_##function parameters;                             \
    type __wrap_##function parameters                              \
    {                                                              \
        const int answer = ask(#function);                         \
        return answer == 0           ? __real_##function arguments \
               : answer == PRETENDED ? (type)0                     \
                                     : (failure);                  \
    }

STAND_IN(ssize_t, read, -1, (int file, void *out, size_t size), (file, out, size))
/* What read() becomes where the sizes of buffers are checked. */
ssize_t __wrap___read_chk(int file, void *out, size_t size, size_t room);
ssize_t __wrap___read_chk(int file, void *out, size_t size, size_t room)
{
    return size <= room ? __wrap_read(file, out, size) : (abort(), -1);
}
STAND_IN(ssize_t, write, -1, (int file, const void *bytes, size_t size), (file, bytes, size))
STAND_IN(int, fsync, -1, (int file), (file))
STAND_IN(int, fstat, -1, (int file, struct stat *out), (file, out))
STAND_IN(int, flock, -1, (int file, int operation), (file, operation))
STAND_IN(int, openat, -1, (int where, const char *name, int flags, mode_t mode),
         (where, name, flags, mode))
STAND_IN(int, fstatat, -1, (int where, const char *name, struct stat *out, int flags),
         (where, name, out, flags))
STAND_IN(int, renameat, -1, (int from, const char *old, int to, const char *new),
         (from, old, to, new))
STAND_IN(int, unlinkat, -1, (int where, const char *name, int flags), (where, name, flags))
STAND_IN(DIR *, opendir, NULL, (const char *path), (path))
STAND_IN(struct dirent *, readdir, NULL, (DIR * stream), (stream))
STAND_IN(int, munmap, -1, (void *bytes, size_t size), (bytes, size))
STAND_IN(void *, malloc, NULL, (size_t size), (size))
STAND_IN(void *, calloc, NULL, (size_t count, size_t size), (count, size))
STAND_IN(void *, realloc, NULL, (void *block, size_t size), (block, size))

#endif
