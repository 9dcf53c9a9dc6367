// instructions WHAT DATA [prepare]: does one thing to one kind of data, for valgrind to count the
// instructions below measured(); or only prepares it, for counts of the whole program, which then
// differ by that. See test_core.py, and test/bench/group_arm.py.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/emd.h>
#include <vdna/health.h>
#include <vdna/hist.h>
#include <vdna/knn.h>
#include <vdna/localise.h>
#include <vdna/rank.h>
#include <vdna/trust.h>

#include "count.h"

#define NEURONS 250u
#define SAMPLES 64u // of each neuron in a frame
#define BINS 1000u
#define CANDIDATES 16u
#define ROWS 1150u
#define DIM 128u
#define RUNS 100u // most experiences of a warmup
#define WIDTH 640u
#define HEIGHT 480u
#define CHANNELS 3u

// The C library chooses among several of these by the processor; the counts must not.
void *memset(void *block, int byte, size_t size)
{
    unsigned char *bytes = block;
    for (size_t i = 0; i < size; i++)
        bytes[i] = (unsigned char)byte;
    return block;
}

void *memcpy(void *restrict to, const void *restrict from, size_t size)
{
    unsigned char *out = to;
    const unsigned char *in = from;
    for (size_t i = 0; i < size; i++)
        out[i] = in[i];
    return to;
}

int memcmp(const void *a, const void *b, size_t size)
{
    const unsigned char *left = a, *right = b;
    for (size_t i = 0; i < size; i++)
        if (left[i] != right[i])
            return left[i] - right[i];
    return 0;
}

enum data { RANDOM, CONSTANT, SORTED, EXTREME, KINDS };
static const char *const kinds[KINDS] = {"random", "constant", "sorted", "extreme"};

static uint32_t state = 1;

static float chance(void) // 0..1
{
    state = state * 1664525u + 1013904223u;
    return (float)(state >> 8) / 16777216.0f;
}

// The i-th of `count` activations; the range is -1..1.
static float activation(enum data data, size_t i, size_t count)
{
    switch (data) {
    case RANDOM:
        return 2 * chance() - 1;
    case CONSTANT:
        return 0.3f; // on the edge between two bins
    case SORTED:
        return 2 * ((float)i + 0.5f) / (float)count - 1;
    default:
        return i % 2 ? 3e38f : -3e38f; // both beyond the range
    }
}

static float range[NEURONS][2];
static float activations[SAMPLES * NEURONS];
static uint32_t blocks[1 + CANDIDATES][NEURONS * (BINS + 2)];
static vdna_hist hists[1 + CANDIDATES];
static vdna_hist_view views[1 + CANDIDATES];
static int64_t scratch[4 * NEURONS];
static vdna_rank_entry ranking[CANDIDATES];
static float map[ROWS * DIM], query[DIM];
static int64_t map_block[ROWS * DIM / 4 + 1024], localise_block[ROWS * 8];
static vdna_localise *localiser;
static vdna_trust_cell cells[RUNS * RUNS];
static int64_t trust_block[RUNS * (4 * RUNS + 16) + 64];
static double relative[RUNS];
static vdna_trust *trust;
static uint16_t slots[SAMPLES * NEURONS];
static vdna_activations tap = {activations, NEURONS, SAMPLES, VDNA_LAYOUT_SAMPLES_NEURONS};

static void make_frame(enum data data)
{
    for (size_t i = 0; i < SAMPLES * NEURONS; i++)
        activations[i] = activation(data, i, SAMPLES * NEURONS);
}

// The live histogram and the candidates: those of extreme data lie as far apart as possible.
static void make_hists(enum data data, unsigned count)
{
    for (size_t n = 0; n < NEURONS; n++) {
        range[n][0] = -1;
        range[n][1] = 1;
    }
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = BINS;
    config.range = range[0];
    for (unsigned h = 0; h < count; h++) {
        if (vdna_hist_init(&config, blocks[h], sizeof blocks[h], &hists[h]) != VDNA_OK)
            abort();
        make_frame(data);
        for (size_t i = 0; data == EXTREME && i < SAMPLES * NEURONS; i++)
            activations[i] = h == 0 ? -1 : 1;
        if (vdna_hist_add(&hists[h], &tap, 1) != VDNA_OK)
            abort();
        vdna_hist_view_of(&hists[h], &views[h]);
    }
}

