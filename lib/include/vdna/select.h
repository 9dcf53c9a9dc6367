/** @file vdna/select.h
 *  @brief The selector: warm up on live frames, rank the experiences, choose one or say that none
 *         fits, localise in it, choose again.
 *
 *  States: WARMUP until the window is complete, then SELECTED until vdna_select_reset(); with
 *  trust, NONE_FITS in its place as long as no experience fits. Frames and their times are
 *  arguments, so a replay gives the same answers at any speed. Every answer says which of its
 *  fields are valid; a refused frame changes nothing but a counter.
 *
 *  Definition: as in the paper, the live Visual DNA is that of the warmup window only, and a
 *  candidate's that of all its frames.
 *
 *  Localising. With localisers of vdna/localise.h, one for each candidate, a frame's place is what
 *  the place filter says, with a confidence: vdna_select_where(). The frames of the warmup go into
 *  the live mean of each; the last VDNA_LOCALISE_LEAD_FRAMES of them are kept until the choice, and
 *  then lead the filters of the chosen to where the robot is. In the first `top` experiences of the
 *  ranking at once, the most confident of their filters answers; the first of equals. Without
 * localisers it is the nearest frame of the chosen experience, by the Euclidean distance of the
 * embeddings as they are.
 *
 *  Trust. With a vdna_trust of vdna/trust.h, which each frame of the window is measured for, the
 *  choice comes with what may be expected of it: vdna_select_trust(), vdna_select_predictions().
 *
 *  - Order. By distance; or by transfer, if `rank` says so and trust tells that of every candidate.
 *    With `stop_early` the first choice comes as soon as it has settled: by transfer with 20 frames
 *    at least; where that is not told, in the order of the predictions' scores, because so few
 *    frames have a distance from anything.
 *  - NONE_FITS, if trust's verdict is UNLIKE, BLANK or POOR. Ranking, choice and localisation are
 *    there as in SELECTED, of the least bad. Meanwhile another warmup begins with the next frame,
 *    and when it is complete, be it settled or not, the selector chooses again, and so on until one
 *    fits. All localisers begin anew with each of these warmups and follow the robot from then on,
 *    so the new choice knows the place at once, and its live mean has no frame from before.
 *    Restarts begin the warmup anew, and leave the choice.
 *  - Choosing again, with `reselect`, in SELECTED. The localisers of all candidates follow the
 *    robot at each frame. Of every fifth frame at which the robot moves, vdna_trust_reconsider()
 *    compares how the candidates suit it, by vdna_trust_suit() with the localisers' confidences. A
 *    switch brings the new choice to the front of the ranking, and is localised in with the very
 *    same frame.
 *
 *  Commands of an operator, which take effect at once and outlast resets: vdna_select_pin(),
 *  vdna_select_exclude(), vdna_select_shadow(). The ranking always says what the selector itself
 *  would choose; what it localises in, the choice, is the first of it unless one is pinned or kept
 *  by shadow. That one is localised in alone, whatever `top` is, and from the next frame on, also
 *  in WARMUP; the verdict is on it.
 *
 *  Bounds. With `exact`, a ranking of many candidates computes few distances: those of its first
 *  places, and what it takes to know that they are the first. It needs sums of each candidate's
 *  counts, of vdna/bounds.h, 1/25 of these in memory; vdna_select_init() makes them and reads all
 *  counts. Trust then takes a bound for a distance where there is no other.
 *
 *  A frame costs a search among all frames of all candidates in WARMUP and NONE_FITS, if there is
 *  trust, and a step of every localiser with `reselect` and in NONE_FITS. Without trust all is as
 *  in the definition.
 *
 *  Time. Stamps go through vdna/camera_time.h first: late frames are refused and counted, and the
 *  unit of the stamps is recognised. A warmup begins anew, with the frame at hand, when camera time
 *  steps back, when its unit is recognised to be another one than microseconds, and after a gap
 *  longer than the warmup: T, or for a warmup by frames N times the mean spacing of the frames in
 *  the window, and 10 s at least.
 */
