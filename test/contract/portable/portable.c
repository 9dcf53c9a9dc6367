/* portable THREADS: do everything that the core, the selector, the localiser and trust do on
 * made-up frames, and the checksum of experience files, and print the results to the last bit, for
 * portable.py to compare between machines and with its own.
 *
 * All values are small integers times powers of two, so making them rounds nothing. Numbers are
 * printed by value, so the order of bytes in memory does not show. */
#include <crc32c.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/vdna.h>

static void require(int condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "portable: %s failed\n", what);
        exit(1);
    }
}

#define OK(call) require((call) == VDNA_OK, #call)

/* splitmix64 */
static uint64_t random_state;

static uint32_t random_below(uint32_t limit)
{
    uint64_t x = random_state += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)((x ^ x >> 31) >> 32) % limit;
}

static float scaled(int32_t number, int exponent)
{
    float value = (float)number;
    for (; exponent > 0; exponent--)
        value *= 2;
    for (; exponent < 0; exponent++)
        value /= 2;
    return value;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint32_t bits_of_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void *block(size_t size)
{
    void *mem = malloc(size);
    require(size > 0 && mem != NULL, "a block");
    return mem;
}

static void print_digest(const char *name, const uint32_t *words, size_t count)
{
    uint64_t digest = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        digest = (digest ^ words[i]) * 0x100000001b3u;
    printf("%s %016" PRIx64 "\n", name, digest);
}

/* Counts, mass and saturation. */
static void print_hist(const char *name, const vdna_hist *hist)
{
    printf("frames %" PRIu32 " ", hist->frames);
    print_digest(name, hist->counts, (size_t)hist->neurons * (hist->bins + 2));
}

/* ---- Frames of three taps: tokens, a feature map, a descriptor ---- */

enum { TAPS = 3, CANDIDATES = 5, FRAMES = 4, BINS = 1000, NEURONS = 12 + 2 + 40 };
static float tokens[12 * 197], map[2 * 3136], descriptor[40];
static const vdna_activations large[TAPS] = {
    {tokens, 12, 197, VDNA_LAYOUT_SAMPLES_NEURONS},
    {map, 2, 3136, VDNA_LAYOUT_NEURONS_SAMPLES},
    {descriptor, 40, 1, VDNA_LAYOUT_SAMPLES_NEURONS},
};
static const vdna_activations small[TAPS] = {
    {tokens, 8, 5, VDNA_LAYOUT_SAMPLES_NEURONS},
    {map, 4, 9, VDNA_LAYOUT_NEURONS_SAMPLES},
    {descriptor, 6, 1, VDNA_LAYOUT_SAMPLES_NEURONS},
};

/* Fill the taps; `shift` moves their distributions. */
static void make_frame(const vdna_activations *taps, uint32_t shift)
{
    float *const values[TAPS] = {tokens, map, descriptor};
    for (size_t t = 0; t < TAPS; t++)
        for (uint32_t i = 0; i < taps[t].neurons * taps[t].samples; i++) {
            const uint32_t neuron = taps[t].layout == VDNA_LAYOUT_SAMPLES_NEURONS
                                        ? i % taps[t].neurons
                                        : i / taps[t].samples;
            const uint32_t coarse = random_below(65536) + 3000 * shift, fine = random_below(65536);
            const int32_t number = (int32_t)(128 * coarse + fine) - 4000000;
            values[t][i] = scaled(number, (int)(neuron * 7 % 60) - 45);
        }
}

static vdna_hist new_hist(const float *range, uint32_t neurons, uint32_t bins)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = neurons;
    config.bins = bins;
    config.range = range;
    const size_t size = vdna_hist_mem_size(&config);
    vdna_hist hist;
    OK(vdna_hist_init(&config, block(size), size, &hist));
    return hist;
}

static vdna_hist counted(const float *range, uint32_t shift)
{
    vdna_hist hist = new_hist(range, NEURONS, BINS);
    for (int f = 0; f < FRAMES; f++) {
        make_frame(large, shift);
        OK(vdna_hist_add(&hist, large, TAPS));
    }
    return hist;
}

