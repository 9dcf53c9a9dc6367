/* Private to vdna: atomic replacement of a file, safe against any interruption. A new file is
 * written beside the old one and takes its name when complete.
 *
 *     status = vdna_replace_begin(path, error, &file);         then, if that was VDNA_OK,
 *     status = vdna_replace_write(&file, bytes, size, error);  as often as needed, and one of
 *     status = vdna_replace_commit(&file, durability, error);
 *     status = vdna_replace_stage(&file, error);
 *     vdna_replace_abandon(&file); */
#ifndef VDNA_REPLACE_H
#define VDNA_REPLACE_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a commit waits for the disk. */
enum {
    VDNA_REPLACE_QUICK = 0,  /* after a power loss the old file, the new one or an empty one is
                                there: for files that can be made again and check themselves */
    VDNA_REPLACE_DURABLE = 1 /* after a power loss the old file or the new one is there */
};

#define VDNA_REPLACE_NAME_SIZE 256u

/* Ending of a file that is not complete yet: "NAME.0.partial". */
#define VDNA_REPLACE_ENDING ".partial"

typedef struct vdna_replace {
    const char *path;                     /* the caller's */
    const char *name;                     /* its last part */
    int directory;                        /* descriptor of its directory */
    int file;                             /* descriptor of the new file, locked by flock() */
    char partial[VDNA_REPLACE_NAME_SIZE]; /* its name until it is complete */
} vdna_replace;

/* Create the new file beside `path`.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_begin(const char *path, vdna_error *error, vdna_replace *out_file);

/* Append to the new file. @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_write(const vdna_replace *file, const void *bytes, size_t size,
                               vdna_error *error);

/* Give the new file its name. Ends `file` in any case.
 * @param durability  VDNA_REPLACE_...
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_commit(vdna_replace *file, int durability, vdna_error *error);

/* Make the new file durable under the name in `partial`, for the caller to rename. Ends `file` in
 * any case; after an error the new file is gone.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_stage(vdna_replace *file, vdna_error *error);

/* Remove the new file; the old one stays. Ends `file`. */
void vdna_replace_abandon(vdna_replace *file);

/* fsync() that retries after signals; a file system that cannot sync counts as success.
 * @return 0; -1 and errno */
int vdna_replace_sync(int descriptor);

/* Whether a partial file is the leftover of a dead writer.
 * @param directory, name  its location */
int vdna_replace_is_orphan(int directory, const char *name);

#ifdef __cplusplus
}
#endif

#endif
