#include "journal.h"

#include <crc32c.h>
#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "replace/replace.h"

/* First line of the text. A name a line follows, and the CRC-32C of all that. */
#define FIRST_LINE "vdna-commit 1\n"
#define FIRST_SIZE (sizeof FIRST_LINE - 1)
#define CRC_SIZE (sizeof "crc32c 01234567\n" - 1)

static vdna_status damaged(const char *path, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_FORMAT,
                     "%s/" VDNA_JOURNAL_FILE
                     ": is damaged, expected the experiences of an update that was interrupted;"
                     " remove it, and build anew what was being built",
                     path);
}

static vdna_status refused(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO, "%s/" VDNA_JOURNAL_FILE ": cannot %s: %s", path, what,
                     strerror(errno));
}

static vdna_status no_memory(const char *path, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_NOMEM, "%s/" VDNA_JOURNAL_FILE ": no memory left", path);
}

/* see journal.h */
int vdna_journal_add(vdna_journal *journal, const char *name)
{
    char(*names)[VDNA_NAME_SIZE] =
        realloc(journal->names, ((size_t)journal->count + 1) * sizeof *names);
    if (!names)
        return 0;
    journal->names = names;
    snprintf(names[journal->count++], sizeof *names, "%s", name);
    return 1;
}

static int by_bytes(const void *a, const void *b)
{
    return strcmp(a, b);
}

/* see journal.h */
const char *vdna_journal_sort(vdna_journal *journal)
{
    qsort(journal->names, journal->count, sizeof *journal->names, by_bytes);
    for (uint32_t i = 1; i < journal->count; i++)
        if (strcmp(journal->names[i - 1], journal->names[i]) == 0)
            return journal->names[i];
    return NULL;
}

/* Write the line that follows `size` bytes of text. */
static void print_checksum(const char *text, size_t size, char out_line[CRC_SIZE + 1])
{
    snprintf(out_line, CRC_SIZE + 1, "crc32c %08" PRIx32 "\n", vdna_crc32c(0, text, size));
}

/* see journal.h */
size_t vdna_journal_print(const vdna_journal *journal, char *out)
{
    char line[CRC_SIZE + 1];
    size_t size = FIRST_SIZE;
    memcpy(out, FIRST_LINE, FIRST_SIZE);
    for (uint32_t i = 0; i < journal->count; i++) {
        const size_t length = strlen(journal->names[i]);
        memcpy(out + size, journal->names[i], length);
        out[size + length] = '\n';
        size += length + 1;
    }
    print_checksum(out, size, line);
    memcpy(out + size, line, CRC_SIZE);
    return size + CRC_SIZE;
}

/* Whether a text begins and ends as a journal, with the right checksum. */
static int is_whole(const char *text, size_t size)
{
    char line[CRC_SIZE + 1];
    if (size < FIRST_SIZE + CRC_SIZE || size > VDNA_JOURNAL_SIZE)
        return 0;
    print_checksum(text, size - CRC_SIZE, line);
    return memcmp(text, FIRST_LINE, FIRST_SIZE) == 0 &&
           memcmp(text + size - CRC_SIZE, line, CRC_SIZE) == 0;
}

/* Take the name of a visible experience from a line. @return where the next line begins; NULL if
 * this is none */
static const char *take_name(const char *line, const char *end, char out_name[VDNA_NAME_SIZE])
{
    const char *newline = memchr(line, '\n', (size_t)(end - line));
    if (!newline || newline - line >= (ptrdiff_t)VDNA_NAME_SIZE)
        return NULL;
    const size_t length = (size_t)(newline - line);
    memcpy(out_name, line, length);
    out_name[length] = '\0';
    const int is_name = vdna_name_check(out_name, NULL) == VDNA_OK && out_name[0] != '.' &&
                        strlen(out_name) == length;
    return is_name ? newline + 1 : NULL;
}

static vdna_status parse_names(const char *text, const char *end, const char *path,
                               vdna_error *error, vdna_journal *journal)
{
    char last[VDNA_NAME_SIZE] = "", name[VDNA_NAME_SIZE];
    while (text < end) {
        text = take_name(text, end, name);
        /* In order, each is there once. */
        if (!text || strcmp(last, name) >= 0)
            return damaged(path, error);
        if (!vdna_journal_add(journal, name))
            return no_memory(path, error);
        snprintf(last, sizeof last, "%s", name);
    }
    return journal->count > 0 ? VDNA_OK : damaged(path, error);
}

/* see journal.h */
vdna_status vdna_journal_parse(const char *text, size_t size, const char *path, vdna_error *error,
                               vdna_journal *out_journal)
{
    if (!is_whole(text, size))
        return damaged(path, error);
    vdna_journal journal = {NULL, 0};
    const vdna_status status =
        parse_names(text + FIRST_SIZE, text + size - CRC_SIZE, path, error, &journal);
    if (status == VDNA_OK)
        *out_journal = journal;
    else
        vdna_journal_free(&journal);
    return status;
}