// Sorted rows come ever nearer: each is the best so far.
static void make_map(enum data data)
{
    for (size_t i = 0; i < ROWS * DIM; i++)
        map[i] = data == RANDOM     ? chance()
                 : data == CONSTANT ? 0.5f
                 : data == SORTED   ? (float)(ROWS - i / DIM)
                                    : (i % 2 ? 1e15f : -1e15f);
    for (size_t i = 0; i < DIM; i++)
        query[i] = data == RANDOM ? chance() : 0;
}

static void prepare_hist(enum data data)
{
    make_hists(data, 1);
    make_frame(data);
}

// The same numbers as a feature map.
static void prepare_hist_of_map(enum data data)
{
    prepare_hist(data);
    tap.layout = VDNA_LAYOUT_NEURONS_SAMPLES;
}

static void prepare_uncount(enum data data)
{
    prepare_hist(data);
    vdna_count_frame(&hists[0], &tap, 1, slots);
}

static void prepare_emd(enum data data)
{
    make_hists(data, 2);
}

// As if each of its frames had come so many times.
static void repeat(vdna_hist *hist, uint32_t times)
{
    for (size_t i = 0; i < (size_t)NEURONS * BINS; i++)
        hist->counts[i] *= times;
    for (size_t n = 0; n < NEURONS; n++)
        hist->mass[n] *= times;
}

// The common multiple of these masses needs sums of 64 bits.
static void prepare_emd_wide(enum data data)
{
    make_hists(data, 2);
    repeat(&hists[0], 181);
    repeat(&hists[1], 191);
}

static void prepare_rank(enum data data)
{
    make_hists(data, 1 + CANDIDATES);
}

// A localiser whose next frame, elsewhere than the one before, is a step of the filter in full.
static void prepare_localise(enum data data)
{
    make_map(data);
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = ROWS;
    map_config.dim = DIM;
    map_config.embeddings = map;
    vdna_localise_map *prepared;
    if (vdna_localise_map_init(&map_config, map_block, sizeof map_block, &prepared) != VDNA_OK)
        abort();
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = prepared;
    config.tolerance = 5;
    vdna_localise_answer answer;
    if (vdna_localise_init(&config, localise_block, sizeof localise_block, &localiser) != VDNA_OK ||
        vdna_localise_feed(localiser, query, &answer) != VDNA_OK)
        abort();
    query[0] += 100;
}

// Distances 0..2 of a live frame to the nearest of each experience.
static void make_relative(enum data data, unsigned runs)
{
    for (unsigned b = 0; b < runs; b++)
        relative[b] = data == RANDOM     ? chance()
                      : data == CONSTANT ? 0.3
                      : data == SORTED   ? (double)b / runs
                                         : (b % 2 ? 2 : 0);
}

// A warmup whose next frame is the first one after which the choice may have settled.
static void prepare_trust(enum data data, unsigned runs)
{
    static uint32_t frames[RUNS];
    static double own[RUNS], correlation[RUNS];
    for (unsigned a = 0; a < runs; a++) {
        frames[a] = ROWS;
        own[a] = correlation[a] = 1;
        for (unsigned b = 0; b < runs; b++)
            for (unsigned w = 0; w < VDNA_TRUST_WINDOWS; w++) {
                vdna_trust_cell *cell = &cells[a * runs + b];
                cell->nearest[w] = 0.1 + (double)chance();
                cell->likeness[w] = 2; // nothing is farther, so predictions are made
                cell->recall[w] = 1.3 - cell->nearest[w];
                cell->recall[w] = cell->recall[w] < 1 ? cell->recall[w] : 1;
                cell->distance[w] = 10 * cell->nearest[w];
            }
    }
    const vdna_trust_tables tables = {frames, own, correlation, cells};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = runs;
    config.tables = &tables;
    if (vdna_trust_init(&config, trust_block, sizeof trust_block, &trust) != VDNA_OK)
        abort();
    for (unsigned t = 1; t < VDNA_TRUST_SETTLED_FRAMES; t++) {
        make_relative(data, runs);
        if (vdna_trust_feed(trust, relative, relative) != VDNA_OK)
            abort();
    }
    make_relative(data, runs);
}

