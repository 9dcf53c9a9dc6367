/* Private to lib/map: writes an experience into a new file that has no name yet. */
#ifndef VDNA_WRITE_H
#define VDNA_WRITE_H

#include <vdna/map.h>

#include "replace/replace.h"

/* Check an experience before anything is done about it.
 * @param path  of its file, for the error
 * @return VDNA_OK; what vdna_experience_write() returns */
vdna_status vdna_write_check(const vdna_experience *experience, const char *path,
                             vdna_error *error);

/* Write a checked experience. After an error `file` has been abandoned.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_write_into(vdna_replace *file, const vdna_experience *experience,
                            vdna_error *error);

#endif
