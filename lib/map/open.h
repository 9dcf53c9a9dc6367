/* Private to lib/map: a file that its caller opened, and an experience in it. */
#ifndef VDNA_OPEN_H
#define VDNA_OPEN_H

#include <fcntl.h>

#include <vdna/map.h>

/* How to open it. O_NONBLOCK, so that a FIFO under the name of an experience is refused and not
 * waited for. */
#define VDNA_OPEN_FLAGS (O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)

/* The bytes of a file. They stay when the file is replaced or deleted, and those of a copy also
 * when it is written to or cut short. */
typedef struct vdna_file_bytes {
    void *bytes; /* aligned for any number; NULL = the file is empty */
    size_t size;
} vdna_file_bytes;

/* How to hold them. */
typedef enum vdna_open_how {
    VDNA_OPEN_MAPPED, /* every byte will be read, in order */
    VDNA_OPEN_COPIED,
    VDNA_OPEN_MAPPED_HEADER /* little but the beginning will be read */
} vdna_open_how;

/* Map a file into memory, or copy it. The descriptor is closed in any case.
 * @param descriptor  what open() returned; if that is -1, errno says why
 * @param path  for the error
 * @param out_file  to be ended with vdna_close_bytes()
 * @return VDNA_OK; VDNA_ERR_IO; VDNA_ERR_NOMEM for a copy */
vdna_status vdna_open_bytes(int descriptor, vdna_open_how how, const char *path, vdna_error *error,
                            vdna_file_bytes *out_file);

void vdna_close_bytes(const vdna_file_bytes *file);

/* vdna_experience_open() of a descriptor, which is closed in any case.
 * @param descriptor  what open() returned; if that is -1, errno says why
 * @param how  whether to copy the file, which is mapped otherwise, and to keep its thumbnails
 * @param path  for the error */
vdna_status vdna_open_descriptor(int descriptor, const vdna_map_config *how, const char *path,
                                 vdna_error *error, vdna_experience *out_experience);

/* vdna_experience_read_header() of a descriptor, which is closed in any case.
 * @param descriptor  what open() returned; if that is -1, errno says why
 * @param path  for the error */
vdna_status vdna_open_header(int descriptor, const char *path, vdna_error *error,
                             vdna_experience *out_experience);

#endif
