/** @file vdna/trust.h
 *  @brief Trust in the choice: predicted recall with an interval, "none of these fits", warming up
 *         no longer than needed, choosing again.
 *
 *  Two parts. The first tells a map about itself, once, when it is built: each stored run plays the
 *  live one against every other, which gives a cell of a table for each pair. The second,
 *  vdna_trust, takes these tables and is fed the frames of a warmup, each by its distance to the
 *  nearest frame of every candidate. Neither allocates, reads a clock or calls libm: the same input
 *  gives the same bits on every machine.
 *
 *      vdna_trust_config_init(&config);               // then runs = K, and tables
 *      vdna_trust_init(&config, mem, size, &trust);
 *      for each frame of the warmup:
 *          for each candidate b:
 *              vdna_trust_nearest(embedding, frames of b, ..., &nearest[b], NULL);
 *              vdna_trust_nearest_int8(last layer, ..., &likeness[b]);
 *          vdna_trust_feed(trust, nearest, likeness);  // stop if vdna_trust_settled_frames() > 0
 *      vdna_trust_predict(trust, distances of vdna_emd_mean(), predictions, &answer);
 *      vdna_trust_choose(trust, the choice);
 *      for every n-th frame of the drive:
 *          vdna_trust_suit(trust, nearest, confidences of vdna/localise.h, suits);
 *          vdna_trust_reconsider(trust, suits, n, &choice);
 *
 *  Definition. A map has K runs. Doubles throughout. ln(x) is log(max(x, 1e-6)); a recall R, 0..1,
 *  is handled as the angle y = asin(sqrt(R)), R = sin(clip(y, 0, pi/2))^2, in which its noise is
 *  nearly the same everywhere.
 *
 *  - **Relative distance** of a frame x and its nearest frame m of a run, by Euclid, the first of
 *    equals: rho = min(|x - m| / sqrt(max(|x| |m|, 1e-12)), 2), on embeddings as they are, about no
 *    mean. vdna_trust_nearest().
 *  - **Own scale** w of a run: mean rho of its frames to the nearest at another place, more than 2
 *    tolerances away; at least 1e-6; 1 if no frame has one, or none has a label. s = rho / w: at 1,
 *    a frame is no nearer than a wrong place. vdna_trust_own_scale().
 *  - **Windows** of a run of F frames: n = max(1, min(40, F / 3)) frames from floor(i (F - n) / 6 +
 *    0.5), i = 0..6, each start once. vdna_trust_windows().
 *  - **Cell** of a run a as if live, and a candidate b, for each window of a: `nearest`, the mean
 *    rho; `likeness`, the same on the embeddings of the network's last layer; `recall` outside the
 *    window, of frames that have a label; `distance`, the mean EMD of the window's Visual DNA to
 *    that of all of b. vdna_trust_pair() writes the first three. The distance needs the activations
 *    of a, which no file keeps, so whoever has them writes it. Programs that can follow a as a
 *    robot would may write for `recall` what it gets in b after a warmup, the same in all windows,
 *    as ours do: a robot does not know the mean of a whole run, so it gets a little less.
 *  - **Correlation time** of a run a: of every two candidates i, j, the difference of rho_i /
 *    mean(rho_i) and rho_j / mean(rho_j), cut into 8 blocks of F / 8 frames: frames of a block *
 *    variance of the block means / variance of the frames. tau_a is the median over the pairs, tau
 *    = max(1, median of the tau_a). vdna_trust_correlation_time().
 *
 *  A run is **labelled** if cells have what predictions need: as long as some cell of two runs
 *  lacks `recall` or `distance` in a window, the run with most such cells is left out, the last
 *  of equals. L runs remain; none if that would be one alone. In what follows, x_ab is
 *  ln(`nearest` / w_b), y_ab the angle of `recall`, D_ab `distance`, each the mean over the
 *  windows of a, a != b, both labelled, and the constants are:
 *
 *  | localiser | beta0 | T_beta | m0 | T_m | T_u | sigma | v | V |
 *  |---|---|---|---|---|---|---|---|---|
 *  | CENTRED, the default | -0.45 | 0.43 | 1.33 | 0.16 | 0.04 | 0.13 | 0.5 | 0.12^2 |
 *  | EUCLIDEAN, the paper's | -0.90 | 0.10 | 1.00 | 0.13 | 0.08 | 0.10 | 0 | see below |
 *
 *  - **Slope**: with x' and y' about the means of their columns, beta = (beta0 / T_beta^2 +
 *    sum(x' y') / sigma^2) / (1 / T_beta^2 + sum(x'^2) / sigma^2).
 *  - **Intercepts**: l_b = mean over a of y_ab - beta x_ab; g = sigma^2 / (L - 1), h = (T_u^2 + g)
 *    / L, k = T_m^2 / (T_m^2 + h), u = T_u^2 / (T_u^2 + g), p = m0 + (beta0 - beta) mean(x), mu = p
 *    + k (mean(l) - p), c_b = mu + u (l_b - mu).
 *  - **Transfer** t_b, from a live run's distances D_a: w_a = exp(-(D_a - min D) / max(0.25 sd,
 *    1e-12)), sd that of all D_ab, or of two runs 0.2 of their mean; t_b is the angle of sum(w_a
 *    R_ab) / sum(w_a), R_ab being the recall of y_ab, R_bb = 1. Runs that look like the live one
 *    vote with what they got in b themselves.
 *  - **Prediction**: y_b = (1 - v) (c_b + beta ln(mean s_b)) + v t_b.
 *  - **Interval**, 80 %: y_b +- q d. Each labelled run is left out in turn, the rest fitted, and
 *    the windows of that run predicted, e being the errors. d^2 = V(L) (2 + sum(mean(e^2) /
 *    V(L - 1))) / (2 + L), each mean over a run's windows and candidates. EUCLIDEAN: V(L) =
 *    (1 - u) T_u^2 + (1 - u)^2 k h + sigma^2 + 0.1^2. For the candidate that is predicted best,
 *    the mean is over those predicted best, and d at least that of the others. q is the 0.9
 *    quantile of Student's t of L + 1 degrees of freedom, from 30 on that of 30.
 *  - **Skill** = 1 - mean |R - predicted| / mean |R - mean of the candidate's column|, over the
 *    same left-out runs; 0 if the latter, summed over these, is at most 1e-9. At 0 or below,
 *    distances tell no more of recall than the candidates' means do.
 *  - **Unlike**: ln of the mean rho of the live frames to the nearest candidate, minus the largest
 *    such value of a stored run a (mean over its windows of the least ln `likeness` of other runs),
 *    is above 0.10. Where some cell has no `likeness`, on `nearest`, above 0.20 (EUCLIDEAN 0.10).
 *    It needs two runs, and no labels.
 *  - **Blank**: of the last layer alone, ln of the same mean rho, minus the median of those values
 *    of the stored runs (the upper of two), is above 0.05, and the standard deviation of rho over
 *    the live frames is below 0.025 of its mean. Frames of a drive differ more; those of a covered
 *    lens do not, and a map of day and night has a loneliest run so lonely that they are as near.
 *  - **Settled**, from n = 10 frames: z_b = c_b + beta ln(mean s_b) is highest for k, the first of
 *    equals, and for all others z_k - z_b >= 1.645 |beta| sqrt(var(s_b / mean s_b - s_k / mean
 *    s_k) tau / n), var being unbiased and over the n frames. If not all runs, or fewer than 3, are
 *    labelled: z_b = beta0 ln(mean rho_b), and beta0 for beta.
 *    Never with a skill of 0 or below among 6 labelled runs or more, nor if no tau is known; one
 *    candidate alone is settled at 10.
 *  - **Choosing again**: G_b = max(0, G_b + f (R_b - R_k - 0.02)), G_k = 0, for every f-th frame of
 *    the drive, R being how a candidate suits the frame, (confidence_b + min(s) / s_b) / 2 of
 *    vdna_trust_suit() or whatever else the caller takes for it. The b of greatest G_b - C_b > 0
 * replaces the choice k, and all G begin anew. C_b = `switch_cost`, doubled if b was left less than
 * 100 frames ago, and again for each such return in the last 100 frames.
 *
 *  What this cannot see: a frozen picture, a mirrored one, another route of the same look. Of a
 *  warmup of 10 frames predictions are some points too high.
 */