static void prepare_trust_4(enum data data)
{
    prepare_trust(data, 4);
}

static void prepare_trust_100(enum data data)
{
    prepare_trust(data, RUNS);
}

static uint8_t picture[WIDTH * HEIGHT * CHANNELS];

// The range of activations is that of grey levels.
static void prepare_health(enum data data)
{
    for (size_t i = 0; i < sizeof picture; i++) {
        const float value = activation(data, i, sizeof picture);
        picture[i] = value < -1 ? 0 : value > 1 ? 255 : (uint8_t)(127.5f * (value + 1));
    }
}

static vdna_status run_hist_add(void)
{
    return vdna_hist_add(&hists[0], &tap, 1);
}

static vdna_status run_count(void)
{
    vdna_count_frame(&hists[0], &tap, 1, slots);
    return VDNA_OK;
}

static vdna_status run_uncount(void)
{
    vdna_uncount_frame(&hists[0], &tap, 1, slots);
    return VDNA_OK;
}

static vdna_status run_emd(void)
{
    double distance;
    return vdna_emd_mean(&views[0], &views[1], scratch, sizeof scratch, &distance);
}

static vdna_status run_rank(void)
{
    return vdna_rank(&views[0], views + 1, CANDIDATES, scratch, sizeof scratch, ranking);
}

static vdna_status run_knn(void)
{
    vdna_knn_match match;
    return vdna_knn(query, DIM, map, ROWS, 1, &match);
}

static vdna_status run_localise(void)
{
    vdna_localise_answer answer;
    return vdna_localise_feed(localiser, query, &answer);
}

static vdna_status run_trust(void)
{
    return vdna_trust_feed(trust, relative, relative);
}

static vdna_status run_predict(void)
{
    static vdna_trust_prediction predictions[RUNS];
    vdna_trust_answer answer;
    return vdna_trust_predict(trust, relative, predictions, &answer);
}

static vdna_status run_health(void)
{
    const vdna_pixels pixels = {picture, WIDTH * CHANNELS, WIDTH, HEIGHT, CHANNELS, {2, 1, 0}};
    vdna_health_picture measured_picture;
    return vdna_health_measure(&pixels, &measured_picture);
}

static const struct {
    const char *name;
    void (*prepare)(enum data data);
    vdna_status (*run)(void);
} things[] = {
    {"hist_add", prepare_hist, run_hist_add},
    {"hist_add_map", prepare_hist_of_map, run_hist_add},
    {"count", prepare_hist, run_count},
    {"uncount", prepare_uncount, run_uncount},
    {"emd", prepare_emd, run_emd},
    {"emd_wide", prepare_emd_wide, run_emd},
    {"rank", prepare_rank, run_rank},
    {"knn", make_map, run_knn},
    {"localise", prepare_localise, run_localise},
    {"trust_4", prepare_trust_4, run_trust},
    {"trust_100", prepare_trust_100, run_trust},
    {"predict_4", prepare_trust_4, run_predict},
    {"predict_100", prepare_trust_100, run_predict},
    {"health", prepare_health, run_health},
};

__attribute__((noipa)) vdna_status measured(vdna_status (*run)(void));
vdna_status measured(vdna_status (*run)(void))
{
    return run();
}

int main(int argc, char **argv)
{
    if (argc == 3 || argc == 4)
        for (size_t t = 0; t < sizeof things / sizeof *things; t++)
            for (int k = 0; k < KINDS; k++)
                if (!strcmp(argv[1], things[t].name) && !strcmp(argv[2], kinds[k])) {
                    things[t].prepare((enum data)k);
                    return argc == 4 || measured(things[t].run) == VDNA_OK ? 0 : 1;
                }
    return fprintf(stderr, "usage: instructions hist_add|emd|... random|constant|...\n"), 2;
}
