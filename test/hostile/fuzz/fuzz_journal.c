/* Any bytes as the journal of an update: either damaged, or exactly what printing it gives. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc32c.h"
#include "fuzz.h"
#include "journal.h"

static void parse(const char *text, size_t size)
{
    static char printed[VDNA_JOURNAL_SIZE];
    vdna_journal journal = {NULL, 0};
    vdna_error error = {""};
    const vdna_status status = vdna_journal_parse(text, size, "fuzz", &error, &journal);
    if (status != VDNA_OK) {
        MUST(status == VDNA_ERR_FORMAT && error.text[0] != '\0' && !journal.names);
        return;
    }
    MUST(journal.count >= 1 && journal.count <= VDNA_JOURNAL_NAMES_MAX);
    for (uint32_t i = 0; i < journal.count; i++)
        MUST(!strchr(journal.names[i], '/') && journal.names[i][0] != '.');
    MUST(vdna_journal_print(&journal, printed) == size && memcmp(printed, text, size) == 0);
    vdna_journal_free(&journal);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    enum { CRC_SIZE = 16 };
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, bytes, size);
    parse(text, size);
    /* Make the checksum right, so that what is behind it is tried as well. */
    if (size > CRC_SIZE) {
        char line[CRC_SIZE + 1];
        snprintf(line, sizeof line, "crc32c %08x\n",
                 (unsigned)vdna_crc32c(0, text, size - CRC_SIZE));
        memcpy(text + size - CRC_SIZE, line, CRC_SIZE);
        parse(text, size);
    }
    free(text);
    return 0;
}

/* A journal of one experience, of three, and of 500. */
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    static const unsigned counts[] = {1, 3, 500};
    static char text[VDNA_JOURNAL_SIZE];
    if (index >= sizeof counts / sizeof *counts)
        return 0;
    vdna_journal journal = {NULL, 0};
    for (unsigned i = 0; i < counts[index]; i++) {
        char name[VDNA_NAME_SIZE];
        snprintf(name, sizeof name, "%03u-a.b_c", i);
        MUST(vdna_journal_add(&journal, name));
    }
    const size_t size = vdna_journal_print(&journal, text);
    vdna_journal_free(&journal);
    MUST(size <= capacity);
    memcpy(out, text, size);
    return size;
}
