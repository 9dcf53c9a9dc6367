/* Private to our libraries and programs: the places of the events in an LCM log file, damaged or
 * not. LCM's own reader crashes on a damaged length, ends at the first damage, and drops the last
 * event before zeros.
 *
 * Where bytes are no event, reading goes on at the next magic number. Half an event at the end,
 * which a killed logger leaves, and zeros at the end, which a power cut leaves, are the end. */
#ifndef VDNA_LOG_FILE_H
#define VDNA_LOG_FILE_H

#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_LOG_CHANNEL_MAX 1000u /* bytes of a channel, as LCM allows in logs */

/* A log; begin with {file, size, 0}. The file is the caller's. */
typedef struct vdna_log_file {
    FILE *file;
    uint64_t size; /* bytes of the file */
    uint64_t at;   /* where the next event is expected */
} vdna_log_file;

/* An event and what was passed over to find it. */
typedef struct vdna_log_entry {
    uint64_t number;                        /* of the event; those of a log follow one another */
    int64_t time_us;                        /* when it was logged */
    uint64_t offset;                        /* of its data in the file */
    uint32_t data_size, channel_size;       /* bytes */
    char channel[VDNA_LOG_CHANNEL_MAX + 1]; /* NUL-terminated */
    uint64_t damage_at, damage_size;        /* bytes before it that are no event; size 0 = none */
    uint64_t end_size;                      /* at the end: bytes of half an event or of zeros */
} vdna_log_entry;

/* Find the next event. Returns 1; 0 at the end, when only the last three fields are filled. */
int vdna_log_file_next(vdna_log_file *log, vdna_log_entry *out_entry);

/* Read bytes at a place. Returns 1; 0 if they are not there or cannot be read. */
int vdna_log_file_read(vdna_log_file *log, uint64_t at, void *out_bytes, size_t size);

/* Whether a file begins like an LCM log. */
int vdna_log_file_is_log(FILE *file);

#ifdef __cplusplus
}
#endif

#endif
