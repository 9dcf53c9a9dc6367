/* A file of a map in memory, to damage it and to change it under a right checksum. */
#ifndef EDITED_FILE_H
#define EDITED_FILE_H

#include "map_files.h"

#define FILE_SIZE 8192

/* A file to damage: the sample's bytes, and the path of the damaged copy. */
typedef struct edited_file {
    directory directory;
    unsigned char bytes[FILE_SIZE];
    size_t size;
} edited_file;

/* Bit by bit, to check the tables of the library. */
static inline uint32_t crc32c(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xFFFFFFFF;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78 : 0);
    }
    return ~crc;
}

/* Make the last four bytes the checksum of the others. */
static inline void seal(edited_file *f)
{
    const uint32_t crc = crc32c(f->bytes, f->size - 4);
    memcpy(f->bytes + f->size - 4, &crc, sizeof crc);
}

static inline size_t header_length(const edited_file *f)
{
    uint64_t length;
    memcpy(&length, f->bytes, sizeof length);
    return (size_t)length;
}

/* Replace the header by another text, padded as a writer pads it. */
static inline void set_header(edited_file *f, const char *text)
{
    char padded[FILE_SIZE];
    const size_t old_end = 8 + header_length(f), tail = f->size - old_end;
    size_t length = strlen(text);
    memcpy(padded, text, length);
    while (length % 8 != 0)
        padded[length++] = ' ';

    memmove(f->bytes + 8 + length, f->bytes + old_end, tail);
    const uint64_t written = length;
    memcpy(f->bytes, &written, sizeof written);
    memcpy(f->bytes + 8, padded, length);
    f->size = 8 + length + tail;
    seal(f);
}

/* Replace a part of the header, which must be there. */
static inline void edit_header(edited_file *f, const char *from, const char *to)
{
    char text[FILE_SIZE], edited[FILE_SIZE];
    memcpy(text, f->bytes + 8, header_length(f));
    text[header_length(f)] = '\0';
    char *found = strstr(text, from);
    if (!found)
        fail_msg("the header has no %s: %s", from, text);
    *found = '\0';
    snprintf(edited, sizeof edited, "%s%s%s", text, to, found + strlen(from));
    set_header(f, edited);
}

/* Overwrite a number of a tensor. */
static inline void edit_data(edited_file *f, const char *tensor, size_t index, const void *number,
                             size_t width)
{
    char text[FILE_SIZE], key[64];
    memcpy(text, f->bytes + 8, header_length(f));
    text[header_length(f)] = '\0';
    snprintf(key, sizeof key, "\"%s\":", tensor);
    const char *offsets = strstr(strstr(text, key), "data_offsets\":[");
    const size_t begin = (size_t)atoi(offsets + strlen("data_offsets\":["));
    memcpy(f->bytes + 8 + header_length(f) + begin + index * width, number, width);
    seal(f);
}

/* For a test of one file, in a directory of its own. */
static inline int set_up_file(void **state)
{
    edited_file *f = calloc(1, sizeof *f);
    f->directory = make_directory();
    *state = f;
    return 0;
}

static inline int tear_down_file(void **state)
{
    const edited_file *f = *state;
    remove_directory(&f->directory);
    free(*state);
    return 0;
}

/* Write what the bytes are now, and return the path. */
static inline const char *save_edited(const edited_file *f)
{
    const char *path = path_in(&f->directory, "damaged");
    save_file(path, f->bytes, f->size);
    return path;
}

/* Check that the file is refused by name, for the intended reason, without output, and return the
 * error.
 * @param reader  vdna_experience_open() or its like */
static inline vdna_error refusal_by(vdna_status (*reader)(const char *, vdna_error *,
                                                          vdna_experience *),
                                    const edited_file *f, vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    vdna_experience e, untouched;
    memset(&e, 0xAA, sizeof e);
    untouched = e;
    assert_int_equal(reader(save_edited(f), &error, &e), expected);
    assert_memory_equal(&e, &untouched, sizeof e);
    if (!strstr(error.text, reason) || !strstr(error.text, "damaged: "))
        fail_msg("expected the path and \"%s\" in: %s", reason, error.text);
    return error;
}

#endif
