/* rank: which of three drives looks most like now, and where in it are we? First from all frames
 * at once, then live, frame by frame. The folders next to this file have the same program in
 * Python, Rust, Go and Java; all print the same bytes. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/vdna.h>

enum { NEURONS = 8, SAMPLES = 4, FRAMES = 50, WARMUP = 40, BINS = 1000, CANDIDATES = 3 };
enum { PERIOD_US = 100000 }; /* of the camera */

/* A synthetic drive: its activations lie in shift..shift + 1. */
typedef struct drive {
    const char *name;
    uint32_t seed;
    float shift;
} drive;

static const drive candidates[CANDIDATES] = {
    {"spring", 1, 0.0f}, {"summer", 2, 0.25f}, {"winter", 3, 0.75f}};
static const drive now = {"now", 4, 0.3125f};

/* The activations of the next frame, [samples][neurons]. Each number is the upper half of
 * x = 1664525 x + 1013904223 (mod 2^32), divided by 2^16: exact in any language. */
static void next_frame(const drive *d, uint32_t *x, float values[SAMPLES * NEURONS])
{
    for (int i = 0; i < SAMPLES * NEURONS; i++) {
        *x = *x * 1664525u + 1013904223u;
        values[i] = (float)(*x >> 16) / 65536.0f + d->shift;
    }
}

static void require(vdna_status status)
{
    if (status == VDNA_OK)
        return;
    fprintf(stderr, "rank: %s\n", vdna_status_text(status));
    exit(1);
}

static void observe(const drive *d, float *range)
{
    float values[SAMPLES * NEURONS];
    const vdna_activations tap = {values, NEURONS, SAMPLES, VDNA_LAYOUT_SAMPLES_NEURONS};
    uint32_t x = d->seed;
    for (int frame = 0; frame < FRAMES; frame++) {
        next_frame(d, &x, values);
        require(vdna_range_observe(range, NEURONS, &tap, 1));
    }
}

static vdna_hist count(const drive *d, const float *range)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = BINS;
    config.range = range;
    const size_t size = vdna_hist_mem_size(&config);
    vdna_hist hist;
    require(vdna_hist_init(&config, malloc(size), size, &hist));

    float values[SAMPLES * NEURONS];
    const vdna_activations tap = {values, NEURONS, SAMPLES, VDNA_LAYOUT_SAMPLES_NEURONS};
    uint32_t x = d->seed;
    for (int frame = 0; frame < FRAMES; frame++) {
        next_frame(d, &x, values);
        require(vdna_hist_add(&hist, &tap, 1));
    }
    return hist;
}

/* The embedding of each frame: here just its first sample. */
static void embed(const drive *d, float embeddings[FRAMES][NEURONS])
{
    float values[SAMPLES * NEURONS];
    uint32_t x = d->seed;
    for (int frame = 0; frame < FRAMES; frame++) {
        next_frame(d, &x, values);
        memcpy(embeddings[frame], values, sizeof embeddings[frame]);
    }
}

static vdna_select *selector(const vdna_select_candidate *experiences)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = experiences;
    config.candidate_count = CANDIDATES;
    config.dim = NEURONS;
    config.warmup_frames = WARMUP;
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    require(vdna_select_init(&config, malloc(size), size, &select));
    return select;
}

/* Warm up on the first frames, choose, and find the last frame in the chosen drive. */
static void choose(const vdna_hist_view views[CANDIDATES])
{
    static float embeddings[CANDIDATES][FRAMES][NEURONS];
    vdna_select_candidate experiences[CANDIDATES];
    for (int i = 0; i < CANDIDATES; i++) {
        embed(&candidates[i], embeddings[i]);
        const vdna_select_candidate experience = {views[i], embeddings[i][0], FRAMES, 0};
        experiences[i] = experience;
    }

    vdna_select *select = selector(experiences);
    vdna_select_answer answer;
    float values[SAMPLES * NEURONS];
    const vdna_activations tap = {values, NEURONS, SAMPLES, VDNA_LAYOUT_SAMPLES_NEURONS};
    uint32_t x = now.seed;
    for (int i = 0; i < FRAMES; i++) {
        next_frame(&now, &x, values);
        const vdna_select_frame frame = {(int64_t)i * PERIOD_US, &tap, 1, values};
        require(vdna_select_feed(select, &frame, &answer));
    }
    const char *chosen = candidates[vdna_select_chosen(select)].name;
    printf("live: %s after %u frames, by %.17f bins\n", chosen,
           (unsigned)vdna_select_window_frames(select), vdna_select_margin_bins(select));
    printf("now is nearest to frame %u of %s\n", (unsigned)answer.match.index, chosen);
    free(select);
}

int main(void)
{
    /* Ranges come from the map alone; the live drive never changes them. */
    float range[NEURONS * 2];
    require(vdna_range_clear(range, NEURONS));
    for (int i = 0; i < CANDIDATES; i++)
        observe(&candidates[i], range);
    require(vdna_range_expand(range, NEURONS, VDNA_RANGE_FACTOR, VDNA_RANGE_ABOUT_MIDPOINT));

    vdna_hist_view live, views[CANDIDATES];
    const vdna_hist hist = count(&now, range);
    vdna_hist_view_of(&hist, &live);
    for (int i = 0; i < CANDIDATES; i++) {
        const vdna_hist candidate = count(&candidates[i], range);
        vdna_hist_view_of(&candidate, &views[i]);
    }

    vdna_rank_entry ranking[CANDIDATES];
    const size_t size = vdna_emd_scratch_size(NEURONS);
    require(vdna_rank(&live, views, CANDIDATES, malloc(size), size, ranking));
    for (int i = 0; i < CANDIDATES; i++)
        printf("%d. %s is %.17f bins away\n", i + 1, candidates[ranking[i].candidate].name,
               ranking[i].distance_bins);
    choose(views);
    return 0;
}
