/* A map of three lights along one route, and a robot that drives there. */
#ifndef VDNA_TEST_LIGHTS_H
#define VDNA_TEST_LIGHTS_H

#include <math.h>

#include <vdna/select.h>

#include "cmocka_all.h"

#define OK(call) assert_int_equal((call), VDNA_OK)

/* Experiences go along the same route of directions at random. That of the day sees it by the first
 * half of an embedding, that of the night by the second one, a third sees nothing of it. All the
 * Visual DNA of experience b is in bin b. */
enum { RUNS = 3, FRAMES = 40, HALF = 8, DIM = 2 * HALF, BINS = 4, WORDS = 4096 };
enum { DAY, FOG, NIGHT };
static const float range[] = {0, BINS};
static const uint32_t counts[RUNS][BINS] = {{1}, {0, 1}, {0, 0, 1}}, mass = 1;

static float route[FRAMES][HALF], embeddings[RUNS][FRAMES][DIM];
static vdna_select_candidate candidates[RUNS];
static vdna_trust_run runs[RUNS];
static int64_t map_block[RUNS][WORDS], localiser_block[RUNS][WORDS], block[WORDS];
static vdna_localise *localisers[RUNS];
static uint32_t random_state;

static float noise(void)
{
    random_state = random_state * 1664525 + 1013904223;
    return (float)(random_state >> 8) / (1 << 23) - 1;
}

/* What a camera sees. */
static void see(uint32_t frame, uint32_t light, float *out)
{
    const float by_day = light == DAY ? 1.0f : 0.0f, by_night = light == NIGHT ? 1.0f : 0.0f;
    for (uint32_t i = 0; i < HALF; i++) {
        out[i] = by_day * route[frame][i] + 0.2f * noise();
        out[HALF + i] = by_night * route[FRAMES - 1 - frame][i] + 0.2f * noise();
    }
}

static void make_localiser(uint32_t b)
{
    vdna_localise_map_config of_map;
    vdna_localise_map_config_init(&of_map);
    of_map.frames = FRAMES;
    of_map.dim = DIM;
    of_map.embeddings = embeddings[b][0];
    vdna_localise_map *map;
    OK(vdna_localise_map_init(&of_map, map_block[b], sizeof *map_block, &map));
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = map;
    config.tolerance = 1;
    OK(vdna_localise_init(&config, localiser_block[b], sizeof *localiser_block, &localisers[b]));
}

static void make_map(void)
{
    random_state = 1;
    for (uint32_t f = 0; f < FRAMES; f++)
        for (uint32_t i = 0; i < HALF; i++)
            route[f][i] = noise();
    for (uint32_t b = 0; b < RUNS; b++) {
        for (uint32_t f = 0; f < FRAMES; f++)
            see(f, b, embeddings[b][f]);
        make_localiser(b);
        const vdna_select_candidate candidate = {
            {range, counts[b], &mass, 1, BINS}, NULL, FRAMES, 0};
        const vdna_trust_run run = {embeddings[b][0], NULL, NULL, NULL, NULL, NULL,
                                    FRAMES,           DIM,  0,    0};
        candidates[b] = candidate;
        runs[b] = run;
    }
}

/* Trust that knows nothing of the map, unless there are tables. */
static vdna_trust *make_trust(const vdna_trust_tables *tables)
{
    static int64_t room[1024];
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = RUNS;
    config.tables = tables;
    vdna_trust *trust;
    OK(vdna_trust_init(&config, room, sizeof room, &trust));
    return trust;
}

static vdna_select *selector(vdna_trust *trust, uint32_t frames, uint32_t reselect)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = RUNS;
    config.dim = DIM;
    config.warmup_frames = frames;
    config.time_unit = VDNA_TIME_UNIT_US;
    config.localisers = localisers;
    config.trust = trust;
    config.runs = runs;
    config.reselect = reselect;
    vdna_select *select;
    OK(vdna_select_init(&config, block, sizeof block, &select));
    return select;
}

static vdna_select_answer feed(vdna_select *select, uint32_t time, float activation,
                               const float *embedding)
{
    const vdna_activations tap = {&activation, 1, 1, 0};
    const vdna_select_frame frame = {time, &tap, 1, embedding};
    vdna_select_answer answer;
    OK(vdna_select_feed(select, &frame, &answer));
    return answer;
}

/* Of a robot that drives along the route again and again. */
static vdna_select_answer drive(vdna_select *select, uint32_t time, uint32_t light)
{
    float embedding[DIM];
    see(time % FRAMES, light, embedding);
    return feed(select, time, 0.5f, embedding); /* as by day */
}

/* Every run found the others at so small a distance that nothing is like them. */
static const vdna_trust_tables *lonely_tables(void)
{
    static const uint32_t frames[RUNS] = {FRAMES, FRAMES, FRAMES};
    static const double own[RUNS] = {1, 1, 1}, correlation[RUNS] = {NAN, NAN, NAN};
    static vdna_trust_cell cells[RUNS * RUNS];
    static const vdna_trust_tables tables = {frames, own, correlation, cells};
    for (uint32_t i = 0; i < RUNS * RUNS; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++) {
            cells[i].nearest[w] = 0.5;
            cells[i].likeness[w] = cells[i].recall[w] = cells[i].distance[w] = NAN;
        }
    return &tables;
}

#endif
