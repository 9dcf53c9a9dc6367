/* Loops of the bench, for Python to call through ctypes (ours.py). */
#ifndef VDNA_BENCH_LOOPS_H
#define VDNA_BENCH_LOOPS_H

#include <vdna/window.h>

/** Count the same frame `frames` times. */
VDNA_API vdna_status bench_hist_add(vdna_hist *hist, const vdna_activations *tap, size_t frames);

/** Count samples whose cells are known, `times` times: the limit of counting.
 *  @param cells  [count], indices into `counts` */
VDNA_API void bench_increment(uint32_t *counts, const uint32_t *cells, size_t count, size_t times);

/** Bytes for a window of `capacity` frames like `tap`, its struct in front. */
VDNA_API size_t bench_window_size(const vdna_activations *tap, const float *range,
                                  uint32_t capacity);

/** Make an empty window in `mem`, which holds bench_window_size() bytes. */
VDNA_API vdna_status bench_window_init(const vdna_activations *tap, const float *range,
                                       uint32_t capacity, void *mem, size_t size);

/** Add the same frame `frames` times to the window in `mem`. */
VDNA_API vdna_status bench_window_add(void *mem, const vdna_activations *tap, size_t frames);

/** Read `count` words `times` times.
 *  @return a number that depends on every word, so that no read is left out */
VDNA_API uint64_t bench_read(const uint64_t *words, size_t count, size_t times);

/** The exact distance of tables with one row of bins per neuron, in the same integers:
 *  vdna_emd_mean() for that layout of counts. All neurons have one mass. */
VDNA_API double bench_emd_neuron_major(const uint32_t *p, const uint32_t *q, uint32_t neurons,
                                       uint32_t bins, uint32_t mass_p, uint32_t mass_q);

#endif