#ifndef VDNA_SELECT_H
#define VDNA_SELECT_H

#include <vdna/camera_time.h>
#include <vdna/hist.h>
#include <vdna/knn.h>
#include <vdna/localise.h>
#include <vdna/rank.h>
#include <vdna/trust.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Frames of a warmup where nobody asks for another length; the paper's. */
#define VDNA_WARMUP_FRAMES_DEFAULT 100u

/** Fewest frames of a warmup by time where nobody asks for another number. */
#define VDNA_WARMUP_FRAMES_MIN_DEFAULT 10u

/** State of a selector. */
enum {
    VDNA_SELECT_WARMUP = 0,   /**< collecting the live Visual DNA; there is no ranking yet */
    VDNA_SELECT_SELECTED = 1, /**< an experience is chosen; frames are localised in it */
    VDNA_SELECT_NONE_FITS = 2 /**< as SELECTED, but no experience fits: vdna_select_trust() says
                                   why. Another choice follows */
};

/** What orders a ranking. */
enum {
    VDNA_SELECT_BY_EMD = 0,      /**< the distance of the Visual DNAs, the least first */
    VDNA_SELECT_BY_TRANSFER = 1, /**< `transfer` of the predictions, the highest first; the nearer
                                      of equals */
    VDNA_SELECT_BY_RELATIVE = 2  /**< `score` of the predictions, the highest first; the nearer of
                                      equals */
};

/** No candidate: nothing is pinned. */
#define VDNA_SELECT_NONE UINT32_MAX

/** Why a warmup began anew. */
enum {
    VDNA_RESTART_NONE = 0,      /**< it did not */
    VDNA_RESTART_BACKWARDS = 1, /**< camera time stepped back further than a late frame does */
    VDNA_RESTART_GAP = 2,       /**< no frame for longer than the warmup */
    VDNA_RESTART_UNIT = 3       /**< the stamps turned out not to be microseconds */
};

/** One experience to choose from. All pointers are borrowed as long as the selector is in use. */
typedef struct vdna_select_candidate {
    vdna_hist_view dna;      /**< of all frames of the experience */
    const float *embeddings; /**< [frames][dim]; NULL is allowed if there are localisers */
    uint32_t frames;         /**< >= 1 */
    uint32_t reserved;       /**< 0 */
} vdna_select_candidate;

/** Configuration of a selector. Fill with vdna_select_config_init(), then set candidates, dim and
 *  one of the two warmup lengths. */
typedef struct vdna_select_config {
    uint32_t struct_size;     /**< bytes of this struct, set by vdna_select_config_init() */
    uint32_t candidate_count; /**< >= 1 */
    const vdna_select_candidate *candidates; /**< [candidate_count], same shape and range; borrowed
                                                  as long as the selector is in use */
    uint32_t dim;                            /**< numbers in an embedding, >= 1 */
    uint32_t warmup_frames; /**< the first N accepted frames; 0 = not by frames (default) */
    int64_t warmup_us; /**< the first T microseconds of camera time; 0 = not by time (default) */
    int64_t late_us;   /**< frames this much older than the newest are late, microseconds, >= 0;
                            default VDNA_TIME_LATE_US_DEFAULT */
    uint32_t warmup_frames_min; /**< a warmup by time goes on until it has as many frames; default
                                     VDNA_WARMUP_FRAMES_MIN_DEFAULT */
    uint32_t time_unit; /**< of the stamps: VDNA_TIME_UNIT_...; default AUTO, to recognise it */
    vdna_localise *const *localisers; /**< [candidate_count], each of its candidate's frames; the
                                           array and they are borrowed, and changed, as long as the
                                           selector is in use; NULL = none (default) */
    uint32_t top; /**< localise in so many of the first of the ranking at once: 1 (default) or more,
                       of which all candidates are the most; without localisers 1 */
    uint32_t rank;     /**< VDNA_SELECT_BY_EMD (default) or _BY_TRANSFER, where trust has it */
    vdna_trust *trust; /**< in the choice among these candidates; borrowed, and changed, as long as
                            the selector is in use; NULL = none (default) */
    const vdna_trust_run *runs; /**< [candidate_count], of which embeddings, frames, dim and, if
                                     trust judges by it, the last layer are used; they and what they
                                     point to are borrowed as long as the selector is in use; needed
                                     with trust */
    uint32_t stop_early; /**< 1: choose when that has settled, at the latest after the whole warmup,
                              as always without trust; default 0 */
    uint32_t reselect;   /**< 1: reconsider the choice while driving; needs trust and localisers;
                              default 0 */
    uint32_t exact; /**< places of a ranking that have the distance, the rest a lower bound of it:
                         see vdna_select_is_bound(); 0 (default), or all candidates and more =
                         all */
    uint32_t reserved; /**< 0 */
} vdna_select_config;

