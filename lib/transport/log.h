/* Private: an LCM log file, read event by event at the pace of its URL. */
#ifndef VDNA_LOG_H
#define VDNA_LOG_H

#include <stddef.h>
#include <stdint.h>

typedef struct vdna_log vdna_log;

/* One event; valid until the next call with its log. */
typedef struct vdna_log_event {
    const char *channel; /* 1..1000 bytes, as LCM allows in logs */
    const uint8_t *data; /* [size] */
    uint32_t size;       /* bytes */
} vdna_log_event;

/* Open file://PATH?speed=X&start_timestamp=T; X = 0 is as fast as events are taken, and 1 if it is
 * not given. Returns NULL and sets errno on failure. */
vdna_log *vdna_log_open(const char *url);

/* NULL is allowed. */
void vdna_log_close(vdna_log *log);

/* Wait for the next event, at most timeout_ms. Returns 1 and the event; 0 if it is not due yet or a
 * signal came; -1 at the end of the log, or if there is no memory for an event. */
int vdna_log_next(vdna_log *log, int32_t timeout_ms, vdna_log_event *out_event);

/* Bytes passed over so far because they were no events. Zeros or half an event at the end, which a
 * power cut and a killed logger leave, do not count. */
uint64_t vdna_log_damaged_bytes(const vdna_log *log);

#endif
