/* Each event is a header of 28 bytes (big-endian: magic u32, number i64, time i64 in microseconds,
 * length of the channel u32, length of the data u32), the channel and the data. */
#include "log.h"

#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include <vdna/transport.h>

#include "cursor.h"

#define SCHEME "file://"
#define MAGIC 0xEDA1DA01u
#define HEADER_SIZE 28u
#define CHANNEL_MAX 1000u /* bytes, as LCM allows */

typedef struct header {
    int64_t time_us;
    uint32_t channel_size, data_size; /* bytes */
} header;

struct vdna_log {
    FILE *file;
    uint64_t size, at; /* bytes of the file when it was opened; the next event */
    double speed;      /* 0 = do not wait */
    int64_t start_us;  /* events before it are passed over */
    uint64_t damaged;  /* bytes */

    int64_t first_time_us, first_clock_us; /* of the first event; valid once `is_running` */
    bool is_running;

    bool is_waiting; /* an event is loaded and not handed out yet */
    int64_t time_us; /* its time */
    char channel[CHANNEL_MAX + 1];
    uint8_t *data;
    uint32_t data_size;
    size_t capacity; /* bytes allocated for `data` */
};

/* The value of an option in a URL; NULL = not given. */
static const char *option(const char *url, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = strchr(url, '?'); at; at = strchr(at + 1, '&'))
        if (strncmp(at + 1, name, length) == 0 && at[1 + length] == '=')
            return at + 1 + length + 1;
    return NULL;
}

static FILE *open_file(const char *url)
{
    const char *path = url + strlen(SCHEME);
    const size_t length = strcspn(path, "?");
    char *name = malloc(length + 1);
    if (!name)
        return NULL;
    memcpy(name, path, length);
    name[length] = 0;
    FILE *file = fopen(name, "rb");
    free(name);
    return file;
}

/* see log.h */
vdna_log *vdna_log_open(const char *url)
{
    FILE *file = open_file(url);
    struct stat about;
    if (file && (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode))) {
        fclose(file);
        errno = EINVAL;
        return NULL;
    }
    vdna_log *log = file ? calloc(1, sizeof *log) : NULL;
    if (!log) {
        if (file)
            fclose(file);
        return NULL;
    }
    const char *speed = option(url, "speed"), *start = option(url, "start_timestamp");
    log->file = file;
    log->size = (uint64_t)about.st_size;
    log->speed = speed ? strtod(speed, NULL) : 1;
    log->start_us = start ? strtoll(start, NULL, 10) : INT64_MIN;
    return log;
}

/* see log.h */
void vdna_log_close(vdna_log *log)
{
    if (!log)
        return;
    fclose(log->file);
    free(log->data);
    free(log);
}

/* Whether there are that many bytes, at a place that is to be read next. */
static bool seek(vdna_log *log, uint64_t at, uint64_t size)
{
    return at <= log->size && size <= log->size - at && fseeko(log->file, (off_t)at, SEEK_SET) == 0;
}

/* The place of the first magic number from `at` on; the end if there is none. */
static uint64_t find_magic(vdna_log *log, uint64_t at)
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

static bool is_zero_from(vdna_log *log, uint64_t at)
{
    if (!seek(log, at, 0))
        return false;
    int byte = 0;
    while (at++ < log->size && byte == 0)
        byte = getc(log->file);
    return byte == 0;
}

static bool read_header(vdna_log *log, uint64_t at, header *out_header)
{
    uint8_t bytes[HEADER_SIZE];
    if (!seek(log, at, sizeof bytes) || fread(bytes, sizeof bytes, 1, log->file) != 1)
        return false;
    cursor c = {bytes, sizeof bytes, false};
    const bool has_magic = cursor_unsigned(&c, sizeof(uint32_t)) == MAGIC;
    cursor_int64(&c); /* the number */
    out_header->time_us = cursor_int64(&c);
    out_header->channel_size = (uint32_t)cursor_unsigned(&c, sizeof(uint32_t));
    out_header->data_size = (uint32_t)cursor_unsigned(&c, sizeof(uint32_t));
    return has_magic && out_header->channel_size >= 1 && out_header->channel_size <= CHANNEL_MAX &&
           out_header->data_size <= VDNA_MESSAGE_BYTES_MAX;
}

static uint64_t end_of(const header *event, uint64_t at)
{
    return at + HEADER_SIZE + event->channel_size + event->data_size;
}

