#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/localise.h>

#include "cmocka_all.h"
#include "localise_golden.h"

/* Sums in another order. */
#define TOLERATED 1e-9

#define assert_near(found, expected, within) assert_true(fabs((found) - (expected)) <= (within))

#define OK(call) assert_int_equal((call), VDNA_OK)

static int64_t map_mem[4096], localise_mem[4096];

static vdna_localise_map *make_map(const float *embeddings, uint32_t frames, uint32_t dim)
{
    vdna_localise_map_config config;
    vdna_localise_map_config_init(&config);
    config.frames = frames;
    config.dim = dim;
    config.embeddings = embeddings;
    vdna_localise_map *map = NULL;
    OK(vdna_localise_map_init(&config, map_mem, sizeof map_mem, &map));
    return map;
}

/* The filter needs a map for its number of frames only: distances are given to it. */
static vdna_localise_config config_of(uint32_t frames, uint32_t tolerance)
{
    static const float embeddings[FRAMES] = {0};
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = make_map(embeddings, frames, 1);
    config.tolerance = tolerance;
    return config;
}

static vdna_localise *make(const vdna_localise_config *config)
{
    vdna_localise *localise = NULL;
    OK(vdna_localise_init(config, localise_mem, sizeof localise_mem, &localise));
    return localise;
}

static void set_others(vdna_localise_config *config)
{
    static const vdna_gear gears[] = {
        {-8, 0, {.5, .1, .1, .1, .1, .1}},
        {3, 0, {.1, .1, .1, .1, .1, .5}},
    };
    config->gears = gears;
    config->gear_count = 2;
    config->jump = 0.2;
    config->gear_change = 0.3;
    config->sharpness = 1.5;
    config->clutter = 0.4;
    config->evidence_share = 0.5;
    config->confidence[0] = -1;
    config->confidence[1] = 0.4;
    config->confidence[2] = 0.7;
    config->confidence[3] = 0.3;
}

static void check(const vdna_localise_config *config, uint32_t frames, const uint32_t *frame,
                  const double *confidence, const double *mass, const double *posterior,
                  double evidence)
{
    vdna_localise *localise = make(config);
    for (uint32_t t = 0; t < STEPS; t++) {
        vdna_localise_answer answer;
        OK(vdna_localise_feed_distances(localise, golden_distances + t * FRAMES, &answer));
        assert_int_equal(answer.frame, frame[t]);
        assert_near(answer.confidence, confidence[t], TOLERATED);
        assert_near(answer.mass, mass[t], TOLERATED);
    }
    double found[FRAMES];
    vdna_localise_posterior(localise, found);
    for (uint32_t j = 0; j < frames; j++)
        assert_near(found[j], posterior[j], TOLERATED);
    assert_near(vdna_localise_evidence(localise), evidence, TOLERATED);
}

