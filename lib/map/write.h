/* Private to lib/map: the bytes of an experience, into a file that is being made. */
#ifndef VDNA_WRITE_H
#define VDNA_WRITE_H

#include <vdna/map.h>

#include "replace/replace.h"

/* Check an experience and write it beside `path`; what it makes has no name yet.
 * @return VDNA_OK, and `out_file` is to be committed, staged or abandoned; what
 *         vdna_experience_write() returns */
vdna_status vdna_write_beside(const vdna_experience *experience, const char *path,
                              vdna_error *error, vdna_replace *out_file);

#endif
