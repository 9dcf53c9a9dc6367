/** @file vdna/window.h
 *  @brief Sliding windows: the Visual DNA of the last N frames, or of the last T microseconds.
 *
 *  A window keeps the bin of every sample that it holds (two bytes each), so that a frame that
 *  leaves is subtracted exactly: at any time the histogram is, bit for bit, that of the frames in
 *  the window, however many came and went before. Memory and the cost of a frame are fixed.
 *
 *  By time the window is the frames with newest - utime < T, and it never holds more than
 *  `capacity` frames. When more come within T, the oldest leave early, and `truncated` says so.
 */
#ifndef VDNA_WINDOW_H
#define VDNA_WINDOW_H

#include <vdna/hist.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Most bins of a window's histogram: two of the 65536 values that a sample is kept as stand for
 *  "below the range" and "above the range". */
#define VDNA_WINDOW_BINS_MAX (VDNA_HIST_BINS_MAX - 2u)

/** Shape of a window. Fill with vdna_window_config_init(), then set capacity, taps and range. */
typedef struct vdna_window_config {
    uint32_t struct_size;         /**< bytes of this struct, set by vdna_window_config_init() */
    uint32_t capacity;            /**< most frames in the window, >= 1 */
    int64_t length_us;            /**< T, >= 1; 0 = the last `capacity` frames whatever their time
                                       (default) */
    const vdna_activations *taps; /**< [tap_count], what each frame looks like: neurons, samples and
                                       layout; `values` is not looked at. Borrowed as long as the
                                       window is in use */
    size_t tap_count;             /**< >= 1 */
    const float *range;           /**< [neurons of all taps][2], passes vdna_range_check();
                                       borrowed as long as the window is in use */
    uint32_t bins;                /**< VDNA_HIST_BINS_MIN..VDNA_WINDOW_BINS_MAX */
} vdna_window_config;

/** A sliding window. Defined here so that it can sit anywhere; read the fields, never write
 *  them. */
typedef struct vdna_window {
    vdna_window_config config; /**< as it was given */
    vdna_hist hist;            /**< of the frames in the window, `hist.frames` of them; look
                                    at it with vdna_hist_view_of() */
    int64_t *utime;            /**< [capacity], private */
    uint16_t *slots;           /**< [capacity][frame_values], private */
    size_t frame_values;       /**< activations of one frame, all taps together */
    uint32_t oldest;           /**< private */
    uint32_t truncated;  /**< 1 while, for want of capacity, a frame is missing that is younger
                              than length_us; 0 by frames */
    int64_t first_utime; /**< of the oldest frame, valid while there is one */
    int64_t last_utime;  /**< of the newest frame, valid while there is one */
    int64_t left_utime;  /**< of the last frame that left early, valid while `truncated` */
    uint64_t left_early; /**< frames that left for want of capacity since init; 0 by frames */
    uint64_t restarts;   /**< times that the window was emptied because camera time ran
                              backwards, since init */
} vdna_window;

/** Write the defaults: 1000 bins, by frames; the caller must set capacity, taps and range.
 *  @param config  NULL is allowed */
VDNA_API void vdna_window_config_init(vdna_window_config *config);

/** Bytes that vdna_window_init() needs: 2 for each sample of `capacity` frames, 8 for each frame,
 *  and a histogram.
 *  @param config  its range is not looked at
 *  @return bytes; 0 if a field breaks its rule, or if `capacity` frames could bring a mass past
 *          UINT32_MAX */
VDNA_API size_t vdna_window_mem_size(const vdna_window_config *config);

/** Make an empty window in `mem`, which must stay valid while `out_window` is in use.
 *  @param config  copied; its taps and range are borrowed
 *  @param mem  aligned for int64_t, `mem_size` bytes
 *  @param mem_size  at least vdna_window_mem_size()
 *  @param out_window  may be moved, but not copied: its state is in the struct and the block
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small */
VDNA_API vdna_status vdna_window_init(const vdna_window_config *config, void *mem, size_t mem_size,
                                      vdna_window *out_window);

/** Add a frame; those that no longer belong to the window leave it. After an error the window is
 *  unchanged.
 *  A stamp earlier than the newest one empties the window first, because it would not be one
 *  stretch of time; equal stamps are in order. That holds by frames as well.
 *  @param window     added to
 *  @param utime      the camera's stamp in microseconds
 *  @param taps       [tap_count], of the shape in the config
 *  @param tap_count  as in the config
 *  @return VDNA_OK; VDNA_ERR_ARG, VDNA_ERR_MISMATCH or VDNA_ERR_NONFINITE for a bad frame */
VDNA_API vdna_status vdna_window_add(vdna_window *window, int64_t utime,
                                     const vdna_activations *taps, size_t tap_count);

/** Empty the window. Counters stay.
 *  @param window  NULL is allowed */
VDNA_API void vdna_window_reset(vdna_window *window);

#ifdef __cplusplus
}
#endif

#endif
