#include <string.h>
#include <vdna/window.h>

#include "count.h"
#include "shape.h"

/* see vdna/window.h */
void vdna_window_config_init(vdna_window_config *config)
{
    if (!config)
        return;
    memset(config, 0, sizeof *config);
    config->struct_size = sizeof *config;
    config->bins = VDNA_HIST_BINS_DEFAULT;
}

/* The parts of the caller's block, widest elements first. */
typedef struct window_parts {
    size_t utime, hist;  /* bytes of each; the slots are the rest */
    size_t frame_values; /* activations of one frame */
    size_t total;        /* 0 if the config is invalid */
    vdna_hist_config hist_config;
} window_parts;

/* Activations of one frame, or 0 if `capacity` frames could bring a mass past UINT32_MAX. */
static uint64_t frame_values_of(const vdna_window_config *config)
{
    uint64_t values = 0;
    for (size_t t = 0; t < config->tap_count; t++) {
        if (config->taps[t].samples > UINT32_MAX / config->capacity)
            return 0;
        values += (uint64_t)config->taps[t].neurons * config->taps[t].samples;
    }
    return values;
}

static window_parts parts_of(const vdna_window_config *config)
{
    window_parts p;
    memset(&p, 0, sizeof p);
    if (!config || config->struct_size != sizeof *config || config->capacity == 0 ||
        config->length_us < 0 || config->bins > VDNA_WINDOW_BINS_MAX)
        return p;

    vdna_hist_config_init(&p.hist_config);
    p.hist_config.bins = config->bins;
    p.hist_config.range = config->range;
    if (vdna_taps_shape(config->taps, config->tap_count, &p.hist_config.neurons) != VDNA_OK)
        return p;
    /* Neurons and the mass of each fit 32 bits, so all slots together fit 64. */
    const uint64_t values = frame_values_of(config), slots = values * config->capacity;
    const uint64_t hist = vdna_hist_mem_size(&p.hist_config);
    const uint64_t utime = (uint64_t)config->capacity * sizeof(int64_t);
    if (values == 0 || hist == 0 || slots > SIZE_MAX / 8)
        return p;
    const uint64_t total = utime + hist + slots * sizeof(uint16_t);
    if (total > SIZE_MAX / 2)
        return p;

    p.utime = (size_t)utime;
    p.hist = (size_t)hist;
    p.frame_values = (size_t)values;
    p.total = (size_t)total;
    return p;
}

/* see vdna/window.h */
size_t vdna_window_mem_size(const vdna_window_config *config)
{
    return parts_of(config).total;
}

/* see vdna/window.h */
vdna_status vdna_window_init(const vdna_window_config *config, void *mem, size_t mem_size,
                             vdna_window *out_window)
{
    const window_parts p = parts_of(config);
    if (p.total == 0 || !mem || !out_window || (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < p.total)
        return VDNA_ERR_NOMEM;

    unsigned char *block = mem;
    vdna_window w;
    memset(&w, 0, sizeof w);
    w.config = *config;
    w.utime = mem;
    w.slots = (uint16_t *)(void *)(block + p.utime + p.hist);
    w.frame_values = p.frame_values;
    const vdna_status status = vdna_hist_init(&p.hist_config, block + p.utime, p.hist, &w.hist);
    if (status != VDNA_OK)
        return status;
    *out_window = w;
    return VDNA_OK;
}

/* see vdna/window.h */
void vdna_window_reset(vdna_window *window)
{
    if (!window)
        return;
    vdna_hist_reset(&window->hist);
    window->oldest = 0;
    window->truncated = 0;
}

static vdna_status check_frame_shape(const vdna_window *window, const vdna_activations *taps,
                                     size_t tap_count)
{
    const vdna_status status = vdna_activations_check(taps, tap_count, window->hist.neurons);
    if (status != VDNA_OK)
        return status;
    if (tap_count != window->config.tap_count)
        return VDNA_ERR_MISMATCH;
    for (size_t t = 0; t < tap_count; t++) {
        const vdna_activations *expected = &window->config.taps[t];
        if (taps[t].neurons != expected->neurons || taps[t].samples != expected->samples ||
            taps[t].layout != expected->layout)
            return VDNA_ERR_MISMATCH;
    }
    return VDNA_OK;
}

static uint16_t *slots_at(const vdna_window *window, uint32_t place)
{
    return window->slots + place * window->frame_values;
}

static void drop_oldest(vdna_window *window)
{
    vdna_uncount_frame(&window->hist, window->config.taps, window->config.tap_count,
                       slots_at(window, window->oldest));
    window->oldest = (window->oldest + 1) % window->config.capacity;
}

/* Is a frame of this stamp no longer within the length that ends with a frame of `newest`? */
static int is_past(const vdna_window *window, int64_t utime, int64_t newest)
{
    /* Unsigned, because two stamps may be further apart than an int64 can say. */
    return (uint64_t)newest - (uint64_t)utime >= (uint64_t)window->config.length_us;
}

/* Make room for a frame of this stamp, which is not earlier than the newest. */
static void slide(vdna_window *window, int64_t utime)
{
    const int by_time = window->config.length_us > 0;
    while (by_time && window->hist.frames > 0 &&
           is_past(window, window->utime[window->oldest], utime))
        drop_oldest(window);
    if (window->hist.frames == window->config.capacity) {
        if (by_time) {
            window->left_utime = window->utime[window->oldest];
            window->left_early++;
            window->truncated = 1;
        }
        drop_oldest(window);
    }
    if (window->truncated && is_past(window, window->left_utime, utime))
        window->truncated = 0;
}

/* see vdna/window.h */
vdna_status vdna_window_add(vdna_window *window, int64_t utime, const vdna_activations *taps,
                            size_t tap_count)
{
    if (!window)
        return VDNA_ERR_ARG;
    const vdna_status status = check_frame_shape(window, taps, tap_count);
    if (status != VDNA_OK)
        return status;

    if (window->hist.frames > 0 && utime < window->last_utime) {
        vdna_window_reset(window);
        window->restarts++;
    }
    slide(window, utime);
    const uint64_t place = (uint64_t)window->oldest + window->hist.frames;
    const uint32_t newest = (uint32_t)(place % window->config.capacity);
    vdna_count_frame(&window->hist, taps, tap_count, slots_at(window, newest));
    window->utime[newest] = utime;
    window->first_utime = window->utime[window->oldest];
    window->last_utime = utime;
    return VDNA_OK;
}