#ifndef VDNA_TRUST_H
#define VDNA_TRUST_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_TRUST_WINDOWS 7u          /**< most windows of a run */
#define VDNA_TRUST_RUNS_MIN 3u         /**< fewest labelled runs for a prediction */
#define VDNA_TRUST_SKILL_RUNS_MIN 6u   /**< fewest labelled runs for a judgement of skill */
#define VDNA_TRUST_FRAMES_MIN 5u       /**< fewest live frames for a prediction or a verdict */
#define VDNA_TRUST_SETTLED_FRAMES 10u  /**< fewest live frames of a choice that has settled */
#define VDNA_TRUST_FRAMES_MAX 1000000u /**< most live frames of a warmup */
#define VDNA_TRUST_RUNS_MAX 4096u      /**< most runs of a map */
#define VDNA_TRUST_CODES_MAX 131072u   /**< most numbers in an embedding of 8-bit codes */

/* ---- What a map tells about itself ---- */

/** Whose recall is predicted. */
enum {
    VDNA_TRUST_CENTRED = 0, /**< nearest frame about the means of run and map, by direction: that of
                                 vdna/localise.h without its filter */
    VDNA_TRUST_EUCLIDEAN = 1 /**< nearest frame of the embeddings as they are: the paper's */
};

/** A stored run. All pointers are borrowed for the length of the call. */
typedef struct vdna_trust_run {
    const float *embeddings;  /**< [frames][dim], finite, about no mean: to localise by */
    const int8_t *last_layer; /**< [frames][last_layer_dim], codes of vdna/int8.h; NULL = none */
    const float *last_layer_scale; /**< [frames], finite, >= 0; NULL = none */
    const int64_t *place; /**< [frames], place numbers, exact up to 2^53, INT64_MIN = this frame has
                             none; NULL = not labelled with places */
    const double *position; /**< [frames][3], metres in one frame for all runs, NaN = this frame has
                                 none; for horizontal distances the third is 0; NULL = none. Where
                                 both runs have positions, these decide, and places do not */
    const void *codes; /**< of the embeddings, by vdna_knn_encode(): the nearest is found faster,
                            with the same bits; NULL = none */
    uint32_t frames;   /**< >= 1 */
    uint32_t dim;      /**< >= 1 */
    uint32_t last_layer_dim; /**< 1..VDNA_TRUST_CODES_MAX; 0 = none */
    uint32_t reserved;       /**< 0 */
} vdna_trust_run;