/* Read to the end of the file, or of the room. @return the bytes; -1 and errno */
static ssize_t read_all(int file, char *out, size_t capacity)
{
    size_t size = 0;
    ssize_t got = 1;
    while (size < capacity && got != 0) {
        got = read(file, out + size, capacity - size);
        if (got < 0 && errno != EINTR)
            return -1;
        size += got > 0 ? (size_t)got : 0;
    }
    return (ssize_t)size;
}

static vdna_status read_file(int file, const char *path, vdna_error *error,
                             vdna_journal *out_journal)
{
    /* One byte more shows a file that is too long. */
    const size_t capacity = VDNA_JOURNAL_SIZE + 1;
    char *text = malloc(capacity);
    if (!text)
        return no_memory(path, error);
    const ssize_t size = read_all(file, text, capacity);
    const vdna_status status =
        size < 0 ? refused(path, "read", error)
                 : vdna_journal_parse(text, (size_t)size, path, error, out_journal);
    free(text);
    return status;
}

/* see journal.h */
vdna_status vdna_journal_read(int directory, const char *path, vdna_error *error,
                              vdna_journal *out_journal)
{
    out_journal->names = NULL;
    out_journal->count = 0;
    const int file =
        openat(directory, VDNA_JOURNAL_FILE, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return errno == ENOENT ? VDNA_OK : refused(path, "open", error);
    const vdna_status status = read_file(file, path, error, out_journal);
    close(file);
    return status;
}

static vdna_status write_text(int directory, const char *text, size_t size, vdna_error *error)
{
    vdna_replace file;
    vdna_status status = vdna_replace_begin_in(directory, VDNA_JOURNAL_FILE, error, &file);
    if (status != VDNA_OK)
        return status;
    status = vdna_replace_write(&file, text, size, error);
    if (status == VDNA_OK)
        return vdna_replace_stage(&file, VDNA_JOURNAL_FILE, error);
    vdna_replace_abandon(&file);
    return status;
}

/* see journal.h */
vdna_status vdna_journal_write(int directory, const char *path, const vdna_journal *journal,
                               vdna_error *error)
{
    vdna_error reason;
    char *text = malloc(VDNA_JOURNAL_SIZE);
    vdna_status status = VDNA_ERR_NOMEM;
    if (text)
        status = write_text(directory, text, vdna_journal_print(journal, text), &reason);
    else
        vdna_fail(&reason, status, VDNA_JOURNAL_FILE ": no memory left");
    free(text);
    if (status != VDNA_OK)
        return vdna_fail(error, status, "%s/%s; the map is unchanged", path, reason.text);
    return VDNA_OK;
}

static vdna_status unfinished(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO,
                     "%s: cannot %s: %s; the update is final, and the next one of this map, such as"
                     " `vdna build`, goes on with it",
                     path, what, strerror(errno));
}

/* Rename one new file; one that is not there was renamed before an interruption. */
static vdna_status put_in_place(int directory, const char *path, const char *name,
                                vdna_error *error)
{
    char staged[VDNA_MAP_FILE_SIZE], file[VDNA_MAP_FILE_SIZE], what[2 * VDNA_MAP_FILE_SIZE + 16];
    snprintf(staged, sizeof staged, "%s" VDNA_JOURNAL_STAGED, name);
    snprintf(file, sizeof file, "%s" VDNA_MAP_EXTENSION, name);
    if (renameat(directory, staged, directory, file) == 0 || errno == ENOENT)
        return VDNA_OK;
    snprintf(what, sizeof what, "rename %s to %s", staged, file);
    return unfinished(path, what, error);
}

/* see journal.h */
vdna_status vdna_journal_finish(int directory, const char *path, const vdna_journal *journal,
                                vdna_error *error)
{
    /* What says that new names are to come must be on the disk before the first of them. */
    if (vdna_replace_sync(directory) != 0)
        return unfinished(path, "fsync this directory", error);
    for (uint32_t i = 0; i < journal->count; i++) {
        const vdna_status status = put_in_place(directory, path, journal->names[i], error);
        if (status != VDNA_OK)
            return status;
    }
    /* And all of them before it is gone. */
    if (vdna_replace_sync(directory) != 0)
        return unfinished(path, "fsync this directory", error);
    if (unlinkat(directory, VDNA_JOURNAL_FILE, 0) != 0)
        return unfinished(path, "remove " VDNA_JOURNAL_FILE, error);
    return VDNA_OK;
}

/* see journal.h */
void vdna_journal_free(vdna_journal *journal)
{
    free(journal->names);
    journal->names = NULL;
    journal->count = 0;
}
