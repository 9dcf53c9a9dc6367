/* Private to lib/map: replacing a file at once or not at all, whatever interrupts it.
 *
 *     status = vdna_replace_begin(path, error, &file);         then, if that was VDNA_OK,
 *     status = vdna_replace_write(&file, bytes, size, error);  as often as needed, and
 *     status = vdna_replace_commit(&file, error);              or vdna_replace_abandon(&file) */
#ifndef VDNA_REPLACE_H
#define VDNA_REPLACE_H

#include <stddef.h>
#include <vdna/status.h>

#define VDNA_REPLACE_NAME_SIZE 256u

typedef struct vdna_replace {
    const char *path;                     /* the caller's */
    const char *name;                     /* its last part */
    int directory;                        /* descriptor of where it is */
    int file;                             /* descriptor of the new file */
    char partial[VDNA_REPLACE_NAME_SIZE]; /* its name until it is complete: "NAME.0.partial" */
} vdna_replace;

/* Create the new file beside `path`.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_begin(const char *path, vdna_error *error, vdna_replace *out_file);

/* Append to the new file. @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_write(const vdna_replace *file, const void *bytes, size_t size,
                               vdna_error *error);

/* Make the new file durable and give it its name. Ends `file` in any case.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_commit(vdna_replace *file, vdna_error *error);

/* Remove the new file; the old one stays. Ends `file`. */
void vdna_replace_abandon(vdna_replace *file);

#endif
