/** @file vdna/experience_localise.h
 *  @brief How a localiser of vdna/localise.h is set up for an experience: which of its frames show
 *         the same place.
 *
 *  Definition. T = `tolerance`; S = the median horizontal distance of frames that follow one
 *  another, of an even number the upper one, those with an unknown position left out.
 *
 *  - With positions, that is if S > 0, the tolerance is T / S, rounded down, at most the frames. In
 *    the order of the drive, a frame without a position is a place of its own. A frame within T of
 *    posts that were left passes a spot again: it has the number of the nearest, the lowest of
 *    equals. Any other frame has its index, and becomes a post unless one of those not left yet is
 *    nearer than T / 4. A post is left by the first frame that is farther than 2 T from it: a robot
 *    that stands, creeps or turns passes nothing again. If T is 0, every number is the index.
 *  - Otherwise, with place numbers, these are the numbers, and the tolerance is T, rounded down.
 *  - Otherwise a frame's number is its index, and the tolerance 2.
 *
 *  The clutter is 0.2: of a robot's frames, more say nothing than the default of
 *  vdna/localise.h has.
 *
 *  Posts of one spot are too far apart to be many, so the time is linear in the frames.
 */
#ifndef VDNA_EXPERIENCE_LOCALISE_H
#define VDNA_EXPERIENCE_LOCALISE_H

#include <vdna/localise.h>
#include <vdna/map.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Choose places, their tolerance and the constants of the confidence. Allocates some 60 bytes a
 *  frame for the call if there are positions.
 *  @param experience  open, or built with frames and labels; its embeddings do not matter
 *  @param tolerance   within which a match is good, finite and >= 0: metres with positions, else
 *                     place numbers
 *  @param place       [frames], room for the numbers
 *  @param config      from vdna_localise_config_init(): `tolerance` and `clutter` are set,
 *                     `confidence`, to constants that do not look at distances, if embeddings are
 *                     not about a mean, or that fit their distances if they are projected, and
 * `place`, to NULL if every number is the index, else to `place`
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NOMEM. After an error the config is as it was */
VDNA_API vdna_status vdna_experience_localise_config(const vdna_experience *experience,
                                                     double tolerance, int64_t *place,
                                                     vdna_localise_config *config);

#ifdef __cplusplus
}
#endif

#endif