/** What a run as if live found in a candidate, by its windows. What is beyond the last window is
 *  NaN, and so is what is not known. */
typedef struct vdna_trust_cell {
    double nearest[VDNA_TRUST_WINDOWS];  /**< mean rho, 0..2 */
    double likeness[VDNA_TRUST_WINDOWS]; /**< mean rho on the last layer, 0..2 */
    double recall[VDNA_TRUST_WINDOWS];   /**< 0..1, outside the window */
    double distance[VDNA_TRUST_WINDOWS]; /**< mean EMD, bins, >= 0 */
} vdna_trust_cell;

/** Tell the windows of a run.
 *  @param frames      of the run
 *  @param out_first   [VDNA_TRUST_WINDOWS], the first frame of each window; NULL = not wanted
 *  @param out_frames  of each window; NULL = not wanted
 *  @return windows, 1..VDNA_TRUST_WINDOWS; 0 if there is no frame, and then nothing is written */
VDNA_API uint32_t vdna_trust_windows(uint32_t frames, uint32_t *out_first, uint32_t *out_frames);

/** Relative distance of a frame to the nearest of a run.
 *  @param embedding     [dim], finite, about no mean
 *  @param frames        [count][dim], finite, about no mean
 *  @param dim, count    >= 1
 *  @param out_relative  rho, 0..2
 *  @param out_index     row of the nearest frame, which vdna_knn() finds; NULL = not wanted
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE as vdna_knn() */
VDNA_API vdna_status vdna_trust_nearest(const float *embedding, const float *frames, uint32_t dim,
                                        uint32_t count, double *out_relative, uint32_t *out_index);

