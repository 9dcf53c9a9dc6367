/* Private to lib/map: writes an experience into a new file that has no name yet. */
#ifndef VDNA_WRITE_H
#define VDNA_WRITE_H

#include <vdna/map.h>

#include "replace/replace.h"

/* Check an experience and write it beside `path`, without giving it that name yet.
 * @return VDNA_OK, and the caller commits, stages or abandons `out_file`; otherwise as
 *         vdna_experience_write() */
vdna_status vdna_write_beside(const vdna_experience *experience, const char *path,
                              vdna_error *error, vdna_replace *out_file);

#endif
