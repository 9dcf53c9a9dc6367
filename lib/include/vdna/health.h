/** @file vdna/health.h
 *  @brief Frame health: is a picture worth looking at, and does the camera still give new ones?
 *
 *  A network answers whatever it is shown. A lens cap, a dead sensor or a driver that repeats its
 *  last picture gives a Visual DNA as any picture does, and it ranks. So frames are judged before
 *  they are counted, in two steps: vdna_health_measure() reads one picture, vdna_health_take()
 *  judges it by itself and by those before it.
 *
 *  Only integers are used, so the same pixels give the same verdict on every processor. Nothing is
 *  allocated, and what is measured of a picture is a struct that may cross to another process.
 *
 *  What it does not see: a picture that is black or covered in part (the rest may be enough, and a
 *  night looks like that), blur, a camera that looks elsewhere, a loop of more than
 *  VDNA_HEALTH_REMEMBERED_MAX pictures, and now and then noise that is like a scene by chance: in
 *  pictures smaller than 96 x 72, or in blocks of strong compression (JPEG below quality 10, in
 *  pictures smaller than 320 x 240).
 *
 *  Thresholds lie between pictures and faults. The pictures: 1942 of a park in twelve months, of
 *  webcams by day, twilight and night, and of a robot's route in autumn and snow, and rendered
 *  drives in eight conditions (test/system/test_health.py prints their extremes). The faults: a
 *  thousand scripts of each kind, raw and as JPEG (`test_unit_health_faults 1000` prints theirs,
 *  and those of nights, fog, walls and snow with less in them than in any of the pictures).
 */
#ifndef VDNA_HEALTH_H
#define VDNA_HEALTH_H

#include <vdna/pixels.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Verdict on a frame. The first that applies, in this order, counts. */
enum {
    VDNA_HEALTH_OK = 0,           /**< usable, and not seen before */
    VDNA_HEALTH_TOO_SMALL = 1,    /**< a side is below `min_side` */
    VDNA_HEALTH_SATURATED = 2,    /**< nearly all white */
    VDNA_HEALTH_UNIFORM = 3,      /**< one grey level but for noise: black, white, grey, lens cap */
    VDNA_HEALTH_NOISE = 4,        /**< differences from pixel to pixel, none from place to place */
    VDNA_HEALTH_SIZE_CHANGED = 5, /**< of quite another size than the frames before it */
    VDNA_HEALTH_FROZEN = 6,       /**< the same pixels as the frame before it */
    VDNA_HEALTH_REPEATED = 7,     /**< the same pixels as an earlier picture that is remembered */
    VDNA_HEALTH_COUNT = 8         /**< number of verdicts, not one itself */
};

#define VDNA_HEALTH_REMEMBERED_MAX 32u /**< most pictures that are remembered */
#define VDNA_HEALTH_WINDOW_MAX 64u     /**< most frames in the window of verdicts */

/** What is measured of one picture.
 *
 *  The picture is sampled at 160 x 120 places: sample (i, j) is the pixel in column
 *  `(2 i + 1) width / 320` and row `(2 j + 1) height / 240`, rounded down. Its grey level is
 *  `(77 red + 150 green + 29 blue + 128) / 256`, rounded down. 10 x 10 neighbouring samples make a
 *  block, of which there are 16 x 12. The level of a block is the mean of its samples, rounded. */
typedef struct vdna_health_picture {
    uint64_t hash;      /**< of width, height and all bytes of pixels, without row padding; equal
                             pictures have equal hashes, others differ with near certainty */
    uint32_t width;     /**< pixels */
    uint32_t height;    /**< pixels */
    uint32_t mean;      /**< of the levels of all blocks, rounded down, 0..255 */
    uint32_t contrast;  /**< level of the 4th lightest block less that of the 4th darkest, so that
                             a few blocks with hot pixels do not count; 0..255 */
    uint32_t structure; /**< square root, rounded down, of the covariance of the levels of blocks
                             that are neighbours in a row or column; 0 if that is negative. Noise
                             differs from block to block, so it adds nothing here; 0..127 */
    uint32_t grain;     /**< median over the blocks of the standard deviation of a block's samples,
                             both rounded down: texture and noise; 1..127, where 0 is 1 */
    uint32_t bright;    /**< samples of level 250 or more, per thousand, rounded down */
    uint32_t reserved;  /**< 0 */
} vdna_health_picture;