/** The same of a run, by its codes if it has any.
 *  @param embedding  [run->dim], as for vdna_trust_nearest()
 *  @param run  of which embeddings, codes, frames and dim are read
 *  @param out_relative, out_index  as for vdna_trust_nearest()
 *  @return as vdna_trust_nearest() */
VDNA_API vdna_status vdna_trust_nearest_in(const float *embedding, const vdna_trust_run *run,
                                           double *out_relative, uint32_t *out_index);

/** The same on codes of vdna/int8.h, with exact sums.
 *  @param codes         [dim], of vdna_int8_encode()
 *  @param scale         of the codes
 *  @param frames        [count][dim]
 *  @param scales        [count], finite, >= 0
 *  @param dim           1..VDNA_TRUST_CODES_MAX
 *  @param count         >= 1
 *  @param out_relative  rho, 0..2
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE for a scale that is negative or not finite */
VDNA_API vdna_status vdna_trust_nearest_int8(const int8_t *codes, float scale, const int8_t *frames,
                                             const float *scales, uint32_t dim, uint32_t count,
                                             double *out_relative);

/** Own scale w of a run.
 *  @param run        its last layer is ignored; positions decide if there are any
 *  @param tolerance  metres or place numbers, finite, >= 0: as far apart are frames of one place
 *  @param out_own    1e-6..2
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE as vdna_knn() */
VDNA_API vdna_status vdna_trust_own_scale(const vdna_trust_run *run, double tolerance,
                                          double *out_own);

/** Bytes of working memory that vdna_trust_pair() needs.
 *  @param live, candidate  their pointers are ignored
 *  @return bytes; 0 if a field breaks its rule or they are beyond size_t */
VDNA_API size_t vdna_trust_pair_scratch_size(const vdna_trust_run *live,
                                             const vdna_trust_run *candidate);

/** Play a stored run as if live against another: a cell of the tables, all but its `distance`.
 *  @param live, candidate  of the same `dim`; likeness is NaN unless both have a last layer, recall
 *                          if frames outside a window have no label in one unit
 *  @param tolerance     metres or place numbers, finite, >= 0: as far apart are frames of one place
 *  @param localiser     VDNA_TRUST_CENTRED or _EUCLIDEAN
 *  @param scratch, scratch_size  aligned for double, at least the bytes of
 *                       vdna_trust_pair_scratch_size()
 *  @param out_relative  [frames of the live run], rho of each: for vdna_trust_correlation_time()
 *  @param out_cell      complete; `distance` is NaN
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NOMEM if the scratch is too small; VDNA_ERR_MISMATCH for
 *          different dimensions; VDNA_ERR_NONFINITE. After an error the outputs are unspecified */
VDNA_API vdna_status vdna_trust_pair(const vdna_trust_run *live, const vdna_trust_run *candidate,
                                     double tolerance, uint32_t localiser, void *scratch,
                                     size_t scratch_size, double *out_relative,
                                     vdna_trust_cell *out_cell);

/** Correlation time of a run as if live.
 *  @param relative    [candidates][frames], rho of vdna_trust_pair() for every other run
 *  @param candidates  those others, 0..VDNA_TRUST_RUNS_MAX
 *  @param frames      of the run
 *  @param scratch     [candidates (candidates - 1) / 2], working memory
 *  @param out_frames  tau, in frames; NaN if it cannot be told: fewer than two candidates, fewer
 *                     than 16 frames, or no differences
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_trust_correlation_time(const double *relative, uint32_t candidates,
                                                 uint32_t frames, double *scratch,
                                                 double *out_frames);

/** What a map knows about itself. A further run costs a row and a column of cells, and a tau; the
 *  tau of the runs before change little, and may be measured again. */
typedef struct vdna_trust_tables {
    const uint32_t *frames;       /**< [runs], of each run, >= 1: tells how many windows it has */
    const double *own_scale;      /**< [runs], w, 1e-6..2 */
    const double *correlation;    /**< [runs], tau of each, >= 0; NaN = not known */
    const vdna_trust_cell *cells; /**< [runs][runs], rows as if live, columns candidates; those of
                                     the diagonal are ignored. In the windows of the row, `nearest`
                                     is finite; the others are finite, or NaN = not known */
} vdna_trust_tables;

