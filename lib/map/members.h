/* Private to lib/map: which files of a directory are experiences of the map, and whether others may
 * join them. */
#ifndef VDNA_MEMBERS_H
#define VDNA_MEMBERS_H

#include <dirent.h>

#include "journal.h"

/* Whether a file of this name is one. Hidden files are not: tools that copy put their own, such as
 * "._winter.vdna", beside. */
int vdna_members_have(const char *file);

/* Check that the staged experiences of an update compare with one another and with those that it
 * leaves in the map, whose names must be others. Only headers are read; a file without a readable
 * one is passed over, because readers of the map name it.
 * @param listing  of the directory, which is read from its beginning
 * @param path  of it, for the error
 * @param added  at least one, sorted, and all staged
 * @return VDNA_OK; VDNA_ERR_MISMATCH; VDNA_ERR_IO */
vdna_status vdna_members_check(DIR *listing, const char *path, const vdna_journal *added,
                               vdna_error *error);

#endif
