/* Private to lib/map: an experience in a file that its caller opened. */
#ifndef VDNA_OPEN_H
#define VDNA_OPEN_H

#include <fcntl.h>

#include <vdna/map.h>

/* How to open it. O_NONBLOCK, so that a FIFO under the name of an experience is refused and not
 * waited for. */
#define VDNA_OPEN_FLAGS (O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)

/* vdna_experience_open() of a descriptor, which is closed in any case.
 * @param descriptor  what open() returned; if that is -1, errno says why
 * @param copy  whether to copy the file, which is mapped otherwise
 * @param path  for the error */
vdna_status vdna_open_descriptor(int descriptor, int copy, const char *path, vdna_error *error,
                                 vdna_experience *out_experience);

#endif
