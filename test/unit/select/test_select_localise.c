/* A selector that localises by localisers: which of them it feeds, when, and whom it believes. */
#include <math.h>

#include <vdna/select.h>

#include "cmocka_all.h"

/* One neuron in two bins. "low" has all its samples in the lower, "high" in the upper one. Each
 * experience goes once round a circle, on which "high" begins half a turn later. */
#define FRAMES 12u
#define DIM 2u
static const float range[] = {0, 2};
static const uint32_t low_counts[] = {1, 0}, high_counts[] = {0, 1}, mass = 1;
static const vdna_select_candidate candidates[] = {
    {{range, low_counts, &mass, 1, 2}, NULL, FRAMES, 0},
    {{range, high_counts, &mass, 1, 2}, NULL, FRAMES, 0},
};

static int64_t map_block[2][256], localiser_block[2][1024], block[512];
static vdna_localise *localisers[2];

static void at_angle(double turns, float *out)
{
    out[0] = (float)cos(2 * acos(-1.0) * turns);
    out[1] = (float)sin(2 * acos(-1.0) * turns);
}

static void make_localiser(uint32_t which, uint32_t frames, double begin)
{
    float embeddings[FRAMES][DIM];
    for (uint32_t i = 0; i < FRAMES; i++)
        at_angle((double)i / FRAMES + begin, embeddings[i]);
    vdna_localise_map_config of_map;
    vdna_localise_map_config_init(&of_map);
    of_map.frames = frames;
    of_map.dim = DIM;
    of_map.embeddings = embeddings[0];
    vdna_localise_map *map;
    assert_int_equal(vdna_localise_map_init(&of_map, map_block[which], sizeof *map_block, &map),
                     VDNA_OK);
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = map;
    assert_int_equal(vdna_localise_init(&config, localiser_block[which], sizeof *localiser_block,
                                        &localisers[which]),
                     VDNA_OK);
}

static vdna_select_config config_of_two(uint32_t top)
{
    make_localiser(0, FRAMES, 0);
    make_localiser(1, FRAMES, 0.5);
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = 2;
    config.dim = DIM;
    config.warmup_frames = 2;
    config.time_unit = VDNA_TIME_UNIT_US;
    config.localisers = localisers;
    config.top = top;
    return config;
}

static vdna_select *selector(uint32_t top)
{
    const vdna_select_config config = config_of_two(top);
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_OK);
    return select;
}

/* The neuron is what "low" has. */
static vdna_select_answer feed(vdna_select *select, int64_t utime, double turns)
{
    const float activation = 0.5f;
    float embedding[DIM];
    at_angle(turns, embedding);
    const vdna_activations tap = {&activation, 1, 1, 0};
    const vdna_select_frame frame = {utime, &tap, 1, embedding};
    vdna_select_answer answer;
    assert_int_equal(vdna_select_feed(select, &frame, &answer), VDNA_OK);
    return answer;
}

static void frames_after_the_choice_are_placed_in_the_chosen_experience(void **state)
{
    (void)state;
    vdna_select *select = selector(1);
    feed(select, 1, 0);
    assert_null(vdna_select_where(select));
    assert_int_equal(feed(select, 2, 1.0 / FRAMES).localised, 0);
    assert_in_range(vdna_select_where(select)->answer.nearest, 0, 2); /* led there by the warmup */
    for (uint32_t i = 2; i < 8; i++) {
        const vdna_select_answer answer = feed(select, i + 1, (double)i / FRAMES);
        const vdna_select_position *where = vdna_select_where(select);
        assert_int_equal(answer.localised, 1);
        assert_int_equal(where->candidate, 0);
        assert_int_equal(answer.match.index, where->answer.nearest);
        assert_true(answer.match.distance_sq == 2 * where->answer.nearest_distance);
        assert_int_equal(where->answer.moving, 1);
        assert_in_range(where->answer.nearest, i - 1, i + 1);
    }
    assert_in_range(vdna_select_where(select)->answer.frame, 6, 8);
    assert_true(vdna_localise_distances(localisers[1])[0] == 0); /* never asked */
}

