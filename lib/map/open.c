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

static vdna_status map_file(int descriptor, const char *path, vdna_error *error,
                            vdna_file_bytes *file)
{
    /* NOLINTNEXTLINE(clang-analyzer-unix.StdCLibraryFunctions): the size is not 0 */
    file->bytes = mmap(NULL, file->size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (file->bytes == MAP_FAILED)
        return refused(path, "map into memory", error);
    /* Every byte is about to be read, in order; only advice, so its result does not matter. */
    posix_madvise(file->bytes, file->size, POSIX_MADV_WILLNEED);
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

static vdna_status take_bytes(int descriptor, int copy, const char *path, vdna_error *error,
                              vdna_file_bytes *file)
{
    *file = (vdna_file_bytes){NULL, 0};
    const vdna_status status = size_of(descriptor, path, error, &file->size);
    if (status != VDNA_OK || file->size == 0)
        return status;
    return copy ? copy_file(descriptor, path, error, file)
                : map_file(descriptor, path, error, file);
}

/* see open.h */
vdna_status vdna_open_bytes(int descriptor, int copy, const char *path, vdna_error *error,
                            vdna_file_bytes *out_file)
{
    if (descriptor < 0)
        return refused(path, "open", error);
    const vdna_status status = take_bytes(descriptor, copy, path, error, out_file);
    close(descriptor);
    return status;
}

/* see open.h */
void vdna_close_bytes(const vdna_file_bytes *file)
{
    if (file->bytes)
        munmap(file->bytes, file->size);
}

static const char *remedy_of(vdna_status status)
{
    switch (status) {
    case VDNA_ERR_CHECKSUM:
        return "copy it again from its source, or rebuild it with `vdna build`";
    case VDNA_ERR_UNSUPPORTED:
        return "update this program, or rebuild the file with its own `vdna build`";
    case VDNA_ERR_NOMEM:
        return "free some";
    default:
        return "rebuild it with `vdna build`";
    }
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
    vdna_status status = vdna_open_bytes(descriptor, (int)how->copy, path, error, &file);
    if (status != VDNA_OK)
        return status;

    vdna_error reason;
    status = vdna_read(file.bytes, file.size, &reason, out_experience);
    if (status != VDNA_OK) {
        vdna_close_bytes(&file);
        return vdna_fail(error, status, "%s: %s; %s", path, reason.text, remedy_of(status));
    }
    out_experience->file_bytes = file.bytes;
    out_experience->file_size = file.size;
    if (how->no_thumbnails)
        give_back_thumbnails(out_experience);
    return VDNA_OK;
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

/* see vdna/map.h */
vdna_status vdna_experience_compare(const vdna_experience *a, const vdna_experience *b,
                                    vdna_error *error)
{
    if (!a || !b)
        return vdna_fail(error, VDNA_ERR_ARG, "experiences to compare must not be NULL");
    vdna_error reason;
    const vdna_status status = vdna_identity_compare(&a->identity, &b->identity, &reason);
    if (status != VDNA_OK)
        return vdna_fail(error, status,
                         "experiences %s and %s do not compare: %s; rebuild one of them with `vdna"
                         " build`, with the backbone, bins and ranges of the other",
                         a->name, b->name, reason.text);
    return VDNA_OK;
}

/* see vdna/map.h */
void vdna_experience_view(const vdna_experience *experience, vdna_hist_view *out_view)
{
    if (!experience || !out_view)
        return;
    out_view->range = experience->identity.range;
    out_view->counts = experience->counts;
    out_view->mass = experience->mass;
    out_view->neurons = experience->identity.neurons;
    out_view->bins = experience->identity.bins;
}

/* see vdna/map.h */
vdna_status vdna_experience_thumbnail(const vdna_experience *experience, uint32_t frame,
                                      const uint8_t **out_jpeg, size_t *out_size)
{
    if (!experience || !out_jpeg || !out_size || frame >= experience->frames)
        return VDNA_ERR_ARG;
    if (!experience->thumbnails)
        return VDNA_ERR_EMPTY;
    const uint32_t begin = frame > 0 ? experience->thumbnail_end[frame - 1] : 0;
    const uint32_t end = experience->thumbnail_end[frame];
    if (begin == end)
        return VDNA_ERR_EMPTY;
    *out_jpeg = experience->thumbnails + begin;
    *out_size = end - begin;
    return VDNA_OK;
}

/* Whether the definition of an embedding, in words, has the word "last=NAME". */
static int names_last_layer(const char *embedding, const vdna_tap *tap)
{
    static const char key[] = " last=";
    const char *const found = strstr(embedding, key);
    const char *const name = found ? found + sizeof key - 1 : "";
    if (strncmp(name, tap->name, tap->name_length) != 0)
        return 0;
    return name[tap->name_length] == '\0' || name[tap->name_length] == ' ';
}

/* see vdna/map.h */
uint32_t vdna_experience_counts_last_layer(const vdna_experience *experience)
{
    if (!experience || !experience->last_layer)
        return 0;
    const vdna_identity *const identity = &experience->identity;
    const char *rest = identity->taps;
    vdna_tap tap;
    if (vdna_taps_next(&rest, &tap) != VDNA_OK || *rest != '\0')
        return 0;
    return tap.samples == 1 && tap.neurons == experience->last_layer_dim &&
           names_last_layer(identity->embedding, &tap);
}