/** One live frame. Nothing is kept after the call. */
typedef struct vdna_select_frame {
    int64_t utime;                /**< the camera's stamp, in the unit of the config */
    const vdna_activations *taps; /**< [tap_count], in the order of the histogram's neurons */
    size_t tap_count;             /**< >= 1 */
    const float *embedding;       /**< [dim] */
} vdna_select_frame;

/** Result of a frame. */
typedef struct vdna_select_answer {
    uint32_t state;        /**< VDNA_SELECT_... after this frame */
    uint32_t newly_ranked; /**< 1 if this frame completed a warmup: see
                                vdna_select_ranking() */
    uint32_t restarted;    /**< VDNA_RESTART_...: why the warmup began anew with this frame */
    uint32_t localised;    /**< 1 if `match` is valid */
    vdna_knn_match match;  /**< nearest frame of the experience localised in; by a localiser, the
                                squared distance is that of the directions: twice
                                `nearest_distance` */
} vdna_select_answer;

/** Where the robot is. */
typedef struct vdna_select_position {
    uint32_t candidate;          /**< experience localised in: the chosen one, if `top` is 1 */
    uint32_t reserved;           /**< 0 */
    vdna_localise_answer answer; /**< frames of that experience */
} vdna_select_position;

/** A selector, within the caller's block. */
typedef struct vdna_select vdna_select;

/** Write the defaults; the caller must set candidates, candidate_count, dim and one warmup.
 *
 *  In C and C++ a macro of this name calls vdna_select_config_init_sized(). The function itself is
 *  for programs and languages that know only the struct of version 0.1, which ended with
 *  `warmup_us`: it writes that much and sets `struct_size` to match.
 *  @param config  NULL is allowed */
VDNA_API void vdna_select_config_init(vdna_select_config *config);

/** Write the defaults of the fields that the caller's struct has.
 *  @param config       NULL is allowed
 *  @param struct_size  bytes of the struct that the caller was compiled with */
VDNA_API void vdna_select_config_init_sized(vdna_select_config *config, size_t struct_size);

/** Write the defaults of all fields that this header has.
 *  @param config  NULL is allowed */
#define vdna_select_config_init(config) \
    vdna_select_config_init_sized((config), sizeof(vdna_select_config))

/** Bytes that vdna_select_init() needs.
 *  @param config  complete; data behind the candidates' pointers is ignored
 *  @return bytes; 0 if the config is invalid */
VDNA_API size_t vdna_select_mem_size(const vdna_select_config *config);

/** Make a selector in `mem`.
 *  @param config  needed for this call only; its candidates, and what they point to, are borrowed
 *  @param mem  aligned for int64_t, `mem_size` bytes; holds the selector, so it must stay where it
 *              is as long as that is in use
 *  @param mem_size  at least vdna_select_mem_size()
 *  @param out_select  the selector, at the beginning of `mem`
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small;
 *          VDNA_ERR_MISMATCH or VDNA_ERR_EMPTY if the candidates do not compare with one another;
 *          with `exact` VDNA_ERR_OVERFLOW as vdna_bounds_sum() */
