/* The model of a map's tables: slope, intercepts and errors. Private to lib/trust. */
#ifndef VDNA_TRUST_TRUST_MODEL_H
#define VDNA_TRUST_TRUST_MODEL_H

#include <vdna/trust.h>

/* Constants of a localiser, as in vdna/trust.h. */
typedef struct vdna_trust_prior {
    double slope, slope_sd;         /* beta0, T_beta */
    double intercept, intercept_sd; /* m0, T_m */
    double run_sd, pair_sd;         /* T_u, sigma */
    double transfer_share;          /* v */
    double error_sd;                /* root of V; 0 = from the variances of the fit */
    double unlike_margin;           /* without a last layer */
} vdna_trust_prior;

/* The tables, with means over windows, within the caller's block. */
typedef struct vdna_trust_model {
    const vdna_trust_prior *prior;
    uint32_t runs, labelled;
    double *recall, *distance; /* [runs][runs], of two labelled runs */
    double *x, *y;     /* the same, during the fit only. y and not its recall: near 1, angles
                          cannot be told from it */
    uint32_t *ids;     /* [labelled], ascending */
    double *intercept; /* [runs], NaN = not known */
    double slope;
    double spread; /* of the distances of the labelled runs, times the bandwidth */
    double *work;  /* [VDNA_TRUST_WORK][runs] */
} vdna_trust_model;

enum { VDNA_TRUST_WORK = 5 };

/* Read tables that have passed the check, and fit them.
 * @param tables     not NULL
 * @param left_out   [runs], working memory
 * @param out_fit    all but `by_likeness`, `far` and `correlation` */
void vdna_trust_model_fit(vdna_trust_model *model, const vdna_trust_tables *tables,
                          uint32_t *left_out, vdna_trust_fit *out_fit);

/* Recall by what labelled runs that look like the live one got.
 * @param ids           [count], labelled runs
 * @param spread        of their distances
 * @param distance_bins of the live run: [count] in their order
 * @param weights       [count], working memory
 * @param out_recall    [count] */
void vdna_trust_transfer(const vdna_trust_model *model, const uint32_t *ids, uint32_t count,
                         double spread, const double *distance_bins, double *weights,
                         double *out_recall);

/* Index of the largest of `count` values, >= 1; the first of equals. */
uint32_t vdna_largest_of(const double *values, uint32_t count);

#endif