/* ---- Distances of the live histogram to some of the candidates, in a thread of its own ---- */

typedef struct job {
    const vdna_hist_view *live, *candidates;
    uint32_t begin, end;
    double emd[CANDIDATES][NEURONS], mean[CANDIDATES];
} job;

static void *run_job(void *argument)
{
    job *j = argument;
    const size_t size = vdna_emd_scratch_size(NEURONS);
    void *scratch = block(size);
    for (uint32_t c = j->begin; c < j->end; c++) {
        OK(vdna_emd(j->live, &j->candidates[c], scratch, size, j->emd[c]));
        OK(vdna_emd_mean(j->live, &j->candidates[c], scratch, size, &j->mean[c]));
    }
    free(scratch);
    return NULL;
}

/* One job for all candidates, or two that share them out. */
static void print_distances(const vdna_hist_view *live, const vdna_hist_view *candidates,
                            uint32_t threads, double *out_mean)
{
    static job jobs[2];
    pthread_t thread[2];
    for (uint32_t t = 0; t < threads; t++) {
        jobs[t].live = live;
        jobs[t].candidates = candidates;
        jobs[t].begin = CANDIDATES * t / threads;
        jobs[t].end = CANDIDATES * (t + 1) / threads;
        require(pthread_create(&thread[t], NULL, run_job, &jobs[t]) == 0, "pthread_create");
    }
    for (uint32_t t = 0; t < threads; t++) {
        require(pthread_join(thread[t], NULL) == 0, "pthread_join");
        for (uint32_t c = jobs[t].begin; c < jobs[t].end; c++) {
            for (uint32_t n = 0; n < NEURONS; n++)
                printf("emd %" PRIu32 " %" PRIu32 " %016" PRIx64 "\n", c, n,
                       bits_of(jobs[t].emd[c][n]));
            printf("mean %" PRIu32 " %016" PRIx64 "\n", c, bits_of(jobs[t].mean[c]));
            out_mean[c] = jobs[t].mean[c];
        }
    }
}

static void print_ranking(const vdna_rank_entry *ranking)
{
    for (int i = 0; i < CANDIDATES; i++)
        printf("rank %d %" PRIu32 " %" PRIu32 " %016" PRIx64 "\n", i, ranking[i].candidate,
               ranking[i].tied, bits_of(ranking[i].distance_bins));
}

/* Warm up on as many frames as the live histogram holds, then localise one. */
static void print_selection(const vdna_hist_view *candidates)
{
    enum { DIM = 11, ROWS = 6 };
    static float embeddings[CANDIDATES][ROWS * DIM], query[DIM];
    vdna_select_candidate candidate[CANDIDATES];
    for (uint32_t c = 0; c < CANDIDATES; c++) {
        for (int i = 0; i < ROWS * DIM; i++)
            embeddings[c][i] = scaled((int32_t)random_below(2000) - 1000, -6);
        const vdna_select_candidate filled = {candidates[c], embeddings[c], ROWS, 0};
        candidate[c] = filled;
    }
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidate;
    config.candidate_count = CANDIDATES;
    config.dim = DIM;
    config.warmup_frames = FRAMES;
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    OK(vdna_select_init(&config, block(size), size, &select));

    random_state = 7;
    vdna_select_answer answer;
    for (int f = 0; f < FRAMES + 3; f++) {
        make_frame(large, 3);
        for (int i = 0; i < DIM; i++)
            query[i] = scaled((int32_t)random_below(2000) - 1000, -6);
        const vdna_select_frame frame = {f * 1000, large, TAPS, query};
        OK(vdna_select_feed(select, &frame, &answer));
        printf("select %" PRIu32 " %" PRIu32, answer.state, answer.newly_ranked);
        if (answer.localised)
            printf(" %" PRIu32 " %016" PRIx64, answer.match.index,
                   bits_of(answer.match.distance_sq));
        printf("\n");
    }
    printf("chosen %" PRIu32 " %016" PRIx64 "\n", vdna_select_chosen(select),
           bits_of(vdna_select_margin_bins(select)));
    print_ranking(vdna_select_ranking(select, NULL));
    free(select);
}

