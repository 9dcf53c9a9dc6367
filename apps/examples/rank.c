/* rank [FILE.vdna FILE.vdna FILE.vdna]: which of three drives looks most like now, and where in it
 * are we? First from all frames at once, then live, frame by frame. The drives are made up here, or
 * opened from experience files. The folders next to this file have the same program in Python,
 * Rust, Go and Java; all print the same bytes. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/map.h>
#include <vdna/vdna.h>

enum { NEURONS = 8, SAMPLES = 4, FRAMES = 50, WARMUP = 40, BINS = 1000, CANDIDATES = 3 };
enum { PERIOD_US = 100000 }; /* of the camera */

/* A synthetic drive: its activations lie in shift..shift + 1. */
typedef struct drive {
    const char *name;
    uint32_t seed;
    float shift;
} drive;

static const drive drives[CANDIDATES] = {
    {"spring", 1, 0.0f}, {"summer", 2, 0.25f}, {"winter", 3, 0.75f}};
static const drive now = {"now", 4, 0.3125f};

/* A drive to choose from: what the library needs of it. */
typedef struct candidate {
    const char *name;
    vdna_hist_view dna;
    const float *embeddings; /* [frames][NEURONS] */
    uint32_t frames;
} candidate;

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

static vdna_select *selector(const vdna_select_candidate *candidates)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = CANDIDATES;
    config.dim = NEURONS;
    config.warmup_frames = WARMUP;
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    require(vdna_select_init(&config, malloc(size), size, &select));
    return select;
}

/* Warm up on the first frames, choose, and find the last frame in the chosen drive. */
static void choose(const candidate candidates[CANDIDATES])
{
    vdna_select_candidate kept[CANDIDATES];
    for (int i = 0; i < CANDIDATES; i++) {
        const vdna_select_candidate one = {candidates[i].dna, candidates[i].embeddings,
                                           candidates[i].frames, 0};
        kept[i] = one;
    }

    vdna_select *select = selector(kept);
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

/* Make the drives up. Ranges come from the map alone; the live drive never changes them. */
static void record(candidate candidates[CANDIDATES])
{
    static float range[NEURONS * 2], embeddings[CANDIDATES][FRAMES][NEURONS];
    require(vdna_range_clear(range, NEURONS));
    for (int i = 0; i < CANDIDATES; i++)
        observe(&drives[i], range);
    require(vdna_range_expand(range, NEURONS, VDNA_RANGE_FACTOR, VDNA_RANGE_ABOUT_MIDPOINT));
    for (int i = 0; i < CANDIDATES; i++) {
        const vdna_hist hist = count(&drives[i], range);
        embed(&drives[i], embeddings[i]);
        const candidate one = {drives[i].name, {0}, embeddings[i][0], FRAMES};
        candidates[i] = one;
        vdna_hist_view_of(&hist, &candidates[i].dna);
    }
}

static void open_files(char **paths, candidate candidates[CANDIDATES])
{
    static vdna_experience experiences[CANDIDATES];
    vdna_error error;
    for (int i = 0; i < CANDIDATES; i++) {
        vdna_experience *e = &experiences[i];
        if (vdna_experience_open(paths[i], &error, e) != VDNA_OK) {
            fprintf(stderr, "rank: %s\n", error.text);
            exit(1);
        }
        const candidate one = {e->name, {0}, e->embeddings, e->frames};
        candidates[i] = one;
        vdna_experience_view(e, &candidates[i].dna);
    }
}

int main(int argc, char **argv)
{
    candidate candidates[CANDIDATES];
    if (argc == 1 + CANDIDATES)
        open_files(argv + 1, candidates);
    else
        record(candidates);

    vdna_hist_view live, views[CANDIDATES];
    const vdna_hist hist = count(&now, candidates[0].dna.range);
    vdna_hist_view_of(&hist, &live);
    for (int i = 0; i < CANDIDATES; i++)
        views[i] = candidates[i].dna;

    vdna_rank_entry ranking[CANDIDATES];
    const size_t size = vdna_emd_scratch_size(NEURONS);
    require(vdna_rank(&live, views, CANDIDATES, malloc(size), size, ranking));
    for (int i = 0; i < CANDIDATES; i++)
        printf("%d. %s is %.17f bins away\n", i + 1, candidates[ranking[i].candidate].name,
               ranking[i].distance_bins);
    choose(candidates);
    return 0;
}
