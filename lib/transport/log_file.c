/* Each event is a header of 28 bytes (big-endian: magic u32, number i64, time i64 in microseconds,
 * length of the channel u32, length of the data u32), the channel and the data. */
#include "log_file.h"

#include <stdbool.h>
#include <string.h>

#include <vdna/transport.h>

#include "cursor.h"

#define MAGIC 0xEDA1DA01u
#define HEADER_SIZE 28u
/* Zeros at the end of an event that runs into zeros: not its own, but those of a hole. A camera
 * message without metadata ends in four of its own. */
#define HOLE_SIZE 16u

/* Whether there are that many bytes, at a place that is to be read next. */
static bool seek(vdna_log_file *log, uint64_t at, uint64_t size)
{
    return at <= log->size && size <= log->size - at && fseeko(log->file, (off_t)at, SEEK_SET) == 0;
}

/* see log_file.h */
int vdna_log_file_read(vdna_log_file *log, uint64_t at, void *out_bytes, size_t size)
{
    return seek(log, at, size) && fread(out_bytes, 1, size, log->file) == size;
}

/* The place of the first magic number from `at` on; the end if there is none. */
static uint64_t find_magic(vdna_log_file *log, uint64_t at)
{
    uint32_t newest = 0; /* the last four bytes; no magic number begins with a zero */
    int byte;
    if (!seek(log, at, 0))
        return log->size;
    for (; at < log->size && (byte = getc(log->file)) != EOF; at++) {
        newest = newest << 8 | (uint32_t)byte;
        if (newest == MAGIC)
            return at + 1 - sizeof newest;
    }
    return log->size;
}

static bool is_zero(vdna_log_file *log, uint64_t at, uint64_t end)
{
    if (!seek(log, at, end - at))
        return false;
    int byte = 0;
    while (at++ < end && byte == 0)
        byte = getc(log->file);
    return byte == 0;
}

/* Fill in the header of an event that may be here. */
static bool read_header(vdna_log_file *log, uint64_t at, vdna_log_entry *entry)
{
    uint8_t bytes[HEADER_SIZE];
    if (!vdna_log_file_read(log, at, bytes, sizeof bytes))
        return false;
    cursor c = {bytes, sizeof bytes, false};
    const bool has_magic = cursor_unsigned(&c, sizeof(uint32_t)) == MAGIC;
    entry->number = (uint64_t)cursor_int64(&c);
    entry->time_us = cursor_int64(&c);
    entry->channel_size = (uint32_t)cursor_unsigned(&c, sizeof(uint32_t));
    entry->data_size = (uint32_t)cursor_unsigned(&c, sizeof(uint32_t));
    entry->offset = at + HEADER_SIZE + entry->channel_size;
    return has_magic && entry->channel_size >= 1 && entry->channel_size <= VDNA_LOG_CHANNEL_MAX &&
           entry->data_size <= VDNA_MESSAGE_BYTES_MAX;
}

static uint64_t end_of(const vdna_log_entry *entry)
{
    return entry->offset + entry->data_size;
}

/* Whether the magic number is here, or as much of it as the file has left. */
static bool begins_with_magic(vdna_log_file *log, uint64_t at)
{
    static const uint8_t magic[] = {0xED, 0xA1, 0xDA, 0x01};
    uint8_t bytes[sizeof magic];
    const uint64_t rest = log->size - at;
    const size_t there = rest < sizeof bytes ? (size_t)rest : sizeof bytes;
    return vdna_log_file_read(log, at, bytes, there) && memcmp(bytes, magic, there) == 0;
}

/* Whether the end of the file cuts what would be an event, or its header. */
static bool is_half(vdna_log_file *log, uint64_t at)
{
    vdna_log_entry entry;
    if (!begins_with_magic(log, at))
        return false;
    return log->size - at < HEADER_SIZE ||
           (read_header(log, at, &entry) && end_of(&entry) > log->size);
}

/* Whether an event ends in a hole of zeros that goes on behind it. */
static bool runs_into_hole(vdna_log_file *log, const vdna_log_entry *entry)
{
    const uint64_t end = end_of(entry);
    return entry->data_size >= HOLE_SIZE && is_zero(log, end - HOLE_SIZE, end + 1);
}

/* Whether an event is all there. Where neither another one nor the end of the log follows, either
 * the damage begins after it, or it was cut, and then the next events lie within its length. */
static bool is_whole(vdna_log_file *log, uint64_t at, const vdna_log_entry *entry)
{
    const uint64_t end = end_of(entry);
    if (end >= log->size || begins_with_magic(log, end))
        return end <= log->size;
    return is_zero(log, end, log->size) ||
           (find_magic(log, at + 1) >= end && !runs_into_hole(log, entry));
}

static bool take(vdna_log_file *log, uint64_t at, vdna_log_entry *entry)
{
    if (!read_header(log, at, entry) || !is_whole(log, at, entry) ||
        !vdna_log_file_read(log, at + HEADER_SIZE, entry->channel, entry->channel_size))
        return false;
    entry->channel[entry->channel_size] = 0;
    log->at = end_of(entry);
    return true;
}

/* see log_file.h */
int vdna_log_file_next(vdna_log_file *log, vdna_log_entry *out_entry)
{
    out_entry->damage_size = out_entry->end_size = 0;
    while (log->at < log->size) {
        const uint64_t at = log->at;
        if (take(log, at, out_entry))
            return 1;
        log->at = find_magic(log, at + 1);
        if (log->at == log->size && (is_half(log, at) || is_zero(log, at, log->size))) {
            out_entry->end_size = log->size - at;
            return 0;
        }
        if (out_entry->damage_size == 0)
            out_entry->damage_at = at;
        out_entry->damage_size = log->at - out_entry->damage_at;
    }
    return 0;
}

/* see log_file.h */
int vdna_log_file_is_log(FILE *file)
{
    vdna_log_file log = {file, sizeof(uint32_t), 0};
    return begins_with_magic(&log, 0);
}
