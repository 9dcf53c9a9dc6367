/* The forward filter over places and gears; vdna/localise.h defines it. Private to lib/localise. */
#ifndef VDNA_LOCALISE_PLACE_FILTER_H
#define VDNA_LOCALISE_PLACE_FILTER_H

#include <vdna/localise.h>

/* Map frames in a block of vdna_place_filter's motion, for a small stack fewer, and the farthest
 * that a gear carries. */
enum {
    VDNA_MOTION_BLOCK = sizeof(void *) > 4 ? 64 : 16,
    VDNA_MOTION_REACH = 8,
    VDNA_MOTION_SOURCES = VDNA_MOTION_BLOCK + 2 * VDNA_MOTION_REACH
};

/* The window of a frame: which of the frames in the order of their places belong to it. */
typedef struct vdna_place_window {
    uint32_t frame;       /* whose window it is */
    uint32_t first, past; /* places in the order */
} vdna_place_window;

typedef struct vdna_place_filter {
    double *posterior; /* [gears][frames]; times `scale` their sum is 1 */
    double *places;    /* [frames], sums over the gears, times `scale` too; before that, evidence */
    double *sums;      /* [frames + 1], running sums of the places, in their order */
    double *sources;   /* [gears][VDNA_MOTION_SOURCES], working memory of the motion */
    vdna_place_window *windows; /* [frames], in the order of places; NULL = places are frames */
    vdna_gear gears[VDNA_GEARS_MAX];
    double scale;
    double sharpness, clutter, jump, gear_change, evidence_share, confidence[4];
    double evidence;
    uint64_t jumps; /* a bit for each of the last 64 steps, the newest lowest */
    uint32_t frames, gear_count, tolerance;
    uint32_t steps; /* since the reset, at most VDNA_LOCALISE_LEAD_FRAMES */
} vdna_place_filter;

/* Statistics of the distances of one frame. */
typedef struct vdna_row_contrast {
    double mean, deviation;
    float least;
    uint32_t nearest; /* index of `least`, the lowest */
} vdna_row_contrast;

/* Sort the windows' frames by their place, then by index, and find the windows.
 * @param places   [count]
 * @param windows  [count] */
void vdna_place_windows(const int64_t *places, uint32_t count, uint32_t tolerance,
                        vdna_place_window *windows);

/* Begin anew: the robot may be anywhere. */
void vdna_place_filter_reset(vdna_place_filter *filter);

/* @param distances  [count], count >= 1 */
vdna_row_contrast vdna_row_contrast_of(const float *distances, uint32_t count);

/* One step.
 * @param distances  [filter->frames], finite, at most 1e18
 * @param answer     the one before; frame, mass and confidence are written */
void vdna_place_filter_step(vdna_place_filter *filter, const float *distances,
                            const vdna_row_contrast *contrast, vdna_localise_answer *answer);

#endif
