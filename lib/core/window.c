#include <string.h>

#include <vdna/window.h>

#include "count.h"
#include "elapsed.h"
#include "growth.h"
#include "shape.h"

/* Bytes of vdna_window_config in version 0.1. */
#define OLDEST_WINDOW_CONFIG offsetof(vdna_window_config, which)

static const vdna_window_config window_defaults = {
    0, 0, 0, NULL, 0, NULL, VDNA_HIST_BINS_DEFAULT, VDNA_WINDOW_LAST, 0,
};

/* At the beginning of the caller's block. The stamps (last window only), the histogram and the
 * slots (last window only) follow. */
struct vdna_window {
    vdna_hist hist;
    const vdna_activations *taps; /* [tap_count], the shape of frames; NULL for a first window */
    size_t tap_count;
    int64_t *utime;      /* [capacity]; this and the next two: last window only */
    uint16_t *slots;     /* [capacity][frame_values] */
    size_t frame_values; /* activations of one frame, all taps together */
    int64_t length_us;   /* 0 = by frames */
    int64_t first_utime; /* this and the next: valid while there is a frame */
    int64_t last_utime;
    int64_t left_utime; /* valid while truncated */
    uint64_t left_early;
    uint64_t restarts;
    uint32_t capacity;
    uint32_t least_frames;
    uint32_t oldest; /* its index into the stamps and the slots */
    uint8_t is_first;
    uint8_t is_complete;
    uint8_t is_truncated;
};

/* see vdna/window.h; in parentheses, because the header has a macro of this name */
void(vdna_window_config_init)(vdna_window_config *config)
{
    vdna_config_write(config, OLDEST_WINDOW_CONFIG, &window_defaults, sizeof window_defaults);
}

/* see vdna/window.h */
void vdna_window_config_init_sized(vdna_window_config *config, size_t struct_size)
{
    vdna_config_write(config, struct_size, &window_defaults, sizeof window_defaults);
}

