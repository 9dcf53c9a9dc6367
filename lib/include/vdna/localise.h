/** @file vdna/localise.h
 *  @brief Localisation within one experience: the nearest frame, and a place filter that also uses
 *         the frames before, with a confidence.
 *
 *  Two objects in memory of the caller's: vdna_localise_map has the frames of the experience,
 *  prepared once; vdna_localise follows a robot in them. Neither allocates, reads a clock or calls
 *  libm: exp, log and sqrt are the library's own, so the same input gives the same bits on every
 *  machine. The instructions of a frame do not depend on its content.
 *
 *  Definition. N map frames m_j and live frames x of `dim` numbers; G gears; doubles throughout,
 *  except for the directions.
 *
 *  - **Map.** M = mean of the m_j (0 if not `centred`); u_j = unit(m_j - M), where
 *    unit(v) = v / max(|v|, 1e-12); S = median of |m_(j+1) - m_j|, each rounded to float.
 *  - **Live mean.** Begins as L = M, worth n = `mean_frames` frames; as 0 if that is 0. A frame x
 * counts if |x - x'| > `gate` S, x' being the last frame that counted, or if there is none yet: n =
 * min(n + 1, `mean_frames_max`), L = L + (x - L) / n. If not `centred`, L stays 0. The robot moves
 * if the frame counts; otherwise it stands, and the filter is not stepped.
 *  - **Distance.** d_j = 1 - u_j . unit(x - L), where the numbers of both directions are rounded to
 *    multiples of 1/32767, their product is exact, and what would leave 0..2 is kept within: d_j is
 *    within sqrt(dim) / 32500 of the exact value, and as a rule within 4e-5, whatever `dim`. 0 =
 *    same direction, 1 = no likeness, 2 = opposite. A frame that equals its mean has distance 1 to
 *    all. The nearest frame is the one of least distance; the lowest of equals.
 *  - **Evidence.** z_j = (mean(d) - d_j) / (sd(d) + 1e-9), sd that of all N;
 *    e_j = exp(`sharpness` (z_j - max z)); w_j = (1 - `clutter`) e_j / mean(e) + `clutter`.
 *  - **Motion.** The posterior p[g][j] begins as 1 / (G N), and is first moved by the second step:
 *    s[g] = (1 - `gear_change`) p[g] + `gear_change` / G * sum over g of p[g]; gear g carries share
 *    k of s[g][j] to the frame j + `first` + k, what would leave an end stays there, which gives q;
 *    p = (1 - `jump`) q + `jump` / (G N).
 *  - **Update.** t = sum of p[g][j] w_j; p[g][j] = p[g][j] w_j / t. From the second step,
 *    E = E + `evidence_share` (log t - E), which begins as 0.
 *  - **Answer.** P_j = sum over g of p[g][j]. The window of frame j is all frames whose place
 * differs from its own by at most `tolerance`; a frame's place is its index, or what `place` says.
 * The frame that is told is the one of largest P, the first of equals, in the window of most mass;
 *    among equal windows that of the lowest place, then of the lowest frame.
 *    m = that mass, at most 1 - 1e-9.
 *  - **Confidence** = 1 / (1 + exp(-(c0 + c1 clip(log(m / (1 - m)), -8, 8) + c2 E + c3 D))), c
 * being `confidence` and D the least distance in the window that is told.
 *
 *  - **Jumps.** From the 11th step on, a step jumps if no gear carries anything from the frame that
 *    was told before to a frame of the window that is told now: then the robot has been carried, or
 *    the filter has no track. vdna_localise_jumps() counts them.
 *
 *  With `mean_frames` = 0 and `confidence` = -2.5, 0.53, 1.1, 0 this is the reference, which begins
 * with an empty mean, and does not look at D. When a robot leaves the route, the filter follows
 * whatever looks least unlike; D tells that it is unlike. The default c0 and c3 are for embeddings
 * of 1008 numbers, a 3 x 3 grid of a network's features; distances in some of their dimensions are
 * smaller.
 *
 *  Consequences: scaling or shifting all activations of map and drive changes nothing. On a map
 * whose frames are all alike, or that has one frame, every distance is 1: the evidence says
 * nothing, the posterior follows from the motion alone, and no answer is confident. A window that
 * holds the whole map always has all of the mass.
 *
 *  Loops. Where a route passes a place twice, give both passes the same place numbers: the mass of
 *  both then counts for the place, instead of one pass against the other.
 */
