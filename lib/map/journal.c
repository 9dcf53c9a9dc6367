#include "journal.h"

#include <errno.h>
#include <fail.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "replace/replace.h"

/* The first line; each further one is "PARTIAL NAME". */
#define FIRST_LINE "vdna-commit 1\n"

/* Far more than the lines of any map. */
#define JOURNAL_BYTES_MAX (16u << 20)

/* Bytes of the longest path that Linux accepts. */
#define PATH_SIZE 4096

static vdna_status damaged(const char *path, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_FORMAT,
                     "%s/" VDNA_JOURNAL_NAME
                     ": is damaged, expected the files of an update that was"
                     " interrupted; remove it, and build anew what was being built",
                     path);
}

static vdna_status refused(const char *path, const char *what, vdna_error *error)
{
    return vdna_fail(error, VDNA_ERR_IO, "%s/" VDNA_JOURNAL_NAME ": cannot %s: %s", path, what,
                     strerror(errno));
}

/* The whole text, NUL-terminated and allocated. */
static vdna_status read_text(int file, const char *path, vdna_error *error, char **out_text)
{
    struct stat about;
    if (fstat(file, &about) != 0)
        return refused(path, "examine", error);
    if (!S_ISREG(about.st_mode) || about.st_size < 0 || about.st_size > (off_t)JOURNAL_BYTES_MAX)
        return damaged(path, error);
    const size_t size = (size_t)about.st_size;
    char *text = malloc(size + 1);
    if (!text)
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", path);
    size_t filled = 0;
    while (filled < size) {
        const ssize_t got = read(file, text + filled, size - filled);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0) {
            free(text);
            return refused(path, "read", error);
        }
        filled += (size_t)got;
    }
    text[size] = '\0';
    *out_text = text;
    return VDNA_OK;
}

/* Copy a file's name that ends at `mark`. @return the start of the next one; NULL if it is not a
 * file name */
static const char *take_name(const char *text, char mark, char out_name[VDNA_MAP_FILE_SIZE])
{
    const size_t length = strcspn(text, "/ \n");
    if (length == 0 || length >= VDNA_MAP_FILE_SIZE || text[length] != mark)
        return NULL;
    memcpy(out_name, text, length);
    out_name[length] = '\0';
    return text + length + 1;
}

static uint32_t lines_of(const char *text)
{
    uint32_t lines = 0;
    for (; *text != '\0'; text++)
        lines += *text == '\n';
    return lines;
}

static vdna_status parse(const char *text, const char *path, vdna_error *error,
                         vdna_journal *out_journal)
{
    if (strncmp(text, FIRST_LINE, strlen(FIRST_LINE)) != 0)
        return damaged(path, error);
    text += strlen(FIRST_LINE);
    vdna_journal journal = {NULL, 0};
    journal.entries = calloc((size_t)lines_of(text) + 1, sizeof *journal.entries);
    if (!journal.entries)
        return vdna_fail(error, VDNA_ERR_NOMEM, "%s: no memory left", path);
    while (*text != '\0') {
        vdna_journal_entry *entry = &journal.entries[journal.count++];
        text = take_name(text, ' ', entry->partial);
        if (text)
            text = take_name(text, '\n', entry->name);
        if (!text) {
            vdna_journal_free(&journal);
            return damaged(path, error);
        }
    }
    *out_journal = journal;
    return VDNA_OK;
}

/* see journal.h */
vdna_status vdna_journal_read(int directory, const char *path, vdna_error *error,
                              vdna_journal *out_journal)
{
    out_journal->entries = NULL;
    out_journal->count = 0;
    const int file =
        openat(directory, VDNA_JOURNAL_NAME, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return errno == ENOENT ? VDNA_OK : refused(path, "open", error);
    char *text = NULL;
    vdna_status status = read_text(file, path, error, &text);
    close(file);
    if (status != VDNA_OK)
        return status;
    status = parse(text, path, error, out_journal);
    free(text);
    return status;
}

static vdna_status write_lines(const vdna_replace *file, const vdna_journal *journal,
                               vdna_error *error)
{
    vdna_status status = vdna_replace_write(file, FIRST_LINE, strlen(FIRST_LINE), error);
    for (uint32_t i = 0; i < journal->count && status == VDNA_OK; i++) {
        char line[2 * VDNA_MAP_FILE_SIZE + 2];
        const int length = snprintf(line, sizeof line, "%s %s\n", journal->entries[i].partial,
                                    journal->entries[i].name);
        status = vdna_replace_write(file, line, (size_t)length, error);
    }
    return status;
}

/* see journal.h */
vdna_status vdna_journal_write(const char *path, const vdna_journal *journal, vdna_error *error)
{
    char name[PATH_SIZE];
    if ((size_t)snprintf(name, sizeof name, "%s/" VDNA_JOURNAL_NAME, path) >= sizeof name)
        return vdna_fail(error, VDNA_ERR_IO, "%s: the path is too long", path);
    vdna_replace file;
    vdna_status status = vdna_replace_begin(name, error, &file);
    if (status != VDNA_OK)
        return status;
    status = write_lines(&file, journal, error);
    if (status == VDNA_OK)
        return vdna_replace_commit(&file, VDNA_REPLACE_DURABLE, error);
    vdna_replace_abandon(&file);
    return status;
}

/* see journal.h */
vdna_status vdna_journal_finish(int directory, const char *path, const vdna_journal *journal,
                                vdna_error *error)
{
    for (uint32_t i = 0; i < journal->count; i++) {
        const vdna_journal_entry *entry = &journal->entries[i];
        /* A missing file was renamed before the interruption. */
        if (renameat(directory, entry->partial, directory, entry->name) != 0 && errno != ENOENT)
            return vdna_fail(
                error, VDNA_ERR_IO,
                "%s/%s: cannot take its place from %s: %s; the update is final, and the"
                " next `vdna build` of this map goes on with it",
                path, entry->name, entry->partial, strerror(errno));
    }
    /* The names must be on disk before the journal that announces them is removed. */
    if (vdna_replace_sync(directory) != 0)
        return refused(path, "fsync the directory of", error);
    if (unlinkat(directory, VDNA_JOURNAL_NAME, 0) != 0 && errno != ENOENT)
        return refused(path, "remove", error);
    return VDNA_OK;
}

/* see journal.h */
void vdna_journal_free(vdna_journal *journal)
{
    free(journal->entries);
    journal->entries = NULL;
    journal->count = 0;
}