/* The parts of the caller's block, widest elements first. */
typedef struct window_parts {
    size_t utime, hist;  /* bytes of each, after the struct; the slots are the rest */
    size_t frame_values; /* activations of one frame; 0 for a first window */
    size_t total;        /* 0 if the config is invalid */
    vdna_hist_config hist_config;
    vdna_window_config config; /* complete */
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

static int is_window_config(const vdna_window_config *config)
{
    return config->capacity > 0 && config->length_us >= 0 && config->which <= VDNA_WINDOW_FIRST &&
           config->least_frames <= config->capacity &&
           (config->which == VDNA_WINDOW_FIRST || config->bins <= VDNA_WINDOW_BINS_MAX);
}

/* Sizes of what a last window keeps. @return 0 if it is too much to count or to address */
static int size_frames(const vdna_window_config *config, uint64_t *out_utime, uint64_t *out_values)
{
    *out_utime = (uint64_t)config->capacity * sizeof(int64_t);
    *out_values = frame_values_of(config);
    /* Neurons and the mass of each fit 32 bits, so the slots of all frames fit 64. */
    return *out_values > 0 && *out_values * config->capacity <= SIZE_MAX / 8;
}

static window_parts parts_of(const vdna_window_config *given)
{
    window_parts p;
    memset(&p, 0, sizeof p);
    p.config = window_defaults;
    const vdna_window_config *config = &p.config;
    if (!vdna_config_read(given, OLDEST_WINDOW_CONFIG, &p.config, sizeof p.config) ||
        !is_window_config(config))
        return p;
    vdna_hist_config_init(&p.hist_config);
    p.hist_config.bins = config->bins;
    p.hist_config.range = config->range;
    if (vdna_taps_shape(config->taps, config->tap_count, &p.hist_config.neurons) != VDNA_OK)
        return p;

    const uint64_t hist = vdna_hist_mem_size(&p.hist_config);
    uint64_t utime = 0, values = 0;
    if (config->which == VDNA_WINDOW_LAST && !size_frames(config, &utime, &values))
        return p;
    const uint64_t slots = values * config->capacity * sizeof(uint16_t);
    const uint64_t total = sizeof(vdna_window) + utime + hist + slots;
    if (hist == 0 || total > SIZE_MAX / 2)
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
                             vdna_window **out_window)
{
    const window_parts p = parts_of(config);
    if (p.total == 0 || !mem || !out_window || (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < p.total)
        return VDNA_ERR_NOMEM;

    unsigned char *const utime = (unsigned char *)mem + sizeof(vdna_window);
    vdna_window w;
    memset(&w, 0, sizeof w);
    const vdna_status status = vdna_hist_init(&p.hist_config, utime + p.utime, p.hist, &w.hist);
    if (status != VDNA_OK)
        return status;
    w.length_us = p.config.length_us;
    w.capacity = p.config.capacity;
    w.least_frames = (uint32_t)p.config.least_frames;
    w.is_first = p.config.which == VDNA_WINDOW_FIRST;
    if (!w.is_first) {
        w.taps = p.config.taps;
        w.tap_count = p.config.tap_count;
        w.utime = (int64_t *)(void *)utime;
        w.slots = (uint16_t *)(void *)(utime + p.utime + p.hist);
        w.frame_values = p.frame_values;
    }
    *out_window = mem;
    **out_window = w;
    return VDNA_OK;
}

/* see vdna/window.h */
void vdna_window_reset(vdna_window *window)
{
    if (!window)
        return;
    vdna_hist_reset(&window->hist);
    window->oldest = 0;
    window->is_complete = 0;
    window->is_truncated = 0;
}

/* One more check of frames for a last window, which keeps slots tap by tap. */
static int is_of_shape(const vdna_window *window, const vdna_activations *taps, size_t tap_count)
{
    if (tap_count != window->tap_count)
        return 0;
    for (size_t t = 0; t < tap_count; t++) {
        const vdna_activations *expected = &window->taps[t];
        if (taps[t].neurons != expected->neurons || taps[t].samples != expected->samples ||
            taps[t].layout != expected->layout)
            return 0;
    }
    return 1;
}

static vdna_status check_frame_shape(const vdna_window *window, const vdna_activations *taps,
                                     size_t tap_count)
{
    const vdna_status status = vdna_activations_check(taps, tap_count, window->hist.neurons);
    if (status == VDNA_OK && !window->is_first && !is_of_shape(window, taps, tap_count))
        return VDNA_ERR_MISMATCH;
    return status;
}

static uint16_t *slots_at(const vdna_window *window, uint32_t place)
{
    return window->slots + place * window->frame_values;
}

static void drop_oldest(vdna_window *window)
{
    vdna_uncount_frame(&window->hist, window->taps, window->tap_count,
                       slots_at(window, window->oldest));
    window->oldest = (window->oldest + 1) % window->capacity;
}

/* Whether two frames are too far apart for one window; `later` is not the earlier in time. */
static int are_apart(const vdna_window *window, int64_t earlier, int64_t later)
{
    return window->length_us > 0 && vdna_elapsed_us(earlier, later) >= (uint64_t)window->length_us;
}

/* Make room for a frame of this stamp, which is not earlier than the newest. */
static void slide(vdna_window *window, int64_t utime)
{
    while (window->hist.frames > 0 && are_apart(window, window->utime[window->oldest], utime))
        drop_oldest(window);
    if (window->hist.frames == window->capacity) {
        if (window->length_us > 0) {
            window->left_utime = window->utime[window->oldest];
            window->left_early++;
            window->is_truncated = 1;
        }
        drop_oldest(window);
    }
    if (window->is_truncated && are_apart(window, window->left_utime, utime))
        window->is_truncated = 0;
}

static void add_to_last(vdna_window *window, int64_t utime, const vdna_activations *taps,
                        size_t tap_count)
{
    slide(window, utime);
    const uint64_t place = (uint64_t)window->oldest + window->hist.frames;
    const uint32_t newest = (uint32_t)(place % window->capacity);
    vdna_count_frame(&window->hist, taps, tap_count, slots_at(window, newest));
    window->utime[newest] = utime;
    window->first_utime = window->utime[window->oldest];
}

static void add_to_first(vdna_window *window, int64_t utime, const vdna_activations *taps,
                         size_t tap_count)
{
    vdna_count_frame(&window->hist, taps, tap_count, NULL);
    if (window->hist.frames == 1)
        window->first_utime = utime;
    window->is_complete = window->hist.frames == window->capacity;
}

/* The effects of a frame of this stamp: VDNA_WINDOW_ bits. COMPLETE is set here only for a frame
 * beyond the window. */
static uint32_t events_of(const vdna_window *window, int64_t utime)
{
    if (window->is_complete)
        return VDNA_WINDOW_COMPLETE;
    if (window->hist.frames > 0 && utime < window->last_utime)
        return VDNA_WINDOW_RESTARTED | VDNA_WINDOW_ADDED;
    if (window->is_first && window->hist.frames > 0 &&
        window->hist.frames >= window->least_frames &&
        are_apart(window, window->first_utime, utime))
        return VDNA_WINDOW_COMPLETE;
    return VDNA_WINDOW_ADDED;
}

static void take_in(vdna_window *window, int64_t utime, const vdna_activations *taps,
                    size_t tap_count)
{
    if (window->is_first)
        add_to_first(window, utime, taps, tap_count);
    else
        add_to_last(window, utime, taps, tap_count);
    window->last_utime = utime;
}

/* see vdna/window.h */
vdna_status vdna_window_add(vdna_window *window, int64_t utime, const vdna_activations *taps,
                            size_t tap_count, uint32_t *out_events)
{
    if (!window)
        return VDNA_ERR_ARG;
    const vdna_status status = check_frame_shape(window, taps, tap_count);
    if (status != VDNA_OK)
        return status;
    uint32_t events = events_of(window, utime);
    /* A window that begins anew has room for any frame; a last window's capacity bounds its
     * masses. */
    if (events == VDNA_WINDOW_ADDED && window->is_first &&
        !vdna_fits_frame(&window->hist, taps, tap_count))
        return VDNA_ERR_FULL;

    if (events & VDNA_WINDOW_RESTARTED) {
        vdna_window_reset(window);
        window->restarts++;
    }
    if (events & VDNA_WINDOW_ADDED)
        take_in(window, utime, taps, tap_count);
    else
        window->is_complete = 1;
    if (window->is_complete)
        events |= VDNA_WINDOW_COMPLETE;
    if (out_events)
        *out_events = events;
    return VDNA_OK;
}

/* see vdna/window.h */
const vdna_hist *vdna_window_hist(const vdna_window *window)
{
    return window ? &window->hist : NULL;
}

static int has_frames(const vdna_window *window)
{
    return window && window->hist.frames > 0;
}

/* see vdna/window.h */
int64_t vdna_window_first_utime(const vdna_window *window)
{
    return has_frames(window) ? window->first_utime : 0;
}

/* see vdna/window.h */
int64_t vdna_window_last_utime(const vdna_window *window)
{
    return has_frames(window) ? window->last_utime : 0;
}

/* see vdna/window.h */
double vdna_window_progress(const vdna_window *window)
{
    if (!has_frames(window))
        return 0;
    if (window->is_complete)
        return 1;
    if (window->length_us == 0)
        return (double)window->hist.frames / window->capacity;
    const double time = (double)vdna_elapsed_us(window->first_utime, window->last_utime) /
                        (double)window->length_us;
    double most = 1;
    if (window->hist.frames < window->least_frames)
        most = (double)window->hist.frames / window->least_frames;
    return time < most ? time : most;
}

/* see vdna/window.h */
uint32_t vdna_window_truncated(const vdna_window *window)
{
    return window ? window->is_truncated : 0;
}

/* see vdna/window.h */
int64_t vdna_window_left_utime(const vdna_window *window)
{
    return window && window->is_truncated ? window->left_utime : 0;
}

/* see vdna/window.h */
uint64_t vdna_window_left_early(const vdna_window *window)
{
    return window ? window->left_early : 0;
}

/* see vdna/window.h */
uint64_t vdna_window_restarts(const vdna_window *window)
{
    return window ? window->restarts : 0;
}