#ifndef VDNA_LOCALISE_H
#define VDNA_LOCALISE_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_LOCALISE_DIM_MAX 1048576 /**< numbers in an embedding to localise by */
#define VDNA_GEARS_MAX 8              /**< gears of a filter */
#define VDNA_GEAR_SHARES 6            /**< frames over which one gear spreads */
#define VDNA_GEAR_FIRST_MIN (-8)      /**< least `first` of a gear */
#define VDNA_GEAR_FIRST_MAX 3         /**< greatest `first` of a gear */

/** Frames by which a filter should find its place before its answers are used: feed so many of the
 *  last frames of a warmup, and take those before them into the mean only. */
#define VDNA_LOCALISE_LEAD_FRAMES 10u

/** Jumps among the last 64 steps from which on a robot is taken to be on another route; being
 * carried once is one. Where many pictures are from elsewhere, such as 30 % of them, a robot on the
 *  route often has as many. The library does not use it. */
#define VDNA_LOCALISE_LOST_JUMPS 2u

/** Confidence below which our programs call an answer unsure, unless told otherwise. The library
 *  does not use it. */
#define VDNA_LOCALISE_MIN_CONFIDENCE_DEFAULT 0.96

/** Frames of an experience to localise in. Fill with vdna_localise_map_config_init(). */
typedef struct vdna_localise_map_config {
    uint32_t struct_size; /**< set by vdna_localise_map_config_init() */
    uint32_t frames;      /**< N, >= 1 */
    uint32_t dim;         /**< numbers in an embedding, 1..VDNA_LOCALISE_DIM_MAX */
    uint32_t centred;     /**< 1 = distances are about the means (default), 0 = about the origin */
    const float *embeddings; /**< [frames][dim], finite, in the order of the drive; needed for
                                  vdna_localise_map_init() only */
} vdna_localise_map_config;

/** The prepared frames of an experience, within the caller's block. Never written after its
 *  initialisation, so many localisers may share it, in any threads. */
typedef struct vdna_localise_map vdna_localise_map;

/** How far the robot may get in the map from one live frame to the next. */
typedef struct vdna_gear {
    int32_t first;     /**< map frames from one live frame to the next, for the first share:
                            VDNA_GEAR_FIRST_MIN..VDNA_GEAR_FIRST_MAX */
    uint32_t reserved; /**< 0 */
    double share[VDNA_GEAR_SHARES]; /**< probability of `first`, `first` + 1, ...: each >= 0, their
                                         sum 1 within 1e-6 */
} vdna_gear;