/** Check the tables: every number within its range.
 *  @param tables  of `runs` runs
 *  @param runs    1..VDNA_TRUST_RUNS_MAX
 *  @return VDNA_OK; VDNA_ERR_ARG, also for a run without frames; VDNA_ERR_NONFINITE for a number
 *          beyond its range */
VDNA_API vdna_status vdna_trust_tables_check(const vdna_trust_tables *tables, uint32_t runs);

/* ---- What a live run may expect ---- */

/** Configuration. Fill with vdna_trust_config_init(), then set `runs`, and `tables` if the map has
 *  them. */
typedef struct vdna_trust_config {
    uint32_t struct_size;            /**< set by vdna_trust_config_init() */
    uint32_t runs;                   /**< K, the candidates, 1..VDNA_TRUST_RUNS_MAX */
    const vdna_trust_tables *tables; /**< of these runs; needed for vdna_trust_init() only; NULL =
                                          the map knows nothing about itself (default) */
    uint32_t localiser;              /**< whose recall the tables have: VDNA_TRUST_CENTRED (default)
                                          or _EUCLIDEAN */
    uint32_t reserved;               /**< 0 */
    double min_recall; /**< POOR below this predicted recall of the best candidate, 0..1; default 0:
                            never. The definition's for EUCLIDEAN is 0.5 */
    double switch_cost; /**< frames that a switch to another candidate costs, 1..1e6; default 5 */
} vdna_trust_config;

/** Whether any of the candidates fits. */
enum {
    VDNA_TRUST_FITS = 0,   /**< nothing speaks against it, or there are too few frames to tell */
    VDNA_TRUST_UNLIKE = 1, /**< the live run looks like none of the candidates */
    VDNA_TRUST_POOR = 2,   /**< the best predicted recall is below `min_recall` */
    VDNA_TRUST_BLANK = 3   /**< the live frames hardly differ, and look like none of the candidates:
                                the lens is covered, or the camera broken */
};

/** Why there is no prediction; the first that holds. */
enum {
    VDNA_TRUST_REASON_NONE = 0,         /**< there is one */
    VDNA_TRUST_REASON_NO_TABLES = 1,    /**< the map knows nothing about itself */
    VDNA_TRUST_REASON_FEW_FRAMES = 2,   /**< fewer than VDNA_TRUST_FRAMES_MIN live frames */
    VDNA_TRUST_REASON_UNLIKE = 3,       /**< the verdict is VDNA_TRUST_UNLIKE */
    VDNA_TRUST_REASON_FEW_RUNS = 4,     /**< fewer than VDNA_TRUST_RUNS_MIN labelled runs */
    VDNA_TRUST_REASON_NOT_LABELLED = 5, /**< this run is not labelled, though enough others are */
    VDNA_TRUST_REASON_NO_DISTANCE = 6   /**< the distances of the live Visual DNA were not given */
};

/** What to expect of a candidate. */
typedef struct vdna_trust_prediction {
    double recall; /**< predicted share of frames localised correctly in it, 0..1; NaN = `reason` */
    double low;    /**< lower end of the 80 % interval, 0..1; NaN as `recall` */
    double high;   /**< its upper end */
    double transfer; /**< R of t, 0..1: for ranking, descending, ties by distance; NaN without
                          distances, labels of this run, or two labelled runs */
    double nearest;  /**< mean s of the live frames, w being 1 without tables; NaN = no frame yet */
    double score;    /**< z, by which the choice settles: for ranking after a few frames,
                          descending; NaN = no frame yet */
    uint32_t reason; /**< why there is no prediction; VDNA_TRUST_REASON_NONE if there is */
    uint32_t reserved; /**< 0 */
} vdna_trust_prediction;