/* Ranges, histograms, distances, ranking, selection. The last candidate is the first again. */
static void rank_candidates(uint32_t threads)
{
    static float range[2 * NEURONS];
    random_state = 1;
    OK(vdna_range_clear(range, NEURONS));
    for (uint32_t shift = 0; shift < 2; shift++) {
        make_frame(large, 4 * shift);
        OK(vdna_range_observe(range, NEURONS, large, TAPS));
    }
    OK(vdna_range_expand(range, NEURONS, 0.9f + 0.2f, VDNA_RANGE_ABOUT_MIDPOINT));
    for (int i = 0; i < 2 * NEURONS; i++)
        printf("range %d %08" PRIx32 "\n", i, bits_of_float(range[i]));

    vdna_hist hist[CANDIDATES];
    vdna_hist_view view[CANDIDATES], live;
    for (uint32_t c = 0; c < CANDIDATES; c++) {
        random_state = 100 + c % (CANDIDATES - 1);
        hist[c] = counted(range, c % (CANDIDATES - 1));
        print_hist("candidate", &hist[c]);
        vdna_hist_view_of(&hist[c], &view[c]);
    }
    random_state = 6;
    const vdna_hist seen = counted(range, 1);
    print_hist("live", &seen);
    vdna_hist_view_of(&seen, &live);

    double mean[CANDIDATES];
    vdna_rank_entry sorted[CANDIDATES], ranking[CANDIDATES];
    const size_t size = vdna_emd_scratch_size(NEURONS);
    void *scratch = block(size);
    print_distances(&live, view, threads, mean);
    OK(vdna_rank_sort(mean, CANDIDATES, sorted));
    OK(vdna_rank(&live, view, CANDIDATES, scratch, size, ranking));
    require(memcmp(sorted, ranking, sizeof ranking) == 0, "both ways to rank");
    print_ranking(ranking);

    random_state = 8;
    print_selection(view);
    free(scratch);
    free(seen.counts);
    for (int c = 0; c < CANDIDATES; c++)
        free(hist[c].counts);
}

/* ---- Sliding windows ---- */

static void slide(int64_t length_us, uint32_t capacity)
{
    enum { SMALL_NEURONS = 8 + 4 + 6 };
    static float range[2 * SMALL_NEURONS];
    for (uint32_t n = 0; n < SMALL_NEURONS; n++) {
        const uint32_t within_tap = n < 8 ? n : n < 12 ? n - 8 : n - 12;
        range[2 * n] = scaled(-3500001, (int)(within_tap * 7 % 60) - 45);
        range[2 * n + 1] = scaled(5000000, (int)(within_tap * 7 % 60) - 45);
    }
    vdna_window_config config;
    vdna_window_config_init(&config);
    config.capacity = capacity;
    config.length_us = length_us;
    config.taps = small;
    config.tap_count = TAPS;
    config.range = range;
    config.bins = 33;
    const size_t size = vdna_window_mem_size(&config);
    vdna_window *window;
    OK(vdna_window_init(&config, block(size), size, &window));

    random_state = 2;
    int64_t utime = 0;
    for (int f = 0; f < 80; f++) {
        utime += (int64_t)random_below(100) - 10;
        make_frame(small, (uint32_t)f % 7);
        OK(vdna_window_add(window, utime, small, TAPS, NULL));
        printf("window %" PRIu32 " %" PRIu64 " %" PRIu64 " ", vdna_window_truncated(window),
               vdna_window_left_early(window), vdna_window_restarts(window));
        print_hist("slid", vdna_window_hist(window));
    }
    free(window);
}

/* ---- Every bin edge, and the two floats on either side of it ---- */

