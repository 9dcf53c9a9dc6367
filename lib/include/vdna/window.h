/** @file vdna/window.h
 *  @brief Windows: the Visual DNA of the first or the last N frames, or of T microseconds of them.
 *
 *  `which` and `length_us` choose one of four windows; N is `capacity`, T is `length_us`:
 *
 *  | window  | holds                                 | when it is full                            |
 *  |---------|---------------------------------------|--------------------------------------------|
 *  | first N | the first N frames                    | the N-th completes it                      |
 *  | first T | the frames with utime < first + T,    | the next one completes it, not being in it |
 *  |         | and at least `least_frames`           |                                            |
 *  | last N  | the newest N frames                   | the oldest leaves for each that comes      |
 *  | last T  | the frames with newest - utime < T    | frames leave as they grow too old          |
 *
 *  Stamps. Equal stamps are in order. A stamp earlier than the newest empties the window first and
 *  counts as a restart, because the window would no longer be one stretch of time; this also
 *  applies to windows by frames. A first window that is complete takes no more frames, whatever
 *  their stamps.
 *
 *  Capacity. No window ever holds more than `capacity` frames. If more come within T, a last window
 *  drops the oldest early and reports `truncated`; a first window is complete once it is full.
 *
 *  Exactness. A last window keeps the bin of every sample that it holds (two bytes each), so that a
 *  frame that leaves is subtracted exactly: at any time the histogram is, bit for bit, that of the
 *  frames in the window, however many came and went before. A first window subtracts nothing and
 *  keeps nothing but the histogram. Memory and the cost of a frame are fixed.
 */
#ifndef VDNA_WINDOW_H
#define VDNA_WINDOW_H

#include <vdna/hist.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Most bins of a last window's histogram: of the 65536 values of a kept sample, two stand for
 *  "below the range" and "above the range". A first window may have VDNA_HIST_BINS_MAX. */
#define VDNA_WINDOW_BINS_MAX (VDNA_HIST_BINS_MAX - 2u)

/** Which frames make a window. */
enum {
    VDNA_WINDOW_LAST = 0, /**< the newest: it slides */
    VDNA_WINDOW_FIRST = 1 /**< those from the first on, until it is complete */
};

/** Effects of a frame on a window; bits. */
enum {
    VDNA_WINDOW_ADDED = 1,     /**< the frame is in the window */
    VDNA_WINDOW_RESTARTED = 2, /**< camera time ran backwards, so the window was emptied first */
    VDNA_WINDOW_COMPLETE = 4   /**< a first window is complete: with ADDED, by this frame; without,
                                    this frame lies beyond it */
};

/** Shape of a window. Fill with vdna_window_config_init(), then set capacity, taps and range. */
typedef struct vdna_window_config {
    uint32_t struct_size;         /**< bytes of this struct, set by vdna_window_config_init() */
    uint32_t capacity;            /**< most frames in the window, >= 1; UINT32_MAX in a first window
                                       by time: as many as come */
    int64_t length_us;            /**< T, >= 1; 0 = by frames, whatever their time (default) */
    const vdna_activations *taps; /**< [tap_count], the shape of each frame; `values` is ignored. A
                                       last window takes frames of this shape (neurons, samples and
                                       layout of each tap) and borrows it as long as it is in use; a
                                       first window needs only the sum of the neurons, and only in
                                       vdna_window_init() */
    size_t tap_count;             /**< >= 1 */
    const float *range;           /**< [neurons of all taps][2], passes vdna_range_check();
                                       borrowed as long as the window is in use */
    uint32_t bins;                /**< VDNA_HIST_BINS_MIN..VDNA_WINDOW_BINS_MAX, for a first window
                                       ..VDNA_HIST_BINS_MAX */
    uint64_t which;               /**< VDNA_WINDOW_LAST (default) or VDNA_WINDOW_FIRST; 64 bits wide
                                       to leave no padding, which could not be used later */
    uint64_t least_frames;        /**< fewest frames of a first window by time, <= capacity, at
                                       most UINT32_MAX: it takes in frames beyond T until it has as
                                       many; 0 = any number (default), as in all other windows */
} vdna_window_config;

/** A window, within the caller's block. */
typedef struct vdna_window vdna_window;

/** Write the defaults: 1000 bins, the last frames; the caller must set capacity, taps and range.
 *
 *  In C and C++ a macro of this name calls vdna_window_config_init_sized(). The function itself is
 *  for programs and languages that know only the struct of version 0.1, which ended with `bins`: it
 *  writes that much and sets `struct_size` to match.
 *  @param config  NULL is allowed */