/** What the warmup says so far. */
typedef struct vdna_trust_answer {
    uint32_t verdict; /**< VDNA_TRUST_UNLIKE, _BLANK, _POOR, the first that holds, or _FITS */
    uint32_t frames;  /**< n, fed since the last reset */
    uint32_t choice;  /**< the candidate of highest z: that of which `settled_frames` speaks */
    uint32_t settled_frames; /**< frames after which the choice had settled; 0 = not yet */
    double unlike; /**< how much farther than the loneliest stored run, in ln; NaN = not known:
                        no frame, no tables, one run */
} vdna_trust_answer;

/** What the tables say as a whole; see the definition. */
typedef struct vdna_trust_fit {
    uint32_t labelled;    /**< L */
    uint32_t by_likeness; /**< 1 if `unlike` is judged on the last layer, so that vdna_trust_feed()
                               needs `likeness` */
    double skill;       /**< at 0 or below, distances say nothing about recall; not to be judged of
                             fewer than VDNA_TRUST_SKILL_RUNS_MIN labelled runs; NaN as `slope` */
    double slope;       /**< beta; NaN if fewer than VDNA_TRUST_RUNS_MIN runs are labelled */
    double sd;          /**< d, in radians; NaN as `slope` */
    double sd_best;     /**< d of the candidate that is predicted best; NaN as `slope` */
    double quantile;    /**< q; NaN as `slope` */
    double far;         /**< ln rho of the loneliest stored run; NaN = no tables, or one run */
    double correlation; /**< tau, frames, >= 1; NaN = not known */
} vdna_trust_fit;

/** Trust in the choice among the candidates of a map, within the caller's block. */
typedef struct vdna_trust vdna_trust;

/** Write the defaults; the caller must set runs.
 *  @param config  NULL is allowed */
VDNA_API void vdna_trust_config_init(vdna_trust_config *config);

/** Bytes that vdna_trust_init() needs: for each pair of candidates, both ways and with itself, 32,
 *  for each candidate 112, and some 300, whether or not there are tables.
 *  @param config  its tables are ignored
 *  @return bytes; 0 if a field breaks its rule */
VDNA_API size_t vdna_trust_mem_size(const vdna_trust_config *config);

/** Fit the tables, and begin a warmup. The time grows with the cube of the labelled runs.
 *  @param config    needed for this call only, and so are its tables
 *  @param mem       aligned for int64_t, `mem_size` bytes; holds the object, so it must stay where
 *                   it is as long as that is in use
 *  @param mem_size  at least vdna_trust_mem_size()
 *  @param out_trust the object, at the beginning of `mem`
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small;
 *          VDNA_ERR_NONFINITE for a number of the tables beyond its range */
VDNA_API vdna_status vdna_trust_init(const vdna_trust_config *config, void *mem, size_t mem_size,
                                     vdna_trust **out_trust);

/** Begin the warmup anew; no candidate is chosen.
 *  @param trust  NULL is allowed */
VDNA_API void vdna_trust_reset(vdna_trust *trust);

/** Take a frame of the warmup. All count alike, whenever they come. Not every frame need come here,
 *  but `settled` then counts those that do.
 *  @param trust     from vdna_trust_init()
 *  @param nearest   [runs], rho of this frame in each candidate, 0..2
 *  @param likeness  [runs], the same on the last layer; ignored unless vdna_trust_fit says
 *                   `by_likeness`
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE for a number beyond 0..2; VDNA_ERR_FULL after
 *          VDNA_TRUST_FRAMES_MAX frames. After an error nothing has changed */
VDNA_API vdna_status vdna_trust_feed(vdna_trust *trust, const double *nearest,
                                     const double *likeness);

/** Tell whether the warmup may stop.
 *  @param trust  NULL gives 0
 *  @return frames after which the choice had settled, since the last reset; 0 = not yet */
VDNA_API uint32_t vdna_trust_settled_frames(const vdna_trust *trust);

/** Predict, of the frames so far.
 *  @param trust            from vdna_trust_init(); only its working memory changes
 *  @param distance_bins    [runs], of the live Visual DNA to each candidate's, finite, >= 0; NULL =
 *                          not known
 *  @param out_predictions  [runs]
 *  @param out_answer       for the candidates as a whole
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE for a distance beyond its range */
VDNA_API vdna_status vdna_trust_predict(vdna_trust *trust, const double *distance_bins,
                                        vdna_trust_prediction *out_predictions,
                                        vdna_trust_answer *out_answer);

