/* Private to vdna: atomic replacement of a file, safe against any interruption. A new file is
 * written beside the old one and takes its name when complete.
 *
 *     status = vdna_replace_begin(path, error, &file);         then, if that was VDNA_OK,
 *     status = vdna_replace_write(&file, bytes, size, error);  as often as needed, and one of
 *     status = vdna_replace_commit(&file, durability, error);
 *     status = vdna_replace_stage(&file, name, error);
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

/* Bytes of the longest path that Linux takes, its NUL included. */
#define VDNA_REPLACE_PATH_SIZE 4096u

typedef struct vdna_replace {
    const char *path;                     /* the caller's */
    const char *name;                     /* its last part */
    int directory;                        /* descriptor of its directory */
    int file;                             /* descriptor of the new file, locked by flock() */
    char partial[VDNA_REPLACE_NAME_SIZE]; /* its name until it is complete */
} vdna_replace;

/* Create the new file beside `path`. A symbolic link or a device there is refused, because the new
 * file would take its place.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_begin(const char *path, vdna_error *error, vdna_replace *out_file);

/* The same in a directory that is open, wherever it is by now.
 * @param directory  a descriptor; stays the caller's
 * @param path  its last part is the file's name, the rest is for messages only */
vdna_status vdna_replace_begin_in(int directory, const char *path, vdna_error *error,
                                  vdna_replace *out_file);

/* Append to the new file. @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_write(const vdna_replace *file, const void *bytes, size_t size,
                               vdna_error *error);

/* Give the new file its name. Ends `file` in any case.
 * @param durability  VDNA_REPLACE_...
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_commit(vdna_replace *file, int durability, vdna_error *error);

/* Make the new file durable and give it another name in the same directory, in place of what had
 * that. Ends `file` in any case; after an error the new file is gone.
 * @param name  durable itself once the caller has synced the directory
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_replace_stage(vdna_replace *file, const char *name, vdna_error *error);

/* Remove the new file; the old one stays. Ends `file`. */
void vdna_replace_abandon(vdna_replace *file);

/* fsync() that retries after signals; a file system that cannot sync counts as success.
 * @return 0; -1 and errno */
int vdna_replace_sync(int descriptor);

/* Bytes of the name that a file is going to have. @return 0 if `partial` is not called as
 * incomplete files are, "NAME.0.partial" */
size_t vdna_replace_target(const char *partial);

/* Remove a file that is not locked, so that its writer is gone or has staged it. Nothing happens on
 * a file system without locks, where nobody can tell.
 * @param directory, name  where it is */
void vdna_replace_remove_orphan(int directory, const char *name);

#ifdef __cplusplus
}
#endif

#endif
