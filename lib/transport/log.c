#include "log.h"

#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "log_file.h"
#include "url.h"

#define SCHEME "file://"

struct vdna_log {
    vdna_log_file file;
    double speed;     /* 0 = do not wait */
    int64_t start_us; /* events before it are passed over */
    uint64_t damaged; /* bytes */

    int64_t first_time_us, first_clock_us; /* of the first event; valid once `is_running` */
    bool is_running;

    bool is_waiting; /* an event is loaded and not handed out yet */
    vdna_log_entry event;
    uint8_t *data;
    size_t capacity; /* bytes allocated for `data` */
};

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
    const char *speed = url_option(url, "speed"), *start = url_option(url, "start_timestamp");
    log->file = (vdna_log_file){file, (uint64_t)about.st_size, 0};
    log->speed = speed ? strtod(speed, NULL) : 1;
    log->start_us = start ? strtoll(start, NULL, 10) : INT64_MIN;
    return log;
}

/* see log.h */
void vdna_log_close(vdna_log *log)
{
    if (!log)
        return;
    fclose(log->file.file);
    free(log->data);
    free(log);
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

/* Load the next event that is not too early. Returns false at the end, or if it cannot be read. */
static bool advance(vdna_log *log)
{
    const int found = vdna_log_file_next(&log->file, &log->event);
    log->damaged += log->event.damage_size;
    if (!found)
        return false;
    if (!reserve(log, log->event.data_size) ||
        !vdna_log_file_read(&log->file, log->event.offset, log->data, log->event.data_size)) {
        log->damaged += log->file.size - log->event.offset;
        return false;
    }
    log->is_waiting = log->event.time_us >= log->start_us;
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
        log->first_time_us = log->event.time_us;
        log->first_clock_us = clock_us();
        log->is_running = true;
    }
    const double passed_us = (double)(clock_us() - log->first_clock_us) * log->speed;
    const double wait_us = (double)log->event.time_us - (double)log->first_time_us - passed_us;
    const double wait_ms = wait_us / log->speed / 1000;
    return wait_ms <= 0 ? 0 : wait_ms >= most ? most : (int)wait_ms + 1;
}

/* see log.h */
int vdna_log_next(vdna_log *log, int32_t timeout_ms, vdna_log_event *out_event)
{
    while (!log->is_waiting)
        if (!advance(log))
            return -1;

    const int wait_ms = due_in_ms(log, timeout_ms);
    if (wait_ms > 0 && poll(NULL, 0, wait_ms) < 0)
        return 0;
    if (due_in_ms(log, 1) > 0)
        return 0;
    log->is_waiting = false;
    *out_event = (vdna_log_event){log->event.channel, log->data, log->event.data_size};
    return 1;
}

/* see log.h */
uint64_t vdna_log_damaged_bytes(const vdna_log *log)
{
    return log->damaged;
}