VDNA_API vdna_status vdna_select_init(const vdna_select_config *config, void *mem, size_t mem_size,
                                      vdna_select **out_select);

/** Take one live frame.
 *  In WARMUP it is offered to the window, a first window of vdna/window.h. A frame that completes
 *  the window without being in it is localised, if it can be. In SELECTED and NONE_FITS every frame
 *  is localised, unless it is late.
 *  @param select      from vdna_select_init()
 *  @param frame       needed for this call only
 *  @param last_layer  [last_layer_dim of the runs], the network's last layer of this frame; needed
 *                     if vdna_trust_fit says `by_likeness`, and ignored otherwise; NULL = none
 *  @param out_answer  says which of its fields are valid
 *  @return VDNA_OK; VDNA_ERR_ARG, VDNA_ERR_MISMATCH or VDNA_ERR_NONFINITE for a bad frame, which is
 *          refused whole and counted; VDNA_ERR_LATE for a frame older than one before it, which is
 *          counted apart; VDNA_ERR_OVERFLOW or VDNA_ERR_FULL if the window is too large
 *          to rank, in which case the selector warms up anew */
VDNA_API vdna_status vdna_select_feed_seen(vdna_select *select, const vdna_select_frame *frame,
                                           const float *last_layer, vdna_select_answer *out_answer);

/** Take one live frame without its last layer: vdna_select_feed_seen() with NULL.
 *  @param select      from vdna_select_init()
 *  @param frame       needed for this call only
 *  @param out_answer  says which of its fields are valid
 *  @return as vdna_select_feed_seen() */
VDNA_API vdna_status vdna_select_feed(vdna_select *select, const vdna_select_frame *frame,
                                      vdna_select_answer *out_answer);

/** Do now what the next frame would otherwise wait for. After a choice, the localisers of
 * candidates that have no say in the answer, though they may be chosen later, have yet to follow
 * the last frames of the warmup; it takes up to VDNA_LOCALISE_LEAD_FRAMES steps of each. For the
 * time between two frames: no answer depends on it.
 *  @param select  NULL is allowed */
VDNA_API void vdna_select_catch_up(vdna_select *select);

/** Forget the choice and the window, also of trust and of the localisers, and warm up again.
 *  Counters stay, and what is pinned, excluded, or kept by shadow.
 *  @param select  NULL is allowed */
VDNA_API void vdna_select_reset(vdna_select *select);

/** Get the state.
 *  @param select  NULL gives VDNA_SELECT_WARMUP
 *  @return VDNA_SELECT_... */
VDNA_API uint32_t vdna_select_state(const vdna_select *select);

/** Get the progress of the warmup.
 *  @param select  NULL gives 0
 *  @return 0 (nothing yet) to 1 (complete, or SELECTED); in NONE_FITS that of the next warmup, once
 *          a frame has begun it */
VDNA_API double vdna_select_progress(const vdna_select *select);

/** Pin a candidate: localise in it from the next frame on, whatever the ranking says. If another
 *  was pinned or kept by shadow in state WARMUP, the warmup begins anew.
 *  @param select     from vdna_select_init()
 *  @param candidate  not excluded; VDNA_SELECT_NONE = none any more: in shadow it stays the choice,
 *                    otherwise that is the first of the ranking at once
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_select_pin(vdna_select *select, uint32_t candidate);

/** Get what is pinned.
 *  @param select  NULL gives VDNA_SELECT_NONE
 *  @return candidate index, or VDNA_SELECT_NONE */
VDNA_API uint32_t vdna_select_pinned(const vdna_select *select);