/* Whether the end of the file cuts what would be an event, or its header. */
static bool is_half(vdna_log *log, uint64_t at)
{
    static const uint8_t magic[] = {0xED, 0xA1, 0xDA, 0x01};
    uint8_t first[sizeof magic];
    header event;
    const uint64_t rest = log->size - at;
    const size_t there = rest < sizeof first ? (size_t)rest : sizeof first;
    if (!seek(log, at, there) || fread(first, 1, there, log->file) != there ||
        memcmp(first, magic, there) != 0)
        return false;
    return rest < HEADER_SIZE || (read_header(log, at, &event) && end_of(&event, at) > log->size);
}

static bool begins_with_magic(vdna_log *log, uint64_t at)
{
    uint8_t bytes[sizeof(uint32_t)];
    if (!seek(log, at, sizeof bytes) || fread(bytes, sizeof bytes, 1, log->file) != 1)
        return false;
    cursor c = {bytes, sizeof bytes, false};
    return cursor_unsigned(&c, sizeof bytes) == MAGIC;
}

/* Whether an event is all there. Where neither another one nor the end of the log follows, either
 * the damage begins after it, or it was cut, and then the next events lie within its length. */
static bool is_whole(vdna_log *log, uint64_t at, const header *event)
{
    const uint64_t end = end_of(event, at);
    if (end >= log->size || begins_with_magic(log, end))
        return end <= log->size;
    return is_half(log, end) || is_zero_from(log, end) || find_magic(log, at + 1) >= end;
}

/* Room for the data. A block that grows to the largest event. */
static bool reserve(vdna_log *log, size_t size)
{
    if (size <= log->capacity)
        return true;
    uint8_t *larger = realloc(log->data, size);
    if (!larger)
        return false;
    log->data = larger;
    log->capacity = size;
    return true;
}

static bool load(vdna_log *log, uint64_t at, const header *event)
{
    if (!reserve(log, event->data_size) ||
        !seek(log, at + HEADER_SIZE, event->channel_size + (uint64_t)event->data_size) ||
        fread(log->channel, 1, event->channel_size, log->file) != event->channel_size ||
        fread(log->data, 1, event->data_size, log->file) != event->data_size)
        return false;
    log->channel[event->channel_size] = 0;
    log->data_size = event->data_size;
    log->time_us = event->time_us;
    log->is_waiting = event->time_us >= log->start_us;
    return true;
}

/* Take what is at `at`: an event, the end, or damage up to the next magic number. Returns false if
 * the event cannot be read. */
static bool advance(vdna_log *log)
{
    header event;
    const uint64_t at = log->at;
    if (read_header(log, at, &event) && is_whole(log, at, &event)) {
        log->at = end_of(&event, at);
        if (load(log, at, &event))
            return true;
        log->damaged += log->size - at;
        return false;
    }
    log->at = find_magic(log, at + 1);
    const bool is_end = log->at == log->size && (is_half(log, at) || is_zero_from(log, at));
    log->damaged += is_end ? 0 : log->at - at;
    return true;
}

static int64_t clock_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* Milliseconds until the loaded event is due, at most `most`. */
static int due_in_ms(vdna_log *log, int most)
{
    if (!(log->speed > 0))
        return 0;
    if (!log->is_running) {
        log->first_time_us = log->time_us;
        log->first_clock_us = clock_us();
        log->is_running = true;
    }
    const double passed_us = (double)(clock_us() - log->first_clock_us) * log->speed;
    const double wait_us = (double)log->time_us - (double)log->first_time_us - passed_us;
    const double wait_ms = wait_us / log->speed / 1000;
    return wait_ms <= 0 ? 0 : wait_ms >= most ? most : (int)wait_ms + 1;
}

/* see log.h */
int vdna_log_next(vdna_log *log, int32_t timeout_ms, vdna_log_event *out_event)
{
    while (!log->is_waiting)
        if (log->at >= log->size || !advance(log))
            return -1;

    const int wait_ms = due_in_ms(log, timeout_ms);
    if (wait_ms > 0 && poll(NULL, 0, wait_ms) < 0)
        return 0;
    if (due_in_ms(log, 1) > 0)
        return 0;
    log->is_waiting = false;
    *out_event = (vdna_log_event){log->channel, log->data, log->data_size};
    return 1;
}

/* see log.h */
uint64_t vdna_log_damaged_bytes(const vdna_log *log)
{
    return log->damaged;
}
