/** @file vdna/activation.h
 *  @brief One frame's output of one activation tap, in the layouts that networks produce.
 */
#ifndef VDNA_ACTIVATION_H
#define VDNA_ACTIVATION_H

#include <stddef.h>

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How `values` of a vdna_activations is laid out. */
enum {
    /** [samples][neurons]: the tokens of a transformer, or a plain descriptor (1 sample) */
    VDNA_LAYOUT_SAMPLES_NEURONS = 0,
    /** [neurons][samples]: a convolution's feature map, samples = height x width */
    VDNA_LAYOUT_NEURONS_SAMPLES = 1
};

/** The activations of one tap for one frame. */
typedef struct vdna_activations {
    const float *values; /**< neurons x samples numbers in the given layout */
    uint32_t neurons;    /**< >= 1 */
    uint32_t samples;    /**< per neuron, >= 1: 1 for a descriptor, 197 for ViT-B/16 tokens */
    uint32_t layout;     /**< VDNA_LAYOUT_... */
} vdna_activations;

/** Check the taps of one frame: fields valid, `neurons` in total, every value finite.
 *  @param taps     [tap_count]; their neurons follow one another in the histogram
 *  @param tap_count  >= 1
 *  @param neurons  required sum of the neurons of all taps
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad field; VDNA_ERR_MISMATCH if the neurons do not add up;
 *          VDNA_ERR_NONFINITE if a value is NaN or infinite */
VDNA_API vdna_status vdna_activations_check(const vdna_activations *taps, size_t tap_count,
                                            uint32_t neurons);

#ifdef __cplusplus
}
#endif

#endif
