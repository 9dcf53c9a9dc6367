/** @file vdna/explain.h
 *  @brief Why one experience and not another: the neurons that tell them apart.
 *
 *  Definition: the distance of a live Visual DNA to a candidate is the mean of its neurons' EMD, so
 *  each neuron adds its EMD divided by their number, and to the margin between two candidates the
 *  difference of two such parts. Parts of all neurons sum to the distances and to the margin.
 *
 *  "Winner" is the candidate whose choice is explained, "against" the one that it is compared with.
 */
#ifndef VDNA_EXPLAIN_H
#define VDNA_EXPLAIN_H

#include <vdna/emd.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What a neuron, or several in a row, adds to two distances. */
typedef struct vdna_reason {
    double winner_bins;  /**< to D(live, winner), in bins, >= 0 */
    double against_bins; /**< to D(live, against), in bins, >= 0 */
    double margin_bins;  /**< to the margin D(live, against) - D(live, winner), in bins: above 0
                              speaks for the winner, below 0 against it */
    uint32_t neuron;     /**< the first, in the order of the identity's taps */
    uint32_t count;      /**< neurons, >= 1 */
} vdna_reason;

/** Sum what neurons in a row add: those of a tap, or all.
 *  @param winner_emd_bins   [neurons], vdna_emd() of the live run and the winner
 *  @param against_emd_bins  [neurons], of the live run and the other candidate
 *  @param neurons  of the Visual DNA, >= 1
 *  @param first    neuron
 *  @param count    neurons from there on, >= 1
 *  @param out_sum  one
 *  @return VDNA_OK; VDNA_ERR_ARG, also if there are not so many neurons */
VDNA_API vdna_status vdna_explain_sum(const double *winner_emd_bins, const double *against_emd_bins,
                                      uint32_t neurons, uint32_t first, uint32_t count,
                                      vdna_reason *out_sum);

/** Find the neurons that add most to the margin, whatever their sign.
 *  @param winner_emd_bins, against_emd_bins, neurons  as for vdna_explain_sum()
 *  @param wanted       neurons, 1..`neurons`; time grows with both
 *  @param out_reasons  [wanted], by falling magnitude of margin_bins, equal ones in their order
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a distance is */
VDNA_API vdna_status vdna_explain_top(const double *winner_emd_bins, const double *against_emd_bins,
                                      uint32_t neurons, uint32_t wanted, vdna_reason *out_reasons);

/** Find the frames of an experience that have most and least of a neuron. The codes are those of
 *  vdna_experience.last_layer, and stand for the activations that the Visual DNA counts where
 *  vdna_experience_counts_last_layer() says so.
 *  @param codes      [frames][neurons], of vdna/int8.h
 *  @param scale      [frames], of the codes
 *  @param frames     >= 1
 *  @param neurons    >= 1
 *  @param neuron     index
 *  @param out_most   frame, the first of several
 *  @param out_least  frame, of several the farthest from the one with most, the first of two
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_explain_frames(const int8_t *codes, const float *scale, uint32_t frames,
                                         uint32_t neurons, uint32_t neuron, uint32_t *out_most,
                                         uint32_t *out_least);

#ifdef __cplusplus
}
#endif

#endif