static const uint32_t edge_ranges[][2] = {
    /* bits of lo and hi: -1..1, 0..1, 0.1..0.7, -3..1e-3, 1e6..1e6+1, 16777216..16777218 */
    {0xbf800000, 0x3f800000},
    {0x00000000, 0x3f800000},
    {0x3dcccccd, 0x3f333333},
    {0xc0400000, 0x3a83126f},
    {0x49742400, 0x49742410},
    {0x4b800000, 0x4b800001},
    /* -max..max, -1e-38..1e-38, two subnormals, 0 and the least subnormal, 1..max, -1e30..1 */
    {0xff7fffff, 0x7f7fffff},
    {0x806ce3ee, 0x006ce3ee},
    {0x00000001, 0x00000400},
    {0x00000000, 0x00000001},
    {0x3f800000, 0x7f7fffff},
    {0xf149f2ca, 0x3f800000},
};

enum { EDGE_RANGES = sizeof edge_ranges / sizeof *edge_ranges };

/* Floats in their order as unsigned integers, and back. */
static uint32_t order_of(float value)
{
    const uint32_t bits = bits_of_float(value);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static float of_order(uint32_t order)
{
    const float value = float_of(order >> 31 ? order & 0x7fffffff : ~order);
    return value;
}

static void count_edges(uint32_t bins)
{
    float range[2 * EDGE_RANGES];
    for (int r = 0; r < EDGE_RANGES; r++) {
        range[2 * r] = float_of(edge_ranges[r][0]);
        range[2 * r + 1] = float_of(edge_ranges[r][1]);
    }
    vdna_hist hist = new_hist(range, EDGE_RANGES, bins);
    const uint32_t around = 5, samples = (bins + 1) * around;
    float *values = block(EDGE_RANGES * samples * sizeof *values);
    for (uint32_t r = 0; r < EDGE_RANGES; r++)
        for (uint32_t b = 0; b <= bins; b++) {
            const double lo = range[2 * r], hi = range[2 * r + 1];
            const uint32_t order = order_of((float)(lo + (hi - lo) * b / bins));
            for (uint32_t i = 0; i < around; i++) {
                /* Beyond the largest floats are infinities: stay at the edge itself. */
                const float value = of_order(order + i - 2);
                const int finite = value - value == 0;
                values[r * samples + b * around + i] = finite ? value : of_order(order);
            }
        }
    const vdna_activations tap = {values, EDGE_RANGES, samples, VDNA_LAYOUT_NEURONS_SAMPLES};
    OK(vdna_hist_add(&hist, &tap, 1));
    print_hist("edges", &hist);
    free(values);
    free(hist.counts);
}

/* ---- Masses up to the bound and beyond ---- */

static void print_status(const uint32_t *p, uint32_t mass_p, const uint32_t *q, uint32_t mass_q,
                         uint32_t bins)
{
    static const float range[] = {0, 1};
    const vdna_hist_view view_p = {range, p, &mass_p, 1, bins},
                         view_q = {range, q, &mass_q, 1, bins};
    int64_t scratch[2];
    double emd = 0;
    const vdna_status status = vdna_emd(&view_p, &view_q, scratch, sizeof scratch, &emd);
    printf("bound %" PRIu32 " %" PRIu32 " %" PRIu32 " %d %016" PRIx64 "\n", bins, mass_p, mass_q,
           (int)status, bits_of(emd));
}

static void meet_the_bound(void)
{
    /* bins, mass_p, mass_q with mass_p * mass_q exactly INT64_MAX / (bins - 1), or one more. */
    static const uint32_t at_the_edge[][3] = {
        {2, 4042815511, 2281422937},     {3, 2147483649, 2147483647}, {3, 2147483648, 2147483648},
        {5, 2147483648, 1073741824},     {257, 4092335743, 8803969},  {257, 2147483648, 16777216},
        {1000, 2889827123, 3194864},     {65535, 4261673988, 33025},  {65535, 155193221, 906881},
        {65536, 4027576576, 34944},      {2, 4294967295, 2147483648}, {2, 4294967295, 2147483649},
        {65536, 4294967295, 4294967295},
    };
    static uint32_t p[65536], q[65536];
    for (size_t i = 0; i < sizeof at_the_edge / sizeof *at_the_edge; i++) {
        /* From the first bin to the last, which is the largest distance. */
        const uint32_t *e = at_the_edge[i];
        p[0] = e[1];
        q[e[0] - 1] = e[2];
        print_status(p, e[1], q, e[2], e[0]);
        p[0] = q[e[0] - 1] = 0;
    }

    /* Large masses in random heaps: quotients with more than 53 bits above and below the line. */
    random_state = 3;
    for (int repeat = 0; repeat < 200; repeat++) {
        const uint32_t bins = 2 + random_below(40), room = 0x7fffffff / bins / 7;
        uint32_t mass_p = 0, mass_q = 0;
        for (uint32_t b = 0; b < bins; b++) {
            mass_p += p[b] = random_below(room);
            mass_q += q[b] = random_below(2) ? random_below(room) : p[b];
        }
        print_status(p, mass_p, q, mass_q, bins);
    }
}

/* ---- Nearest neighbours of embeddings whose squared distances round ---- */

static void find_neighbours(void)
{
    enum { DIM = 37, ROWS = 20, K = 6 };
    static float map_rows[ROWS * DIM], query[DIM];
    random_state = 4;
    for (int i = 0; i < ROWS * DIM; i++)
        map_rows[i] = scaled((int32_t)random_below(1 << 23), i % 30 - 30);
    for (int i = 0; i < DIM; i++)
        query[i] = scaled((int32_t)random_below(1 << 23), i % 30 - 30);
    vdna_knn_match match[K];
    OK(vdna_knn(query, DIM, map_rows, ROWS, K, match));
    for (int i = 0; i < K; i++)
        printf("same %" PRIu32 " %016" PRIx64 "\n", match[i].index, bits_of(match[i].distance_sq));
}

/* ---- Localisation: exp, log and sqrt round, and must round alike ---- */

static void localise(uint32_t centred)
{
    enum { DIM = 23, MAP = 70, STEPS = 30 };
    static float embeddings[MAP][DIM];
    random_state = 5;
    for (int i = 0; i < MAP; i++)
        for (int k = 0; k < DIM; k++) /* like the frame before, mostly */
            embeddings[i][k] = scaled((int32_t)random_below(2000) - 1000, k % 9 - 6) +
                               (i > 0 ? embeddings[i - 1][k] / 2 : 0);
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = MAP;
    map_config.dim = DIM;
    map_config.centred = centred;
    map_config.embeddings = embeddings[0];
    size_t size = vdna_localise_map_mem_size(&map_config);
    vdna_localise_map *prepared;
    OK(vdna_localise_map_init(&map_config, block(size), size, &prepared));
    printf("same step %016" PRIx64 "\n", bits_of(vdna_localise_map_step(prepared)));

    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = prepared;
    config.tolerance = 2;
    size = vdna_localise_mem_size(&config);
    vdna_localise *localiser;
    OK(vdna_localise_init(&config, block(size), size, &localiser));
    for (int t = 0; t < STEPS; t++) {
        float live[DIM];
        for (int k = 0; k < DIM; k++)
            live[k] = embeddings[2 * t][k] + scaled((int32_t)random_below(2000) - 1000, k % 9 - 7);
        vdna_localise_answer answer;
        OK(vdna_localise_feed(localiser, live, &answer));
        printf("same %" PRIu32 " %" PRIu32 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n",
               answer.frame, answer.nearest, bits_of(answer.confidence), bits_of(answer.mass),
               bits_of(answer.nearest_distance));
    }
    free(localiser);
    free(prepared);
}

/* ---- Trust: the tables of made-up runs, a warmup, predictions, another choice ---- */

enum { TRUST_RUNS = 4, TRUST_DIM = 19, TRUST_FRAMES = 40 };

static float trust_frames[TRUST_RUNS + 1][TRUST_FRAMES][TRUST_DIM];
static int8_t trust_codes[TRUST_RUNS + 1][TRUST_FRAMES][TRUST_DIM];
static float trust_scales[TRUST_RUNS + 1][TRUST_FRAMES];

static void make_trust_runs(vdna_trust_run *runs)
{
    static int64_t place[TRUST_FRAMES];
    memset(runs, 0, (TRUST_RUNS + 1) * sizeof *runs);
    for (int r = 0; r <= TRUST_RUNS; r++) {
        random_state = 6; /* the same route */
        for (int f = 0; f < TRUST_FRAMES; f++)
            for (int k = 0; k < TRUST_DIM; k++)
                trust_frames[r][f][k] = scaled((int32_t)random_below(2000) - 900, k % 3 - 9);
        random_state = (uint32_t)r + 7; /* of other looks */
        for (int f = 0; f < TRUST_FRAMES; f++) {
            for (int k = 0; k < TRUST_DIM; k++)
                trust_frames[r][f][k] +=
                    scaled((int32_t)random_below(2000), r - 8) + 0.25f * (float)r;
            OK(vdna_int8_encode(trust_frames[r][f], TRUST_DIM, trust_codes[r][f],
                                &trust_scales[r][f]));
            place[f] = f;
        }
        runs[r].embeddings = trust_frames[r][0];
        runs[r].last_layer = trust_codes[r][0];
        runs[r].last_layer_scale = trust_scales[r];
        runs[r].place = place;
        runs[r].frames = TRUST_FRAMES;
        runs[r].dim = runs[r].last_layer_dim = TRUST_DIM;
    }
}

static void trust_the_choice(uint32_t localiser)
{
    static vdna_trust_cell cells[TRUST_RUNS][TRUST_RUNS];
    static uint32_t frames[TRUST_RUNS];
    static double own[TRUST_RUNS], tau[TRUST_RUNS], relative[TRUST_RUNS][TRUST_FRAMES], pairs[3];
    vdna_trust_run runs[TRUST_RUNS + 1];
    make_trust_runs(runs);
    const size_t scratch_size = vdna_trust_pair_scratch_size(&runs[0], &runs[1]);
    void *scratch = block(scratch_size);
    for (int a = 0; a < TRUST_RUNS; a++) {
        int row = 0;
        frames[a] = TRUST_FRAMES;
        OK(vdna_trust_own_scale(&runs[a], 1, &own[a]));
        for (int b = 0; b < TRUST_RUNS; b++) {
            if (a == b)
                continue;
            OK(vdna_trust_pair(&runs[a], &runs[b], 1, localiser, scratch, scratch_size,
                               relative[row++], &cells[a][b]));
            for (unsigned w = 0; w < VDNA_TRUST_WINDOWS; w++)
                cells[a][b].distance[w] = 5 + 2.0 * (a > b ? a - b : b - a) + 0.125 * w;
        }
        OK(vdna_trust_correlation_time(relative[0], TRUST_RUNS - 1, TRUST_FRAMES, pairs, &tau[a]));
        printf("same %016" PRIx64 " %016" PRIx64 "\n", bits_of(own[a]), bits_of(tau[a]));
    }
    free(scratch);

    const vdna_trust_tables tables = {frames, own, tau, cells[0]};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = TRUST_RUNS;
    config.tables = &tables;
    config.localiser = localiser;
    const size_t size = vdna_trust_mem_size(&config);
    vdna_trust *trust;
    OK(vdna_trust_init(&config, block(size), size, &trust));
    const vdna_trust_fit *fit = vdna_trust_fitted(trust);
    printf("same %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n",
           bits_of(fit->slope), bits_of(fit->sd_best), bits_of(fit->skill), bits_of(fit->far));
    OK(vdna_trust_choose(trust, 0));
    for (int f = 0; f < TRUST_FRAMES; f++) {
        double nearest[TRUST_RUNS], likeness[TRUST_RUNS], expected[TRUST_RUNS];
        uint32_t choice;
        for (int b = 0; b < TRUST_RUNS; b++) {
            OK(vdna_trust_nearest(trust_frames[TRUST_RUNS][f], trust_frames[b][0], TRUST_DIM,
                                  TRUST_FRAMES, &nearest[b], NULL));
            OK(vdna_trust_nearest_int8(trust_codes[TRUST_RUNS][f], trust_scales[TRUST_RUNS][f],
                                       trust_codes[b][0], trust_scales[b], TRUST_DIM, TRUST_FRAMES,
                                       &likeness[b]));
        }
        OK(vdna_trust_feed(trust, nearest, likeness));
        OK(vdna_trust_expect(trust, nearest, expected));
        OK(vdna_trust_reconsider(trust, expected, 1, &choice));
        printf("same %" PRIu32 " %" PRIu32 "\n", vdna_trust_settled_frames(trust), choice);
    }
    static const double distances[TRUST_RUNS] = {11, 9, 7, 5.5};
    vdna_trust_prediction predictions[TRUST_RUNS];
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, distances, predictions, &answer));
    printf("same %" PRIu32 " %016" PRIx64 "\n", answer.verdict, bits_of(answer.unlike));
    for (int b = 0; b < TRUST_RUNS; b++)
        printf("same %" PRIu32 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n",
               predictions[b].reason, bits_of(predictions[b].transfer),
               bits_of(predictions[b].nearest),
               predictions[b].reason ? 0 : bits_of(predictions[b].low));
    free(trust);
}

