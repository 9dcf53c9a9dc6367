/* The bench's parts in C: loops over calls too short to be timed from Python, the limit of anything
 * that reads every byte, and the distance in the other layout. */
#include "loops.h"

#include "vectorised.h"

/* see loops.h */
vdna_status bench_hist_add(vdna_hist *hist, const vdna_activations *tap, size_t frames)
{
    vdna_status status = VDNA_OK;
    for (size_t i = 0; i < frames && status == VDNA_OK; i++)
        status = vdna_hist_add(hist, tap, 1);
    return status;
}

/* see loops.h */
void bench_increment(uint32_t *counts, const uint32_t *cells, size_t count, size_t times)
{
    for (size_t t = 0; t < times; t++)
        for (size_t i = 0; i < count; i++)
            counts[cells[i]]++;
}

static vdna_window_config window_config(const vdna_activations *tap, const float *range,
                                        uint32_t capacity)
{
    vdna_window_config config;
    vdna_window_config_init(&config);
    config.capacity = capacity;
    config.taps = tap;
    config.tap_count = 1;
    config.range = range;
    return config;
}

/* see loops.h */
size_t bench_window_size(const vdna_activations *tap, const float *range, uint32_t capacity)
{
    const vdna_window_config config = window_config(tap, range, capacity);
    return vdna_window_mem_size(&config);
}

/* see loops.h */
vdna_status bench_window_init(const vdna_activations *tap, const float *range, uint32_t capacity,
                              void *mem, size_t size)
{
    const vdna_window_config config = window_config(tap, range, capacity);
    vdna_window *window; /* at the beginning of `mem` */
    return vdna_window_init(&config, mem, size, &window);
}

/* see loops.h */
vdna_status bench_window_add(void *mem, const vdna_activations *tap, size_t frames)
{
    vdna_status status = VDNA_OK;
    for (size_t i = 0; i < frames && status == VDNA_OK; i++)
        status = vdna_window_add(mem, 0, tap, 1, NULL);
    return status;
}

/* see loops.h; as wide as the core's own loops, to be their limit */
VDNA_VECTORISED uint64_t bench_read(const uint64_t *words, size_t count, size_t times)
{
    uint64_t sum = 0;
    for (size_t t = 0; t < times; t++)
        for (size_t i = 0; i < count; i++)
            sum += words[i] ^ t;
    return sum;
}

/* see loops.h */
VDNA_VECTORISED double bench_emd_neuron_major(const uint32_t *p, const uint32_t *q,
                                              uint32_t neurons, uint32_t bins, uint32_t mass_p,
                                              uint32_t mass_q)
{
    double total = 0;
    for (size_t n = 0; n < neurons; n++) {
        const uint32_t *row_p = p + n * bins, *row_q = q + n * bins;
        int64_t difference = 0, sum = 0;
        for (uint32_t b = 0; b + 1 < bins; b++) {
            difference += (int64_t)row_p[b] * mass_q - (int64_t)row_q[b] * mass_p;
            sum += difference < 0 ? -difference : difference;
        }
        total += (double)sum / ((double)mass_p * (double)mass_q);
    }
    return total / neurons;
}
