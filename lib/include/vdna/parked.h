/** @file vdna/parked.h
 *  @brief Does the camera still see what it saw? A picture that is an earlier one up to the noise
 *         of its sensor needs no network: the earlier answer holds.
 *
 *  Two steps, as in vdna/health.h: vdna_parked_measure() reads a picture, of which a decoder's
 *  smallest reduction is enough; vdna_parked_look() compares it with the reference, the last
 *  picture that was answered in full: vdna_parked_keep(). Slow motion therefore adds up until it
 *  is seen.
 *
 *  Noise. How much two pictures of one view differ is measured on the camera itself, in each window
 *  of VDNA_PARKED_WINDOW looks in which the view stands: then pictures that are far apart in time
 *  differ no more than neighbours do, while motion makes them differ ever more. Before the first
 *  such window nothing is parked; the newest counts.
 *
 *  A frozen camera is not parked. A picture whose measures equal, to the last bit, those of one of
 *  the VDNA_PARKED_REMEMBERED looks before it is never called parked, so that vdna_health_take()
 *  sees it and tells that it is FROZEN or REPEATED: noise always changes some of them.
 *
 *  Only integers are used, nothing is allocated, and a measured picture may cross to another
 *  process.
 */
#ifndef VDNA_PARKED_H
#define VDNA_PARKED_H

#include <vdna/pixels.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_PARKED_BLOCKS 192u      /**< numbers of a measured picture: 16 columns, 12 rows */
#define VDNA_PARKED_WINDOW 16u       /**< looks in a window that measures the noise */
#define VDNA_PARKED_REMEMBERED 32u   /**< looks that a repeated picture is recognised among */
#define VDNA_PARKED_LIMIT_MAX 25500u /**< greatest limit of vdna_parked_init() */

/** What is measured of one picture: of each block of vdna_health_picture the sum over its 100
 *  samples, so the unit is a hundredth of a grey level. */
typedef struct vdna_parked_picture {
    uint16_t levels[VDNA_PARKED_BLOCKS]; /**< row by row, 0..25500 */
} vdna_parked_picture;

/** The looks of one camera. Read `looks` and `noise`, never write anything. The difference of two
 *  pictures is the sum of the squared differences of their levels. */
typedef struct vdna_parked {
    uint64_t looks; /**< since vdna_parked_init() */
    uint64_t noise; /**< mean difference of two neighbours while the view stands; 0 = not known */
    uint64_t neighbours; /**< private: sum of the window's differences of neighbours */
    uint64_t distant;    /**< private: sum of those to the window's first, in its second half */
    uint64_t limit;      /**< private: greatest difference of what is parked */
    uint64_t hashes[VDNA_PARKED_REMEMBERED]; /**< private: ring of the newest looks */
    vdna_parked_picture newest;              /**< private: of the newest look */
    vdna_parked_picture first;               /**< private: of the window */
    vdna_parked_picture reference;           /**< private: valid with `has_reference` */
    uint32_t window;                         /**< private: looks in it */
    uint32_t has_reference;                  /**< private: 1 if there is one */
} vdna_parked;

/** Measure one picture.
 *  @param pixels  as for vdna_health_measure(); needed for this call only
 *  @param out_picture  the caller's
 *  @return VDNA_OK; VDNA_ERR_ARG for sides, channels, stride or rgb that cannot be */
VDNA_API vdna_status vdna_parked_measure(const vdna_pixels *pixels,
                                         vdna_parked_picture *out_picture);

/** Begin with a camera, of which nothing is known.
 *  @param parked  the caller's; untouched on error
 *  @param limit  root mean square of the differences of the blocks' levels beyond which nothing is
 *                parked, however much noise there is; hundredths of a grey level,
 *                0..VDNA_PARKED_LIMIT_MAX. Views of places a step apart differ by 250 and more in
 *                all pictures tried
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_parked_init(vdna_parked *parked, uint32_t limit);

/** Look at the camera's next picture.
 *  @param parked   from vdna_parked_init()
 *  @param picture  from vdna_parked_measure()
 *  @return 1 if it is the reference up to noise: its root mean square difference is at most 1.5
 *          times that of the noise, and within the limit; else 0: answer it in full */
VDNA_API uint32_t vdna_parked_look(vdna_parked *parked, const vdna_parked_picture *picture);

/** Take the newest look for the reference: it was answered in full.
 *  @param parked  from vdna_parked_init(), with a look */
VDNA_API void vdna_parked_keep(vdna_parked *parked);

#ifdef __cplusplus
}
#endif

#endif