/* ---- Sizes that a size_t of 32 bits cannot say ---- */

static void refuse_what_cannot_be_addressed(void)
{
    static const float value = 1;
    static const vdna_activations tap = {&value, 65536, 65536, 0}, long_tap = {&value, 1, 65536, 0};
    vdna_hist_config hist;
    vdna_hist_config_init(&hist);
    hist.neurons = 1 << 20;
    hist.bins = 65536;
    vdna_window_config window;
    vdna_window_config_init(&window);
    window.taps = &long_tap;
    window.tap_count = 1;
    window.capacity = 65535;
    const int narrow = sizeof(size_t) == 4;
    require((vdna_emd_scratch_size(UINT32_MAX) == 0) == narrow, "vdna_emd_scratch_size");
    require((vdna_hist_mem_size(&hist) == 0) == narrow, "vdna_hist_mem_size");
    require((vdna_window_mem_size(&window) == 0) == narrow, "vdna_window_mem_size");
    /* Elsewhere this tap is 16 GB, which the check would read. */
    if (narrow)
        require(vdna_activations_check(&tap, 1, 65536) == VDNA_ERR_ARG, "vdna_activations_check");
}

static void checksum(void)
{
    enum { SIZE = 40000 };
    unsigned char *bytes = block(SIZE);
    random_state = 4;
    for (size_t i = 0; i < SIZE; i++)
        bytes[i] = (unsigned char)random_below(256);
    for (size_t size = 1; size < SIZE; size = 2 * size + 1)
        printf("crc32c %zu %08" PRIx32 "\n", size, vdna_crc32c(0, bytes + SIZE - size, size));
    free(bytes);
}

int main(int argc, char **argv)
{
    require(argc == 2 && (argv[1][0] == '1' || argv[1][0] == '2'), "portable THREADS");
    rank_candidates((uint32_t)(argv[1][0] - '0'));
    slide(0, 9);
    slide(300, 7);
    count_edges(2);
    count_edges(7);
    count_edges(1000);
    meet_the_bound();
    checksum();
    find_neighbours();
    localise(1);
    localise(0);
    trust_the_choice(VDNA_TRUST_CENTRED);
    trust_the_choice(VDNA_TRUST_EUCLIDEAN);
    refuse_what_cannot_be_addressed();
    return 0;
}