/** Exclude a candidate, or include it again. What is excluded stands at the end of the ranking and
 *  is never the first; if it was the choice, the first of the rest is at once. What is included may
 *  be chosen the next time that a choice is made. A warmup under way begins anew.
 *  @param select     from vdna_select_init()
 *  @param candidate  its index
 *  @param on         1 = exclude: refused if it is pinned, or the last that may be chosen; 0 =
 *                    include
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_select_exclude(vdna_select *select, uint32_t candidate, uint32_t on);

/** Tell whether a candidate is excluded.
 *  @param select     NULL gives 0
 *  @param candidate  any number
 *  @return 1 if so; else 0 */
VDNA_API uint32_t vdna_select_is_excluded(const vdna_select *select, uint32_t candidate);

/** Only recommend, or act again. In shadow the choice stays what it is, or the first one that is
 *  made; rankings and switches say what the selector would do. Without, the first of the ranking
 *  becomes the choice at once, unless another is pinned; in state WARMUP the warmup begins anew if
 * a choice was kept.
 *  @param select  from vdna_select_init()
 *  @param on      1 = recommend; 0 = act
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_select_shadow(vdna_select *select, uint32_t on);

/** Tell whether the selector only recommends.
 *  @param select  NULL gives 0
 *  @return 1 if so; else 0 */
VDNA_API uint32_t vdna_select_in_shadow(const vdna_select *select);

/** Tell whether there is a choice, in which frames are localised.
 *  @param select  NULL gives 0
 *  @return 1 if so; 0 in state WARMUP, unless one is pinned or kept by shadow */
VDNA_API uint32_t vdna_select_has_choice(const vdna_select *select);

/** Get the choice.
 *  @param select  NULL gives 0
 *  @return candidate index: what is pinned or kept by shadow, or the first of the ranking; 0 if
 *          there is no choice */
VDNA_API uint32_t vdna_select_chosen(const vdna_select *select);

/** Get the margin: the second candidate's distance minus the first's, in the order of the choice.
 *  @param select  NULL gives 0
 *  @return bins; below 0 if something else than distance put the first before the second; 0 in
 *          state WARMUP and with only one candidate */
VDNA_API double vdna_select_margin_bins(const vdna_select *select);

/** Tell where the robot is, by the newest frame.
 *  @param select  NULL gives NULL
 *  @return borrowed until the next call that changes the selector; NULL without localisers, and
 *          before the first frame that is localised */
VDNA_API const vdna_select_position *vdna_select_where(const vdna_select *select);

/** Tell whether the robot seems to drive another route: the places where it seems to be jump as on
 *  no drive along the map's, see vdna_localise_jumps(). It takes some 40 frames after the choice.
 *  @param select  NULL gives 0
 *  @return 1 if so; 0 if not, in state WARMUP, and without localisers */
VDNA_API uint32_t vdna_select_is_lost(const vdna_select *select);

/** Get all candidates in the order in which the selector would choose them.
 *  @param select     NULL gives NULL
 *  @param out_count  entries: the candidates, or 0 with NULL; NULL = not wanted
 *  @return the one that the selector would choose first, what is excluded last, with their distance
 *          to the window of the warmup; `tied` says that only the order of the candidates told two
 *          apart. Borrowed until the next call that changes the selector; NULL in state WARMUP */
VDNA_API const vdna_rank_entry *vdna_select_ranking(const vdna_select *select, uint32_t *out_count);

/** Tell whether the ranking has a lower bound of a candidate's distance. A switch or a command may
 *  bring such a candidate to the front.
 *  @param select     NULL gives 0
 *  @param candidate  index
 *  @return 1 if so; 0 if it has the distance, in state WARMUP, and if there is no such candidate */
VDNA_API uint32_t vdna_select_is_bound(const vdna_select *select, uint32_t candidate);

/** Tell whether the choice had settled before its warmup was complete.
 *  @param select  NULL gives 0
 *  @return 1 if so; 0 if not, and in state WARMUP */
VDNA_API uint32_t vdna_select_is_early(const vdna_select *select);