/** Judge one candidate, whoever chose it.
 *  @param trust        from vdna_trust_init()
 *  @param candidate    below `runs`
 *  @param predictions  [runs], of the newest vdna_trust_predict()
 *  @param answer       of the same call; `verdict` and `unlike` become those of this candidate
 * alone
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_trust_judge(const vdna_trust *trust, uint32_t candidate,
                                      const vdna_trust_prediction *predictions,
                                      vdna_trust_answer *answer);

/** Begin to watch a choice, whoever made it.
 *  @param trust      from vdna_trust_init()
 *  @param candidate  below `runs`
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_trust_choose(vdna_trust *trust, uint32_t candidate);

/** Expect a frame's recall in each candidate, from its nearest distances alone.
 *  @param trust       from vdna_trust_init()
 *  @param nearest     [runs], rho of this frame in each candidate, 0..2
 *  @param out_recall  [runs], 0..1; NaN where there are no predictions for lack of tables or labels
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE for a number beyond 0..2 */
VDNA_API vdna_status vdna_trust_expect(const vdna_trust *trust, const double *nearest,
                                       double *out_recall);

/** Tell how well each candidate suits a frame: half by how near its nearest frame is, compared with
 *  the nearest candidate's, half by how sure of its place a filter is that follows the drive in it.
 *  The first sees a change of light at once, the second whether it matters. Neither needs labels.
 *  @param trust       from vdna_trust_init()
 *  @param nearest     [runs], rho of this frame in each candidate, 0..2
 *  @param confidence  [runs], of a localiser of vdna/localise.h in each candidate, 0..1; NULL =
 * there are none, and nearness is all
 *  @param out_suits   [runs], 0..1, for vdna_trust_reconsider(); may be `nearest` itself
 *  @return VDNA_OK; VDNA_ERR_ARG, also for a confidence beyond 0..1; VDNA_ERR_NONFINITE for a
 * number of `nearest` beyond 0..2. After an error nothing is written */
VDNA_API vdna_status vdna_trust_suit(const vdna_trust *trust, const double *nearest,
                                     const double *confidence, double *out_suits);

/** Take a frame of the drive, and choose another candidate if that has paid for long enough.
 *  @param trust       from vdna_trust_init(), after vdna_trust_choose()
 *  @param recall      [runs], of each candidate, 0..1: from vdna_trust_suit(), or in any other
 *                     currency, such as vdna_trust_expect() or confidences of vdna/localise.h; NaN
 *                     = not known, with which gains against this candidate, and of it, begin anew.
 *                     Leave out frames while the robot stands: they repeat one another
 *  @param frames      of the drive for which this one stands, 1..1e6: 5 if every fifth comes here
 *  @param out_choice  the choice now
 *  @return VDNA_OK; VDNA_ERR_ARG, also before a choice and for a recall beyond 0..1. After an error
 *          nothing has changed */
VDNA_API vdna_status vdna_trust_reconsider(vdna_trust *trust, const double *recall, uint32_t frames,
                                           uint32_t *out_choice);

/** Count the candidates.
 *  @param trust  NULL gives 0
 *  @return K */
VDNA_API uint32_t vdna_trust_runs(const vdna_trust *trust);

/** Look at the fit.
 *  @param trust  NULL gives NULL
 *  @return borrowed as long as the object is in use */
VDNA_API const vdna_trust_fit *vdna_trust_fitted(const vdna_trust *trust);

/** Look at the intercepts c.
 *  @param trust  NULL gives NULL
 *  @return [runs], radians, NaN for runs that are not labelled or are too few; borrowed as long as
 *          the object is in use */
VDNA_API const double *vdna_trust_intercepts(const vdna_trust *trust);

/** English text of a reason, to follow "no prediction: ".
 *  @param reason  any value
 *  @return a constant string, never NULL; "" for VDNA_TRUST_REASON_NONE and unknown values */
VDNA_API const char *vdna_trust_reason_text(uint32_t reason);

#ifdef __cplusplus
}
#endif

#endif