VDNA_API void vdna_window_config_init(vdna_window_config *config);

/** Write the defaults of the fields that the caller's struct has.
 *  @param config       NULL is allowed
 *  @param struct_size  bytes of the struct that the caller was compiled with */
VDNA_API void vdna_window_config_init_sized(vdna_window_config *config, size_t struct_size);

/** Write the defaults of all fields that this header has.
 *  @param config  NULL is allowed */
#define vdna_window_config_init(config) \
    vdna_window_config_init_sized((config), sizeof(vdna_window_config))

/** Bytes that vdna_window_init() needs: a histogram plus some 150; for a last window also 2 for
 *  each sample of `capacity` frames and 8 for each frame.
 *  @param config  its range is ignored
 *  @return bytes; 0 if a field breaks its rule, or if `capacity` frames of a last
 *          window could bring a mass past UINT32_MAX */
VDNA_API size_t vdna_window_mem_size(const vdna_window_config *config);

/** Make an empty window in `mem`.
 *  @param config  needed for this call only; its range is borrowed, and for a last window its taps
 *  @param mem  aligned for int64_t, `mem_size` bytes; holds the window, so it must stay where it is
 *              as long as that is in use
 *  @param mem_size  at least vdna_window_mem_size()
 *  @param out_window  the window, at the beginning of `mem`
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small */
VDNA_API vdna_status vdna_window_init(const vdna_window_config *config, void *mem, size_t mem_size,
                                      vdna_window **out_window);

/** Offer a frame; the table above gives its effect. After an error the window is unchanged.
 *  @param window     from vdna_window_init()
 *  @param utime      the camera's stamp in microseconds
 *  @param taps       [tap_count], of the shape in the config
 *  @param tap_count  >= 1
 *  @param out_events VDNA_WINDOW_ bits; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG, VDNA_ERR_MISMATCH or VDNA_ERR_NONFINITE for a bad frame;
 *          VDNA_ERR_FULL if a mass of a first window would pass UINT32_MAX */
VDNA_API vdna_status vdna_window_add(vdna_window *window, int64_t utime,
                                     const vdna_activations *taps, size_t tap_count,
                                     uint32_t *out_events);

/** Empty the window; it begins anew. Counters stay.
 *  @param window  NULL is allowed */
VDNA_API void vdna_window_reset(vdna_window *window);

/** Get the histogram of the frames in the window, `frames` of them; it follows later changes.
 *  @param window  NULL gives NULL
 *  @return borrowed as long as the window is in use; never write to it */
VDNA_API const vdna_hist *vdna_window_hist(const vdna_window *window);

/** Get the stamp of the oldest frame in the window.
 *  @param window  NULL gives 0
 *  @return microseconds; 0 if there is no frame */
VDNA_API int64_t vdna_window_first_utime(const vdna_window *window);

/** Get the stamp of the newest frame in the window.
 *  @param window  NULL gives 0
 *  @return microseconds; 0 if there is no frame */
VDNA_API int64_t vdna_window_last_utime(const vdna_window *window);

/** Get how full the window is: the share of its time, or by frames of its capacity.
 *  @param window  NULL gives 0
 *  @return 0 (nothing yet) to 1; a first window that is complete gives 1 */
VDNA_API double vdna_window_progress(const vdna_window *window);

/** Tell whether lack of capacity has dropped a frame that is younger than `length_us`.
 *  @param window  NULL gives 0
 *  @return 1 if so; 0 otherwise, and always for windows by frames and first windows */
VDNA_API uint32_t vdna_window_truncated(const vdna_window *window);

/** Get the stamp of the last frame that left early.
 *  @param window  NULL gives 0
 *  @return microseconds, while vdna_window_truncated() gives 1; 0 otherwise */
VDNA_API int64_t vdna_window_left_utime(const vdna_window *window);

/** Count the frames dropped for lack of capacity since vdna_window_init().
 *  @param window  NULL gives 0
 *  @return frames; 0 for windows by frames and first windows */
VDNA_API uint64_t vdna_window_left_early(const vdna_window *window);

/** Count how often the window was emptied because camera time ran backwards, since
 *  vdna_window_init().
 *  @param window  NULL gives 0
 *  @return restarts */
VDNA_API uint64_t vdna_window_restarts(const vdna_window *window);

#ifdef __cplusplus
}
#endif

#endif
