/* Counting the samples of a frame in a histogram, and taking them out again. Private to the core.
 *
 * A slot says where a sample lies on its neuron's axis: its bin, or one of two extra values for
 * samples beyond the range. Unlike a bin, a slot suffices to undo `saturated`. */
#ifndef VDNA_CORE_COUNT_H
#define VDNA_CORE_COUNT_H

#include <vdna/hist.h>

/* Slots behind the last bin. */
enum { SLOT_BELOW = 0, SLOT_ABOVE = 1 };

/* Whether a checked frame fits: neither a mass nor the number of frames would wrap. */
int vdna_fits_frame(const vdna_hist *hist, const vdna_activations *taps, size_t tap_count);

/* Count a checked frame that fits.
 * @param out_slots  NULL, or [neurons x samples of all taps], in internal order; bins + SLOT_ABOVE
 *                   must then fit uint16_t */
void vdna_count_frame(vdna_hist *hist, const vdna_activations *taps, size_t tap_count,
                      uint16_t *out_slots);

/* Take out a frame that vdna_count_frame() counted.
 * @param taps   shape of that frame; its values are ignored
 * @param slots  the slots from vdna_count_frame() */
void vdna_uncount_frame(vdna_hist *hist, const vdna_activations *taps, size_t tap_count,
                        const uint16_t *slots);

#endif
