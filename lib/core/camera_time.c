#include <string.h>

#include <vdna/camera_time.h>

#include "elapsed.h"

/* Frames to wait for before the spacing counts, so that one odd stamp at the start does not. */
#define FRAMES_TO_RECOGNISE VDNA_TIME_DISTINCT_MAX

/* see vdna/camera_time.h */
const char *vdna_time_unit_name(uint32_t unit)
{
    static const char *const names[] = {"unknown unit", "microseconds", "nanoseconds",
                                        "milliseconds", "seconds"};
    return names[unit <= VDNA_TIME_UNIT_S ? unit : VDNA_TIME_UNIT_AUTO];
}

static int64_t times(int64_t stamp, int64_t factor)
{
    if (stamp > INT64_MAX / factor)
        return INT64_MAX;
    return stamp < INT64_MIN / factor ? INT64_MIN : stamp * factor;
}

/* see vdna/camera_time.h */
int64_t vdna_time_us(uint32_t unit, int64_t stamp)
{
    switch (unit) {
    case VDNA_TIME_UNIT_NS:
        return stamp / 1000;
    case VDNA_TIME_UNIT_MS:
        return times(stamp, 1000);
    case VDNA_TIME_UNIT_S:
        return times(stamp, 1000000);
    default:
        return stamp;
    }
}

/* Time between two stamps in either order. */
static uint64_t between(int64_t a, int64_t b)
{
    return a < b ? vdna_elapsed_us(a, b) : vdna_elapsed_us(b, a);
}

/* Insert a spacing into the smallest ones so far. */
static void insert_spacing(uint64_t *sorted, size_t count, uint64_t spacing)
{
    size_t at = count;
    for (; at > 0 && sorted[at - 1] > spacing; at--)
        sorted[at] = sorted[at - 1];
    sorted[at] = spacing;
}

/* Median of the first spacings that are not 0; 0 if all are. */
static uint64_t median_spacing(const int64_t *stamps, size_t count)
{
    uint64_t sorted[VDNA_TIME_DISTINCT_MAX - 1];
    size_t spacings = 0;
    for (size_t i = 1; i < count && spacings < VDNA_TIME_DISTINCT_MAX - 1; i++)
        if (stamps[i] != stamps[i - 1])
            insert_spacing(sorted, spacings++, between(stamps[i - 1], stamps[i]));
    return spacings > 0 ? sorted[spacings / 2] : 0;
}

/* see vdna/camera_time.h */
uint32_t vdna_time_unit(const int64_t *stamps, size_t count)
{
    if (!stamps || count == 0)
        return VDNA_TIME_UNIT_AUTO;
    const int64_t first = stamps[0];
    if (first >= INT64_C(100000000000000000))
        return VDNA_TIME_UNIT_NS;
    if (first >= INT64_C(100000000000000))
        return VDNA_TIME_UNIT_US;

    const uint64_t spacing = median_spacing(stamps, count);
    if (spacing == 0)
        return VDNA_TIME_UNIT_AUTO;
    if (spacing >= 500)
        return VDNA_TIME_UNIT_US;
    if (first >= INT64_C(1000000000000) && first < INT64_C(4000000000000))
        return VDNA_TIME_UNIT_MS;
    if (first >= INT64_C(1000000000) && first < INT64_C(4000000000))
        return VDNA_TIME_UNIT_S;
    return spacing <= 2 ? VDNA_TIME_UNIT_S : VDNA_TIME_UNIT_MS;
}

/* see vdna/camera_time.h */
void vdna_camera_time_init(vdna_camera_time *time, uint32_t unit, int64_t late_us)
{
    if (!time)
        return;
    memset(time, 0, sizeof *time);
    time->unit = unit <= VDNA_TIME_UNIT_S ? unit : VDNA_TIME_UNIT_AUTO;
    time->late_us = late_us > 0 ? late_us : 0;
}

/* see vdna/camera_time.h */
void vdna_camera_time_begin(vdna_camera_time *time)
{
    if (time)
        time->frames = time->still = 0;
}

/* Try to recognise the unit. @return 1 if it is known now and is not microseconds */
static int recognise(vdna_camera_time *time, int64_t stamp)
{
    uint32_t *const count = &time->distinct_count;
    if (*count < VDNA_TIME_DISTINCT_MAX && (*count == 0 || time->distinct[*count - 1] != stamp))
        time->distinct[(*count)++] = stamp;
    /* A single stamp tells the unit by its size, if at all. */
    const int is_early = time->frames + 1 < FRAMES_TO_RECOGNISE;
    time->unit = vdna_time_unit(time->distinct, is_early ? 1 : *count);
    return time->unit != VDNA_TIME_UNIT_AUTO && time->unit != VDNA_TIME_UNIT_US;
}

static void begin_at(vdna_camera_time *time, int64_t utime)
{
    time->newest_us = time->before_us = utime;
    time->frames = 1;
    time->still = 0;
}

static void go_on(vdna_camera_time *time, int64_t utime)
{
    time->frames++;
    time->still = utime == time->newest_us ? time->still + 1 : 0;
    if (utime != time->newest_us)
        time->before_us = time->newest_us;
    time->newest_us = utime;
}

/* Whether a stamp earlier than the newest is late, not a step back. */
static int is_late(const vdna_camera_time *time, int64_t utime)
{
    return vdna_elapsed_us(utime, time->newest_us) <= (uint64_t)time->late_us ||
           (time->before_us != time->newest_us && utime >= time->before_us);
}

/* see vdna/camera_time.h */
uint32_t vdna_camera_time_take(vdna_camera_time *time, int64_t stamp, int64_t *out_utime)
{
    const int recognised = time->unit == VDNA_TIME_UNIT_AUTO && recognise(time, stamp);
    const int64_t utime = *out_utime = vdna_time_us(time->unit, stamp);
    if (time->frames == 0 || recognised) {
        const int is_first = time->frames == 0;
        begin_at(time, utime);
        return is_first ? VDNA_TIME_IN_ORDER : VDNA_TIME_RECOGNISED;
    }
    if (utime >= time->newest_us) {
        go_on(time, utime);
        return VDNA_TIME_IN_ORDER;
    }
    if (is_late(time, utime)) {
        time->late++;
        return VDNA_TIME_LATE;
    }
    time->backwards++;
    begin_at(time, utime);
    return VDNA_TIME_BACKWARDS;
}
