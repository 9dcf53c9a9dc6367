/* What a selector holds, and what its files do for one another. Private to lib/select. */
#ifndef VDNA_SELECT_SELECT_STATE_H
#define VDNA_SELECT_SELECT_STATE_H

#include <vdna/select.h>
#include <vdna/window.h>

/* At the beginning of the caller's block; the arrays and the window follow. */
struct vdna_select {
    vdna_select_config config;
    vdna_window *window;
    vdna_hist_view *views;    /* [candidate_count] */
    vdna_rank_entry *ranking; /* [candidate_count], of the newest choice; the chosen is the first */
    uint8_t *is_bound;        /* [candidate_count], of its distances */
    uint32_t *sums;           /* of the candidates, for bounds; NULL = all distances are exact */
    void *scratch;
    vdna_camera_time time;

    /* If there are localisers. */
    vdna_select_position position; /* valid if `is_placed` */
    vdna_localise_answer *answers; /* [candidate_count], of those that are followed */
    float *leads;                  /* [VDNA_LOCALISE_LEAD_FRAMES][dim], a ring */
    uint64_t lead_count;           /* all so far */

    /* If there is trust. */
    vdna_trust_answer trusted;          /* at the newest choice, as are the predictions */
    vdna_trust_prediction *predictions; /* [candidate_count] */
    double *of_candidates;              /* [candidate_count], working memory; of a frame of a warmup
                                           its rho in each */
    double *likeness;                   /* [candidate_count], working memory; of a frame of a warmup
                                           its rho on the last layer */
    int8_t *codes;                      /* its last layer, if trust needs it */
    float code_scale;

    uint32_t state, chosen, ranked_by;
    uint32_t is_early; /* whether the newest choice had settled before its warmup was complete */
    uint32_t is_over;  /* whether the window is that of the newest choice, so that the next frame to
                          warm up with begins another */
    uint32_t is_placed; /* whether there is a position */
    uint32_t
        is_behind; /* whether localisers are to follow the leads that no answer has needed yet */
    uint32_t previous, restart_cause;
    uint64_t accepted, rejected, restarts, switches;

    /* What the operator wants. */
    uint8_t *excluded;       /* [candidate_count], 1 = not to be chosen */
    uint32_t pinned, shadow; /* pinned: a candidate, or VDNA_SELECT_NONE; so is `kept` */
    uint32_t kept;           /* in shadow the choice, once there is one */
    uint64_t moved; /* frames in SELECTED at which the robot moved, if others may be chosen */
};

/* ---- select.c ---- */

/* Begin a warmup, with the next frame. */
void vdna_select_warm_up_again(vdna_select *select);

/* ---- select_operator.c ---- */

/* The candidate that is localised in whatever the ranking says: the pinned one, or in shadow the
 * choice; VDNA_SELECT_NONE = there is none. */
uint32_t vdna_select_held(const vdna_select *select);

/* Choose what is held, or the first of the ranking if there is one. */
void vdna_select_decide(vdna_select *select);

/* Move what is excluded behind the rest of the ranking; both keep their order. */
void vdna_select_put_excluded_last(vdna_select *select);

/* ---- select_trust.c ---- */

/* Whether the fields of the config that have to do with trust go together; all others do. */
int vdna_select_may_trust(const vdna_select_config *config);

/* Numbers of a last layer that trust needs; 0 = none. */
uint32_t vdna_select_codes(const vdna_select_config *config);

/* Check the last layer of a frame, and keep its codes.
 * @param last_layer  ignored if it is not needed */
vdna_status vdna_select_encode(vdna_select *select, const float *last_layer);

/* How far a frame is from every candidate: `of_candidates`. */
vdna_status vdna_select_measure(vdna_select *select, const float *embedding);

/* The same, and by the last layer whose codes are kept if trust needs it: `likeness`. */
vdna_status vdna_select_measure_for_warmup(vdna_select *select, const float *embedding);

/* Count the frame that was measured. */
void vdna_select_count(vdna_select *select);

/* Whether the first answer need not wait for the rest of the warmup. */
int vdna_select_may_stop(const vdna_select *select);

/* Ask trust about the ranking by distance, and bring it into the order of the choice. */
void vdna_select_judge(vdna_select *select);

/* ---- select_follow.c ---- */

/* Let the localisers forget everything, but that of what is held, which is followed at every
 * frame. */
void vdna_select_forget(vdna_select *select);

/* The same for that one. */
void vdna_select_forget_held(vdna_select *select);

/* Take a frame of the first warmup: the one that it pushes out of the leads goes into the live
 * means. */
void vdna_select_take_lead(vdna_select *select, const float *embedding);

/* Let the localisers that answer follow the leads to where the robot is; vdna_select_catch_up()
 * lets the others.
 * @param held  the candidate whose localiser has followed before the choice, or VDNA_SELECT_NONE */
void vdna_select_follow_leads(vdna_select *select, uint32_t held);

/* Let the localiser of a candidate follow the leads. */
void vdna_select_take_up(vdna_select *select, uint32_t candidate);

/* Localise a frame of the first warmup in what is held.
 * @param held  a candidate; VDNA_SELECT_NONE does nothing */
void vdna_select_localise_in_held(vdna_select *select, uint32_t held, const float *embedding,
                                  vdna_select_answer *answer);

/* Localise a frame after the choice, and reconsider that if told to. */
vdna_status vdna_select_localise(vdna_select *select, const float *embedding,
                                 vdna_select_answer *answer);

#endif