/** A localiser. Fill with vdna_localise_config_init(), then set `map` and `tolerance`. */
typedef struct vdna_localise_config {
    uint32_t struct_size; /**< set by vdna_localise_config_init() */
    uint32_t tolerance;   /**< greatest difference of two numbers of the same place: map frames,
                               or units of `place`; 0 = every number is a place of its own */
    const vdna_localise_map *map; /**< borrowed as long as the localiser is in use */
    const int64_t *place;   /**< [frames], place numbers in any order, of which INT64_MIN says that
                                 the frame is a place of its own; needed for vdna_localise_init()
                                 only; NULL = the frame's index (default) */
    const vdna_gear *gears; /**< [gear_count]; needed for vdna_localise_init() only; NULL = those of
                                 the definition (default): -1..4 frames forwards, 2..6 for a robot
                                 faster than the map's, -4..0 for one that drives backwards */
    uint32_t gear_count;    /**< 1..VDNA_GEARS_MAX; 0 if `gears` is NULL */
    uint32_t mean_frames;   /**< frames that the map's own mean is worth in the live mean; default
                                 3; 0 = the live mean begins empty */
    uint32_t mean_frames_max; /**< frames of memory of the live mean, >= 1, >= `mean_frames`;
                                 default 1000 */
    uint32_t reserved;        /**< 0 */
    double gate;           /**< of the map's median step: standing if nearer than that to the last
                                frame that counted; >= 0; default 0.15 */
    double sharpness;      /**< of the evidence, 0..100; default 2 */
    double clutter;        /**< share of live frames that say nothing, above 0, at most 1; default
                                0.1 */
    double jump;           /**< probability, per frame, that the robot was put elsewhere, 0..1;
                                default 0.01 */
    double gear_change;    /**< probability, per frame, of a change of gears, 0..1; default 0.05 */
    double evidence_share; /**< of a new frame in the running mean E, 0..1; default 0.15 */
    double confidence[4];  /**< c0..c3, each -100..100; default 3.6, 0.53, 1.1, -12 */
} vdna_localise_config;

/** A localiser, within the caller's block. */
typedef struct vdna_localise vdna_localise;

/** Where the robot is. */
typedef struct vdna_localise_answer {
    uint32_t frame;          /**< map frame by the filter */
    uint32_t nearest;        /**< map frame of least distance to this live frame alone */
    uint32_t moving;         /**< 1 if the filter was stepped; 0 while standing, when `frame`,
                                  `confidence` and `mass` are those of the answer before */
    uint32_t reserved;       /**< 0 */
    double confidence;       /**< 0..1, of `frame` */
    double mass;             /**< posterior of the window of `frame`, at most 1 - 1e-9 */
    double nearest_distance; /**< of `nearest`, 0..2 */
} vdna_localise_answer;

/** Write the defaults: centred; the caller must set frames, dim and embeddings.
 *  @param config  NULL is allowed */
VDNA_API void vdna_localise_map_config_init(vdna_localise_map_config *config);

/** Bytes that vdna_localise_map_init() needs: 2 for each number of the embeddings, rows of an odd
 *  dimension rounded up, 8 for each of their mean, and some 50.
 *  @param config  its embeddings are ignored
 *  @return bytes; 0 if a field breaks its rule or the sum is beyond size_t */
VDNA_API size_t vdna_localise_map_mem_size(const vdna_localise_map_config *config);

/** Prepare the frames of an experience.
 *  @param config    needed for this call only
 *  @param mem       aligned for int64_t, `mem_size` bytes; holds the map, so it must stay where it
 *                   is as long as that is in use; unspecified after VDNA_ERR_NONFINITE
 *  @param mem_size  at least vdna_localise_map_mem_size()
 *  @param out_map   the map, at the beginning of `mem`
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small;
 *          VDNA_ERR_NONFINITE if an embedding is not finite */
VDNA_API vdna_status vdna_localise_map_init(const vdna_localise_map_config *config, void *mem,
                                            size_t mem_size, vdna_localise_map **out_map);

/** Get the median step S: half of the map's frames are farther from the one before.
 *  @param map  NULL gives 0
 *  @return Euclidean distance; 0 if there is one frame, or most are alike */
VDNA_API double vdna_localise_map_step(const vdna_localise_map *map);

/** Get the mean M of the frames.
 *  @param map  NULL gives NULL
 *  @return [dim], borrowed as long as the map is in use; all 0 if not centred */
VDNA_API const double *vdna_localise_map_mean(const vdna_localise_map *map);

/** Write the defaults; the caller must set map and tolerance.
 *  @param config  NULL is allowed */
VDNA_API void vdna_localise_config_init(vdna_localise_config *config);

/** Bytes that vdna_localise_init() needs: for each map frame 20 and 8 for each gear, 44 by default,
 *  and 12 more if there are places; for each dimension 14; and some 3 KB.
 *  @param config  `place` may be any address other than NULL if there will be places
 *  @return bytes; 0 if a field breaks its rule or the sum is beyond size_t */
