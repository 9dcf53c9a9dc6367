/* Private to lib/map: the journal of an update, the file `.commit` in the map's directory. It lists
 * new files that already replace old ones but do not have their names yet. The one rename that
 * creates it makes an update of several files final; it is removed once all of them are renamed
 * (docs/reference/SPEC-map.md). */
#ifndef VDNA_JOURNAL_H
#define VDNA_JOURNAL_H

#include <vdna/map.h>

#define VDNA_JOURNAL_NAME ".commit"

/* A complete new file, and the name it will get. */
typedef struct vdna_journal_entry {
    char partial[VDNA_MAP_FILE_SIZE];
    char name[VDNA_MAP_FILE_SIZE];
} vdna_journal_entry;

typedef struct vdna_journal {
    vdna_journal_entry *entries; /* [count], allocated; NULL if there are none */
    uint32_t count;
} vdna_journal;

/* Read the journal of a directory; a missing one is empty.
 * @param directory  a descriptor
 * @param path  its path, for the error
 * @param out_journal  to be freed with vdna_journal_free()
 * @return VDNA_OK; VDNA_ERR_IO; VDNA_ERR_FORMAT; VDNA_ERR_NOMEM */
vdna_status vdna_journal_read(int directory, const char *path, vdna_error *error,
                              vdna_journal *out_journal);

/* Write the journal durably: from then on the update is final.
 * @return VDNA_OK; VDNA_ERR_IO; VDNA_ERR_NOMEM */
vdna_status vdna_journal_write(const char *path, const vdna_journal *journal, vdna_error *error);

/* Rename the listed files that are not renamed yet, then remove the journal. May be repeated.
 * @return VDNA_OK; VDNA_ERR_IO */
vdna_status vdna_journal_finish(int directory, const char *path, const vdna_journal *journal,
                                vdna_error *error);

void vdna_journal_free(vdna_journal *journal);

#endif