/* All but the last ones, which lead the filter of the chosen. */
static void frames_of_the_warmup_go_into_every_live_mean(void **state)
{
    (void)state;
    const uint32_t leads = VDNA_LOCALISE_LEAD_FRAMES;
    vdna_select_config config = config_of_two(1);
    config.warmup_frames = leads + 2;
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_OK);
    double before[2];
    for (uint32_t which = 0; which < 2; which++)
        before[which] = vdna_localise_mean(localisers[which])[0];
    for (uint32_t i = 0; i < leads + 1; i++)
        feed(select, i + 1, (double)i / FRAMES);
    for (uint32_t which = 0; which < 2; which++) /* the map's own mean is worth 3 frames */
        assert_true(fabs(vdna_localise_mean(localisers[which])[0] - (before[which] + 0.25)) < 1e-6);

    feed(select, leads + 2, (leads + 1.0) / FRAMES);
    float second[DIM];
    at_angle(1.0 / FRAMES, second);
    assert_true(fabs(vdna_localise_mean(localisers[1])[0] - (1 + second[0]) / 5) < 1e-6);
    assert_true(vdna_localise_evidence(localisers[1]) == 0);
    assert_true(vdna_localise_evidence(localisers[0]) > 0);
    assert_in_range(vdna_select_where(select)->answer.frame, leads, leads + 1);
}

static void a_warmup_anew_forgets_the_place(void **state)
{
    (void)state;
    vdna_select *select = selector(1);
    const double before = vdna_localise_mean(localisers[0])[0];
    for (uint32_t i = 0; i < 4; i++)
        feed(select, i + 1, (double)i / FRAMES);
    assert_non_null(vdna_select_where(select));
    vdna_select_reset(select);
    assert_null(vdna_select_where(select));
    assert_true(vdna_localise_mean(localisers[0])[0] == before);
}

static void among_the_nearest_experiences_the_most_confident_answers(void **state)
{
    (void)state;
    vdna_select *select = selector(2);
    for (uint32_t i = 0; i < 2; i++)
        feed(select, i + 1, (double)i / FRAMES);
    /* Only the second one sees where the drive goes on. */
    float embedding[DIM];
    vdna_localise_answer answer;
    for (uint32_t i = 6; i < 10; i++) {
        at_angle((double)i / FRAMES, embedding);
        assert_int_equal(vdna_localise_feed(localisers[1], embedding, &answer), VDNA_OK);
    }
    feed(select, 3, 10.0 / FRAMES);
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_int_equal(vdna_select_where(select)->candidate, 1);
}

static void of_equally_confident_experiences_the_nearer_answers(void **state)
{
    (void)state;
    vdna_select *select = selector(7); /* of two */
    make_localiser(1, FRAMES, 0);      /* "high" looks like "low" */
    for (uint32_t i = 0; i < 4; i++)
        feed(select, i + 1, (double)i / FRAMES);
    assert_int_equal(vdna_select_where(select)->candidate, 0);
    assert_true(vdna_localise_evidence(localisers[0]) == vdna_localise_evidence(localisers[1]));
}

static void localisers_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    vdna_select_config config = config_of_two(1);
    config.top = 0;
    assert_int_equal(vdna_select_mem_size(&config), 0);
    config.top = 2;
    assert_true(vdna_select_mem_size(&config) > 0);
    config.localisers = NULL;
    assert_int_equal(vdna_select_mem_size(&config), 0);

    config = config_of_two(1);
    make_localiser(1, FRAMES - 1, 0.5);
    assert_int_equal(vdna_select_mem_size(&config), 0);
    localisers[1] = NULL;
    assert_int_equal(vdna_select_mem_size(&config), 0);

    config = config_of_two(1);
    config.dim = DIM + 1;
    assert_int_equal(vdna_select_mem_size(&config), 0);
    vdna_select_candidate empty[2] = {candidates[0], candidates[1]};
    empty[1].frames = 0;
    config = config_of_two(1);
    config.candidates = empty;
    assert_int_equal(vdna_select_mem_size(&config), 0);
}

static void nothing_is_nowhere(void **state)
{
    (void)state;
    assert_null(vdna_select_where(NULL));
    assert_int_equal(vdna_localise_frames(NULL), 0);
    assert_int_equal(vdna_localise_dim(NULL), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_after_the_choice_are_placed_in_the_chosen_experience),
        cmocka_unit_test(frames_of_the_warmup_go_into_every_live_mean),
        cmocka_unit_test(a_warmup_anew_forgets_the_place),
        cmocka_unit_test(among_the_nearest_experiences_the_most_confident_answers),
        cmocka_unit_test(of_equally_confident_experiences_the_nearer_answers),
        cmocka_unit_test(localisers_that_do_not_fit_are_refused),
        cmocka_unit_test(nothing_is_nowhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
