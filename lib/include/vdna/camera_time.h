/** @file vdna/camera_time.h
 *  @brief Camera time: stamps as cameras give them, put on one axis of microseconds.
 *
 *  Unit. Stamps should be microseconds. Drivers also give nanoseconds, milliseconds or whole
 *  seconds, since 1970 or since the machine started. The size of a stamp tells where it counts
 *  from 1970 in nanoseconds or microseconds; otherwise the spacing of the first frames tells,
 *  because no camera takes a picture every 500 microseconds. vdna_time_unit() has the rule.
 *
 *  Order. Equal stamps are in order. An earlier stamp is late if it is not older than the frame
 *  before the newest (two frames that changed places), or at most `late_us` older than the newest:
 *  the frame is to be left out. A larger step back means that the camera's clock was set or the
 *  recording begins anew, so the axis begins anew, too.
 */
#ifndef VDNA_CAMERA_TIME_H
#define VDNA_CAMERA_TIME_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Unit of the stamps. */
enum {
    VDNA_TIME_UNIT_AUTO = 0, /**< not known yet, to be recognised */
    VDNA_TIME_UNIT_US = 1,   /**< microseconds */
    VDNA_TIME_UNIT_NS = 2,   /**< nanoseconds */
    VDNA_TIME_UNIT_MS = 3,   /**< milliseconds */
    VDNA_TIME_UNIT_S = 4     /**< seconds */
};

/** What a stamp says about its frame. */
enum {
    VDNA_TIME_IN_ORDER = 0,  /**< not earlier than the newest frame */
    VDNA_TIME_LATE = 1,      /**< earlier than the newest, within the bound: leave the frame out */
    VDNA_TIME_BACKWARDS = 2, /**< a larger step back: the axis begins anew with this frame */
    VDNA_TIME_RECOGNISED = 3 /**< the unit turned out not to be microseconds: the axis begins anew
                                  with this frame */
};

/** Microseconds by which a frame may be late where nobody asks for another bound. */
#define VDNA_TIME_LATE_US_DEFAULT INT64_C(1000000)

/** Different stamps from which the unit is recognised, at most. */
#define VDNA_TIME_DISTINCT_MAX 9

/** A time axis. Read the fields, never write them. */
typedef struct vdna_camera_time {
    int64_t distinct[VDNA_TIME_DISTINCT_MAX]; /**< the first stamps, each different from the one
                                                   before; used until the unit is known */
    int64_t late_us;                          /**< bound of a late frame, microseconds, >= 0 */
    int64_t newest_us;       /**< newest frame, microseconds; valid while `frames` > 0 */
    int64_t before_us;       /**< newest frame before that with another time; equal to newest_us if
                                  there is none */
    uint64_t frames;         /**< in order since the axis began (anew) */
    uint64_t still;          /**< the last ones of these that did not move camera time */
    uint64_t late;           /**< late frames since vdna_camera_time_init() */
    uint64_t backwards;      /**< larger steps back since then */
    uint32_t unit;           /**< VDNA_TIME_UNIT_...; AUTO counts as microseconds */
    uint32_t distinct_count; /**< stamps in `distinct` */
} vdna_camera_time;

/** Begin an axis.
 *  @param time     the caller's; NULL is allowed
 *  @param unit     of the stamps; VDNA_TIME_UNIT_AUTO to recognise it
 *  @param late_us  bound of a late frame, microseconds; < 0 counts as 0 */
VDNA_API void vdna_camera_time_init(vdna_camera_time *time, uint32_t unit, int64_t late_us);

/** Begin the axis anew: the next frame is in order, whatever its stamp. Unit and counters stay.
 *  @param time  NULL is allowed */
VDNA_API void vdna_camera_time_begin(vdna_camera_time *time);

/** Put a frame on the axis.
 *  @param time       from vdna_camera_time_init()
 *  @param stamp      the camera's, any value
 *  @param out_utime  microseconds, also of a late frame; stamps beyond int64 microseconds become
 *                    the nearest one
 *  @return VDNA_TIME_... */
VDNA_API uint32_t vdna_camera_time_take(vdna_camera_time *time, int64_t stamp, int64_t *out_utime);

/** Recognise the unit of stamps. Rules, the first that applies:
 *   - a first stamp of 10^17 or more is nanoseconds, of 10^14 or more microseconds since 1970;
 *   - a median spacing of 500 or more is microseconds;
 *   - a first stamp of 10^12 up to 4 10^12 is milliseconds, of 10^9 up to 4 10^9 seconds since
 * 1970;
 *   - a median spacing of 1 or 2 is seconds, a larger one milliseconds.
 *  Spacings are absolute differences of consecutive stamps, those of 0 left out.
 *  @param stamps  [count], in the order in which they came
 *  @param count   0 gives AUTO
 *  @return VDNA_TIME_UNIT_...; AUTO if there are no two different stamps that could tell */
VDNA_API uint32_t vdna_time_unit(const int64_t *stamps, size_t count);

/** Convert a stamp to microseconds.
 *  @param unit   VDNA_TIME_UNIT_...; AUTO counts as microseconds
 *  @param stamp  any value
 *  @return microseconds; beyond int64 the nearest one */
VDNA_API int64_t vdna_time_us(uint32_t unit, int64_t stamp);

/** English name of a unit.
 *  @param unit  any value
 *  @return "microseconds" and so on, a constant string; "unknown unit" for AUTO and others */
VDNA_API const char *vdna_time_unit_name(uint32_t unit);

#ifdef __cplusplus
}
#endif

#endif
