#include "open.h"

#include <errno.h>
#include <fail.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "layout.h"
#include "read.h"

static vdna_status refused(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO, "%s: cannot %s: %s", path, what, strerror(errno));
}

static vdna_status size_of(int descriptor, const char *path, vdna_error *error, size_t *out_size)
{
    struct stat about;
    if (fstat(descriptor, &about) != 0)
        return refused(path, "examine", error);
    if (!S_ISREG(about.st_mode))
        return vdna_fail(error, VDNA_ERR_IO, "%s: not a regular file", path);
    if ((uintmax_t)about.st_size > SIZE_MAX)
        return vdna_fail(error, VDNA_ERR_IO,
                         "%s: the file is too large for the address space of this machine", path);
    *out_size = (size_t)about.st_size;
    return VDNA_OK;
}

static vdna_status map_file(int descriptor, int advice, const char *path, vdna_error *error,
                            vdna_file_bytes *file)
{
    /* NOLINTNEXTLINE(clang-analyzer-unix.StdCLibraryFunctions): the size is not 0 */
    file->bytes = mmap(NULL, file->size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (file->bytes == MAP_FAILED)
        return refused(path, "map into memory", error);
    posix_madvise(file->bytes, file->size, advice); /* only advice: its result does not matter */
    return VDNA_OK;
}

/* @return VDNA_OK, also at the end of a file that was cut short meanwhile, whose missing bytes are
 * 0: its checksum is wrong; VDNA_ERR_IO */
static vdna_status read_bytes(int descriptor, const char *path, vdna_error *error,
                              const vdna_file_bytes *file)
{
    size_t size = 0;
    ssize_t got = 1;
    while (size < file->size && got != 0) {
        got = read(descriptor, (char *)file->bytes + size, file->size - size);
        if (got < 0 && errno != EINTR)
            return refused(path, "read", error);
        size += got > 0 ? (size_t)got : 0;
    }
    return VDNA_OK;
}

/* Pages of our own rather than the heap's, so that closing is the same for both. */
static vdna_status copy_file(int descriptor, const char *path, vdna_error *error,
                             vdna_file_bytes *file)
{
    file->bytes =
        mmap(NULL, file->size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (file->bytes == MAP_FAILED)
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory for a copy of its %zu bytes", path,
                         file->size);
    const vdna_status status = read_bytes(descriptor, path, error, file);
    if (status != VDNA_OK)
        munmap(file->bytes, file->size);
    return status;
}

static vdna_status take_bytes(int descriptor, vdna_open_how how, const char *path,
                              vdna_error *error, vdna_file_bytes *file)
{
    *file = (vdna_file_bytes){NULL, 0};
    const vdna_status status = size_of(descriptor, path, error, &file->size);
    if (status != VDNA_OK || file->size == 0)
        return status;
    if (how == VDNA_OPEN_COPIED)
        return copy_file(descriptor, path, error, file);
    /* Without advice, the system would read far ahead of a header. */
    const int advice = how == VDNA_OPEN_MAPPED ? POSIX_MADV_WILLNEED : POSIX_MADV_RANDOM;
    return map_file(descriptor, advice, path, error, file);
}

/* see open.h */
vdna_status vdna_open_bytes(int descriptor, vdna_open_how how, const char *path, vdna_error *error,
                            vdna_file_bytes *out_file)
{
    if (descriptor < 0)
        return refused(path, "open", error);
    const vdna_status status = take_bytes(descriptor, how, path, error, out_file);
    close(descriptor);
    return status;
}

/* see open.h */
void vdna_close_bytes(const vdna_file_bytes *file)
{
    if (file->bytes)
        munmap(file->bytes, file->size);
}

/* Bytes of the file up to the end of the last tensor that `e` points to. */
static size_t size_in_use(const vdna_experience *e)
{
    const unsigned char *const begin = e->file_bytes;
    size_t size = 0;
    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_layout_of(e, fields);
    for (size_t f = 0; f < VDNA_FIELD_COUNT; f++) {
        const unsigned char *const data = fields[f].data;
        const size_t bytes = (size_t)vdna_field_elements(&fields[f]) * fields[f].width;
        if (data && (size_t)(data - begin) + bytes > size)
            size = (size_t)(data - begin) + bytes;
    }
    return size;
}

/* Unmap the whole pages that only thumbnails need; they are the end of a file of ours. */
static void give_back_thumbnails(vdna_experience *e)
{
    if (!e->thumbnails)
        return;
    e->thumbnails = NULL;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), used = size_in_use(e);
    e->thumbnail_end = NULL;
    e->thumbnail_bytes = 0;
    const size_t kept = (used + page - 1) / page * page;
    /* The cast drops const, which is for callers: munmap() changes no byte. */
    if (kept < e->file_size)
        munmap((char *)e->file_bytes + kept, e->file_size - kept);
    e->file_size = used;
}

/* see open.h */
vdna_status vdna_open_descriptor(int descriptor, const vdna_map_config *how, const char *path,
                                 vdna_error *error, vdna_experience *out_experience)
{
    vdna_file_bytes file = {NULL, 0};
    const vdna_open_how hold = how->copy ? VDNA_OPEN_COPIED : VDNA_OPEN_MAPPED;
    vdna_status status = vdna_open_bytes(descriptor, hold, path, error, &file);
    if (status != VDNA_OK)
        return status;

    vdna_error reason;
    status = vdna_read(file.bytes, file.size, VDNA_READ_DECODED, &reason, out_experience);
    if (status != VDNA_OK) {
        vdna_close_bytes(&file);
        return vdna_fail(error, status, "%s: %s; %s", path, reason.text, vdna_read_remedy(status));
    }
    out_experience->file_bytes = file.bytes;
    out_experience->file_size = file.size;
    if (how->no_thumbnails)
        give_back_thumbnails(out_experience);
    return VDNA_OK;
}

/* see open.h */
vdna_status vdna_open_header(int descriptor, const char *path, vdna_error *error,
                             vdna_experience *out_experience)
{
    vdna_file_bytes file = {NULL, 0};
    vdna_status status = vdna_open_bytes(descriptor, VDNA_OPEN_MAPPED_HEADER, path, error, &file);
    if (status != VDNA_OK)
        return status;
    vdna_error reason;
    status = vdna_read_header(file.bytes, file.size, &reason, out_experience);
    vdna_close_bytes(&file);
    if (status != VDNA_OK)
        return vdna_fail(error, status, "%s: %s; %s", path, reason.text, vdna_read_remedy(status));
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_experience_read_header(const char *path, vdna_error *error,
                                        vdna_experience *out_experience)
{
    if (!path || !out_experience)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "header of an experience to read: no path or no place for it");
    return vdna_open_header(open(path, VDNA_OPEN_FLAGS), path, error, out_experience);
}

/* see vdna/map.h */
vdna_status vdna_experience_open(const char *path, vdna_error *error,
                                 vdna_experience *out_experience)
{
    if (!path || !out_experience)
        return vdna_fail(error, VDNA_ERR_ARG, "experience to open: no path or no place for it");
    const vdna_map_config mapped = {.copy = 0};
    return vdna_open_descriptor(open(path, VDNA_OPEN_FLAGS), &mapped, path, error, out_experience);
}

/* see vdna/map.h */
void vdna_experience_close(vdna_experience *experience)
{
    if (!experience)
        return;
    /* The cast drops const, which is for callers: munmap() changes no byte. */
    if (experience->file_bytes) {
        vdna_read_free(experience);
        munmap((void *)experience->file_bytes, experience->file_size);
    }
    memset(experience, 0, sizeof *experience);
}