/** Tell what ordered the ranking; a switch has moved its choice to the front since.
 *  @param select  NULL gives VDNA_SELECT_BY_EMD
 *  @return VDNA_SELECT_BY_...; _BY_EMD in state WARMUP */
VDNA_API uint32_t vdna_select_ranked_by(const vdna_select *select);

/** Get what trust said of the warmup when the choice was made.
 *  @param select  NULL gives NULL
 *  @return borrowed until the next call that changes the selector; NULL without trust, and in state
 *          WARMUP */
VDNA_API const vdna_trust_answer *vdna_select_trust(const vdna_select *select);

/** Get what it then predicted of each candidate.
 *  @param select     NULL gives NULL
 *  @param out_count  entries: the candidates, or 0 with NULL; NULL = not wanted
 *  @return [candidate_count], in the order of the candidates, borrowed and NULL as
 *          vdna_select_trust() */
VDNA_API const vdna_trust_prediction *vdna_select_predictions(const vdna_select *select,
                                                              uint32_t *out_count);

/** Count the switches to another choice while driving, since vdna_select_init(); if one is pinned
 * or kept by shadow, those that would have been.
 *  @param select  NULL gives 0
 *  @return switches; what follows on another warmup or a command is none */
VDNA_API uint64_t vdna_select_switches(const vdna_select *select);

/** Get what was the first of the ranking before the newest switch.
 *  @param select  NULL gives 0
 *  @return candidate index; 0 if there was no switch */
VDNA_API uint32_t vdna_select_previous(const vdna_select *select);

/** Look at the live Visual DNA, that of the window, which in NONE_FITS is the next one once a frame
 *  has begun it; the view follows later changes.
 *  @param select    borrowed as long as the view is in use
 *  @param out_view  untouched if an argument is NULL */
VDNA_API void vdna_select_live(const vdna_select *select, vdna_hist_view *out_view);

/** Count the frames in the window.
 *  @param select  NULL gives 0
 *  @return frames */
VDNA_API uint32_t vdna_select_window_frames(const vdna_select *select);

/** Get the stamp of the oldest frame in the window.
 *  @param select  NULL gives 0
 *  @return microseconds; 0 if there is no frame */
VDNA_API int64_t vdna_select_first_utime(const vdna_select *select);

/** Get the stamp of the newest frame in the window.
 *  @param select  NULL gives 0
 *  @return microseconds; 0 if there is no frame */
VDNA_API int64_t vdna_select_last_utime(const vdna_select *select);

/** Count the frames taken since vdna_select_init().
 *  @param select  NULL gives 0
 *  @return frames */
VDNA_API uint64_t vdna_select_accepted(const vdna_select *select);

/** Count the frames refused since vdna_select_init().
 *  @param select  NULL gives 0
 *  @return frames */
VDNA_API uint64_t vdna_select_rejected(const vdna_select *select);

/** Count the warmups begun anew because of their frames' times, since vdna_select_init().
 *  @param select  NULL gives 0
 *  @return warmups */
VDNA_API uint64_t vdna_select_restarts(const vdna_select *select);

/** Tell why the last of these warmups began anew.
 *  @param select  NULL gives VDNA_RESTART_NONE
 *  @return VDNA_RESTART_... */
VDNA_API uint32_t vdna_select_restart_cause(const vdna_select *select);

/** English text of such a cause, to follow "the warmup began anew, ".
 *  @param cause  any value
 *  @return a constant string, never NULL; "" for VDNA_RESTART_NONE and unknown values */
VDNA_API const char *vdna_restart_text(uint32_t cause);

/** Look at camera time: its unit, the newest frame, late frames, and how many frames did not move
 *  it.
 *  @param select  NULL gives NULL
 *  @return borrowed as long as the selector is in use; follows later changes */
VDNA_API const vdna_camera_time *vdna_select_time(const vdna_select *select);

#ifdef __cplusplus
}
#endif

#endif