/** What counts as a fault. Fill with vdna_health_config_init(). */
typedef struct vdna_health_config {
    uint32_t struct_size;   /**< bytes of this struct, set by vdna_health_config_init() */
    uint32_t min_side;      /**< pixels; TOO_SMALL below; default 32: a network sees nothing in
                                 less */
    uint32_t min_contrast;  /**< grey levels; UNIFORM below, 0 = never; default 16. Least of the
                                 pictures: 36, a webcam at twilight; most of lens caps: 12. A
                                 thermal camera whose driver does not stretch its levels needs
                                 less */
    uint32_t min_structure; /**< percent of `grain`; NOISE below, 0 = never; default 25. Least of
                                 the pictures: 56, foliage; most of uniform and colour noise: 8 */
    uint32_t max_bright;    /**< per thousand; SATURATED above, 1000 = never; default 900. Most of
                                 the pictures: 466, a park below a white sky */
    uint32_t max_resize;    /**< percent, >= 100: a side that is longer or shorter than in the frame
                                 before by more than this factor is a change of size; default 150.
                                 Another crop does no harm, because networks resize; webcams that
                                 are visited in turn differ by up to 139 */
    uint32_t settle;        /**< frames that are SIZE_CHANGED after a change of size, the changed
                                 one included; 0 = never; default 5. A camera that is set to
                                 another size costs these; one that changes all the time never
                                 settles */
    uint32_t remembered;    /**< usable pictures that are remembered, 0..VDNA_HEALTH_REMEMBERED_MAX;
                                 default 32; 0 = neither FROZEN nor REPEATED */
    uint32_t window;        /**< frames in the window of vdna_health_degraded(),
                                 1..VDNA_HEALTH_WINDOW_MAX; default 32 */
} vdna_health_config;

/** The frames of one camera. Read `counts` and `frames`, never write anything. */
typedef struct vdna_health {
    uint64_t counts[VDNA_HEALTH_COUNT];          /**< frames by verdict since vdna_health_init();
                                                      counts[VDNA_HEALTH_OK] is the number of usable
                                                      pictures, distinct as far as they are remembered */
    uint64_t frames;                             /**< since vdna_health_init() */
    uint64_t newest;                             /**< private: hash of the newest frame */
    uint64_t hashes[VDNA_HEALTH_REMEMBERED_MAX]; /**< private: ring of remembered pictures */
    uint8_t verdicts[VDNA_HEALTH_WINDOW_MAX];    /**< private: ring of the newest verdicts */
    vdna_health_config config;                   /**< private: as given */
    uint32_t width;                              /**< private: of the newest frame */
    uint32_t height;                             /**< private: of the newest frame */
    uint32_t settled; /**< private: frames since a change of size, up to `settle` */
} vdna_health;

/** Measure one picture. Reads all of its pixels once.
 *  @param pixels  sides of 1..65535; needed for this call only
 *  @param out_picture  the caller's
 *  @return VDNA_OK; VDNA_ERR_ARG for sides, channels, stride or rgb that cannot be */
VDNA_API vdna_status vdna_health_measure(const vdna_pixels *pixels,
                                         vdna_health_picture *out_picture);

/** Write the defaults.
 *  @param config  NULL is allowed */
VDNA_API void vdna_health_config_init(vdna_health_config *config);

/** Begin with a camera.
 *  @param health  the caller's; untouched on error
 *  @param config  copied; NULL = the defaults
 *  @return VDNA_OK; VDNA_ERR_ARG for fields out of their limits */
VDNA_API vdna_status vdna_health_init(vdna_health *health, const vdna_health_config *config);

/** Judge one picture by itself; nothing is counted.
 *  @param health  from vdna_health_init()
 *  @param picture  from vdna_health_measure()
 *  @return VDNA_HEALTH_OK, TOO_SMALL, SATURATED, UNIFORM or NOISE */
VDNA_API uint32_t vdna_health_judge(const vdna_health *health, const vdna_health_picture *picture);

/** Take the camera's next frame, judge it and count it.
 *
 *  A frame is SIZE_CHANGED if its size or that of one of the `settle` - 1 frames before it is a
 *  change. The newest `remembered` pictures that were OK are remembered. A robot that stands still
 *  is not FROZEN: the noise of its sensor changes pixels.
 *  @param health  from vdna_health_init()
 *  @param picture  from vdna_health_measure()
 *  @return VDNA_HEALTH_...: leave the frame out unless it is OK */
VDNA_API uint32_t vdna_health_take(vdna_health *health, const vdna_health_picture *picture);

/** Why a camera is of no use at present: more than half of the last `window` frames, or of all if
 *  there are fewer, are not OK.
 *  @param health  from vdna_health_init()
 *  @return their most frequent verdict, the first of several; VDNA_HEALTH_OK if they are no more
 *          than half */
VDNA_API uint32_t vdna_health_degraded(const vdna_health *health);

/** Name a verdict.
 *  @param verdict  any value
 *  @return "ok", "too small", "saturated", "uniform", "noise", "size changed", "frozen",
 *          "repeated", or "unknown verdict": a constant string */
VDNA_API const char *vdna_health_text(uint32_t verdict);

#ifdef __cplusplus
}
#endif

#endif
