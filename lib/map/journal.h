/* Private to lib/map: which new files of a map have taken the place of old ones, although they do
 * not bear their names yet. The file `.commit` in the map's directory says so, from the one rename
 * that makes an update of several files final until all of them are renamed
 * (docs/reference/SPEC-map.md). */
#ifndef VDNA_JOURNAL_H
#define VDNA_JOURNAL_H

#include <stddef.h>

#include <vdna/map.h>

#define VDNA_JOURNAL_FILE ".commit"

/* What a complete new file is called until it replaces NAME.vdna: "NAME.vdna.staged". */
#define VDNA_JOURNAL_STAGED VDNA_MAP_EXTENSION ".staged"

/* Most experiences of one update. */
#define VDNA_JOURNAL_NAMES_MAX 4096u

/* Bytes of the longest journal: first line, names, checksum. */
#define VDNA_JOURNAL_SIZE (14u + VDNA_JOURNAL_NAMES_MAX * VDNA_NAME_SIZE + 16u)

/* Names of experiences. In a file they are in byte order, and each is there once. */
typedef struct vdna_journal {
    char (*names)[VDNA_NAME_SIZE]; /* [count], allocated; NULL if there are none */
    uint32_t count;
} vdna_journal;

/* Append a name, and make room for it. @return 0 if there is no memory left */
int vdna_journal_add(vdna_journal *journal, const char *name);

/* Bring the names into byte order. @return one that is there twice; NULL if none is */
const char *vdna_journal_sort(vdna_journal *journal);

/* The text of a journal of 1 to VDNA_JOURNAL_NAMES_MAX sorted names.
 * @param out  [VDNA_JOURNAL_SIZE]
 * @return its bytes, without a NUL */
size_t vdna_journal_print(const vdna_journal *journal, char *out);

/* Read such a text; anything else is damaged.
 * @param path  of the directory, for the error
 * @param out_journal  to be freed with vdna_journal_free()
 * @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_NOMEM */
vdna_status vdna_journal_parse(const char *text, size_t size, const char *path, vdna_error *error,
                               vdna_journal *out_journal);

/* Read the journal of a directory; one that is not there is empty.
 * @param directory  a descriptor
 * @param path  of it, for the error
 * @param out_journal  to be freed with vdna_journal_free(), also after an error
 * @return VDNA_OK; VDNA_ERR_IO; VDNA_ERR_FORMAT; VDNA_ERR_NOMEM */
vdna_status vdna_journal_read(int directory, const char *path, vdna_error *error,
                              vdna_journal *out_journal);

/* Put a journal in its place: from then on the update is final.
 * @param journal  of 1 to VDNA_JOURNAL_NAMES_MAX sorted names, whose staged files are on the disk
 * @return VDNA_OK; VDNA_ERR_IO or VDNA_ERR_NOMEM, and there is no journal */
vdna_status vdna_journal_write(int directory, const char *path, const vdna_journal *journal,
                               vdna_error *error);

/* Rename the listed files that are not renamed yet, then remove the journal. May be repeated.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_journal_finish(int directory, const char *path, const vdna_journal *journal,
                                vdna_error *error);

void vdna_journal_free(vdna_journal *journal);

#endif