#define CHECK(config, frames, name)                                              \
    check((config), (frames), golden_##name##_frame, golden_##name##_confidence, \
          golden_##name##_mass, golden_##name##_posterior, golden_##name##_evidence)

static void the_filter_equals_the_second_implementation(void **state)
{
    (void)state;
    const vdna_localise_config config = config_of(FRAMES, TOLERANCE);
    CHECK(&config, FRAMES, plain);
}

static void both_passes_of_a_place_count_for_it(void **state)
{
    (void)state;
    vdna_localise_config config = config_of(FRAMES, TOLERANCE);
    config.place = golden_places;
    CHECK(&config, FRAMES, loop);
}

static void any_gears_and_constants_equal_the_second_implementation(void **state)
{
    (void)state;
    vdna_localise_config config = config_of(FRAMES, TOLERANCE);
    set_others(&config);
    CHECK(&config, FRAMES, others);
}

static void maps_shorter_than_a_gear_reaches_do_too(void **state)
{
    (void)state;
    vdna_localise_config config = config_of(1, TOLERANCE);
    CHECK(&config, 1, one);
    config = config_of(2, 0);
    CHECK(&config, 2, two);
    config = config_of(6, 0);
    set_others(&config);
    CHECK(&config, 6, six);
}

static void the_live_mean_and_distances_equal_the_second_implementation(void **state)
{
    (void)state;
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = make_map(golden_live_map, LIVE_MAP, LIVE_DIM);
    vdna_localise *localise = make(&config);
    assert_near(vdna_localise_map_step(config.map), golden_live_step, 0);

    for (uint32_t t = 0; t < LIVE_WARMUP; t++)
        OK(vdna_localise_warm_up(localise, golden_live + t * LIVE_DIM));
    const double bound = sqrt(LIVE_DIM) / 32500;
    for (uint32_t t = LIVE_WARMUP; t < LIVE_FRAMES; t++) {
        vdna_localise_answer answer;
        OK(vdna_localise_feed(localise, golden_live + t * LIVE_DIM, &answer));
        const double *expected = golden_live_distances + (t - LIVE_WARMUP) * LIVE_MAP;
        uint32_t nearest = 0;
        for (uint32_t j = 0; j < LIVE_MAP; j++) {
            assert_near(vdna_localise_distances(localise)[j], expected[j], bound);
            nearest = expected[j] < expected[nearest] ? j : nearest;
        }
        assert_int_equal(answer.nearest, nearest);
        assert_int_equal(answer.moving, golden_live_moving[t - LIVE_WARMUP]);
    }
    for (uint32_t i = 0; i < LIVE_DIM; i++)
        assert_near(vdna_localise_mean(localise)[i], golden_live_mean[i], 1e-9);
}

/* The published example of the research: 24 map frames of 6 numbers; the live frames are the same
 * places, dimmed and shifted, entered at frame 5, every picture twice. Its numbers were made in
 * double throughout; ours begin with embeddings in float. */
static void the_published_example_gives_its_numbers(void **state)
{
    (void)state;
    enum { N = 24, DIM = 6, BEGIN = 5, WARMUP = 5, END = 20 };
    static const uint32_t frames[] = {10, 11, 12, 13, 14, 15, 17, 17, 18, 19};
    static const double confidence[] = {
        0.117909270103, 0.191541037174, 0.270769491329, 0.399929576321, 0.411342450172,
        0.387062141943, 0.483257586294, 0.594897212894, 0.317781681957, 0.453652158792};
    float map[N * DIM], live[END * DIM];
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t k = 0; k < DIM; k++) {
            const double value = sin(0.37 * i * (1 + 0.3 * k) + k) + 0.05 * k;
            map[i * DIM + k] = (float)value;
            if (i < END)
                live[i * DIM + k] = (float)(0.8 * value + 0.3 + 0.1 * cos(1.7 * i + k));
        }
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = make_map(map, N, DIM);
    config.tolerance = 1;
    config.mean_frames = 0;
    config.confidence[0] = -2.5;
    config.confidence[3] = 0;
    vdna_localise *localise = make(&config);
    for (uint32_t i = BEGIN; i < BEGIN + WARMUP; i++)
        OK(vdna_localise_warm_up(localise, live + i * DIM));

    vdna_localise_answer first, second;
    for (uint32_t t = 0; t < END - BEGIN - WARMUP; t++) {
        const float *frame = live + (BEGIN + WARMUP + t) * DIM;
        OK(vdna_localise_feed(localise, frame, &first));
        OK(vdna_localise_feed(localise, frame, &second));
        assert_int_equal(first.frame, frames[t]);
        assert_near(first.confidence, confidence[t], 5e-5);
        assert_int_equal(first.moving, 1);
        assert_int_equal(second.moving, 0);
        second.moving = 1;
        assert_memory_equal(&first, &second, sizeof first);
    }
    assert_near(first.mass, 0.928292523291, 5e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_filter_equals_the_second_implementation),
        cmocka_unit_test(both_passes_of_a_place_count_for_it),
        cmocka_unit_test(any_gears_and_constants_equal_the_second_implementation),
        cmocka_unit_test(maps_shorter_than_a_gear_reaches_do_too),
        cmocka_unit_test(the_live_mean_and_distances_equal_the_second_implementation),
        cmocka_unit_test(the_published_example_gives_its_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