VDNA_API size_t vdna_localise_mem_size(const vdna_localise_config *config);

/** Make a localiser that knows nothing yet.
 *  @param config    needed for this call only; its map is borrowed
 *  @param mem       aligned for int64_t, `mem_size` bytes; holds the localiser, so it must stay
 *                   where it is as long as that is in use
 *  @param mem_size  at least vdna_localise_mem_size()
 *  @param out_localise  the localiser, at the beginning of `mem`
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small */
VDNA_API vdna_status vdna_localise_init(const vdna_localise_config *config, void *mem,
                                        size_t mem_size, vdna_localise **out_localise);

/** Forget everything: the live mean and the posterior begin anew.
 *  @param localise  NULL is allowed */
VDNA_API void vdna_localise_reset(vdna_localise *localise);

/** Take a frame of the warmup into the live mean only; the posterior stays.
 *  @param localise   from vdna_localise_init()
 *  @param embedding  [dim]
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a number is not finite. After an error
 *          nothing has changed */
VDNA_API vdna_status vdna_localise_warm_up(vdna_localise *localise, const float *embedding);

/** Localise a frame.
 *  @param localise    from vdna_localise_init()
 *  @param embedding   [dim]
 *  @param out_answer  where the robot is; until the first step, `frame` is 0, `mass` and
 *                     `confidence` are 0: when the frame is the last one of the warmup again
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a number is not finite. After an error
 *          nothing has changed */
VDNA_API vdna_status vdna_localise_feed(vdna_localise *localise, const float *embedding,
                                        vdna_localise_answer *out_answer);

/** Step the filter by distances that the caller has from elsewhere; the live mean stays.
 *  @param localise    from vdna_localise_init()
 *  @param distances   [frames], finite, at most 1e18 in size, smaller = more alike; of any scale,
 * but c3 of the confidence counts them as they are
 *  @param out_answer  where the robot is, `moving` = 1
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a distance is not finite or too large.
 * After an error nothing has changed */
VDNA_API vdna_status vdna_localise_feed_distances(vdna_localise *localise, const float *distances,
                                                  vdna_localise_answer *out_answer);

/** Count the map's frames.
 *  @param localise  NULL gives 0
 *  @return N */
VDNA_API uint32_t vdna_localise_frames(const vdna_localise *localise);

/** Get the numbers in an embedding.
 *  @param localise  NULL gives 0
 *  @return dim */
VDNA_API uint32_t vdna_localise_dim(const vdna_localise *localise);

/** Get the distances d of the frame that was fed last.
 *  @param localise  NULL gives NULL
 *  @return [frames], borrowed as long as the localiser is in use; all 0 before the first frame */
VDNA_API const float *vdna_localise_distances(const vdna_localise *localise);

/** Get the posterior P of every map frame.
 *  @param localise  NULL writes nothing
 *  @param out       [frames], each 0..1, their sum 1 */
VDNA_API void vdna_localise_posterior(const vdna_localise *localise, double *out);

/** Get the live mean L.
 *  @param localise  NULL gives NULL
 *  @return [dim], borrowed as long as the localiser is in use; all 0 if not centred */
VDNA_API const double *vdna_localise_mean(const vdna_localise *localise);

/** Get the evidence E: the running mean of the log evidence, in nats.
 *  @param localise  NULL gives 0
 *  @return 0 if the frames look like any place; positive if they look like the places that the
 *          motion predicts */
VDNA_API double vdna_localise_evidence(const vdna_localise *localise);

/** Count the jumps: on another route the filter finds no track, whatever the pictures look like,
 * and jumps from one resemblance to the next; on the map's route it does not, however little it is
 * confident. At least 40 steps tell.
 *  @param localise  NULL gives 0
 *  @return jumps among the last 64 steps, those while standing not counted */
VDNA_API uint32_t vdna_localise_jumps(const vdna_localise *localise);

#ifdef __cplusplus
}
#endif

#endif
