#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/localise.h>

#include "cmocka_all.h"

#define OK(call) assert_int_equal((call), VDNA_OK)
#define assert_near(found, expected, within) \
    assert_true(fabs((double)(found) - (double)(expected)) <= (double)(within))

/* ---- A route: the embedding at a place, by sines that no two places share ---- */

enum { DIM = 24, MAP = 120, TOLERANCE = 3, WORDS = 8192 };

static float route[MAP][DIM];
static int64_t map_mem[WORDS], localise_mem[WORDS], other_mem[WORDS];

/* `light` dims and shifts everything. */
static void look(double place, double light, float out[DIM])
{
    for (int k = 0; k < DIM; k++)
        out[k] = (float)(light * sin(place * (0.2 + 0.043 * k) + 1.3 * k) + (1 - light) * 0.5 * k);
}

static const vdna_localise_map *map_of(const float *embeddings, uint32_t frames, uint32_t dim)
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

static vdna_localise_config config_of(const vdna_localise_map *map)
{
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.map = map;
    config.tolerance = TOLERANCE;
    return config;
}

static vdna_localise *made(const vdna_localise_config *config)
{
    vdna_localise *localise = NULL;
    OK(vdna_localise_init(config, localise_mem, sizeof localise_mem, &localise));
    return localise;
}

static vdna_localise_config on_the_route(void)
{
    for (int i = 0; i < MAP; i++)
        look(i, 1, route[i]);
    return config_of(map_of(route[0], MAP, DIM));
}

static vdna_localise_answer fed(vdna_localise *localise, double place, double light)
{
    float embedding[DIM];
    look(place, light, embedding);
    vdna_localise_answer answer;
    OK(vdna_localise_feed(localise, embedding, &answer));
    return answer;
}

/* Drive `frames` frames from a place; return the last answer. */
static vdna_localise_answer drive(vdna_localise *localise, double from, double speed, int frames)
{
    vdna_localise_answer answer;
    for (int t = 0; t < frames; t++)
        answer = fed(localise, from + speed * t, 0.7);
    return answer;
}

static void a_robot_on_the_route_is_found_with_confidence(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    const vdna_localise_answer answer = drive(made(&config), 20, 1, 20);
    assert_near(answer.frame, 39, TOLERANCE);
    assert_int_equal(answer.moving, 1);
    assert_true(answer.confidence > 0.96);
    assert_true(answer.mass > 0.99);
    assert_near(answer.nearest, 39, TOLERANCE);
    assert_int_equal(answer.reserved, 0);
}

static void it_may_drive_backwards_or_at_five_times_the_speed(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    assert_near(drive(made(&config), 100, -2, 20).frame, 62, TOLERANCE);
    assert_near(drive(made(&config), 10, 5, 20).frame, 105, TOLERANCE);
}

static void after_a_kidnapping_it_is_found_again(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    drive(localise, 10, 1, 20);
    assert_true(fed(localise, 90, 0.7).confidence < drive(localise, 91, 1, 12).confidence);
    assert_near(fed(localise, 103, 0.7).frame, 103, TOLERANCE);
}

static void a_picture_of_elsewhere_does_not_carry_it_away(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    drive(localise, 10, 1, 20);
    const vdna_localise_answer answer = fed(localise, 90, 0.7);
    assert_int_equal(answer.nearest, 90);
    assert_near(answer.frame, 30, TOLERANCE + 2);
}

/* Leave the route for pictures of anything, and return. */
static void off_the_route_it_is_not_confident(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    uint32_t random = 1;
    for (int t = 0; t < 120; t++) {
        const int is_off = t >= 30 && t < 90;
        float frame[DIM];
        look(10 + t % 60, 1, frame);
        for (int k = 0; is_off && k < DIM; k++)
            frame[k] = (float)((random = random * 1664525u + 1013904223u) >> 8) * 0x1p-23f - 1;
        OK(vdna_localise_feed(localise, frame, &answer));
        if (is_off)
            assert_true(answer.confidence < 0.96);
        if (t == 29 || t == 119)
            assert_true(answer.confidence > 0.96);
    }
}

static void at_the_end_of_the_map_it_waits_there(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    drive(localise, MAP - 20, 1, 20);
    for (int t = 0; t < 30; t++)
        assert_near(fed(localise, MAP - 1 + 0.3 * (t % 2), 0.7).frame, MAP - 1, TOLERANCE);
}

static void standing_still_says_nothing_new(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    const vdna_localise_answer moved = drive(localise, 20, 1, 20);
    double before[MAP], after[MAP];
    vdna_localise_posterior(localise, before);
    const double evidence = vdna_localise_evidence(localise);
    for (int t = 0; t < 50; t++) {
        const vdna_localise_answer stood = fed(localise, 39.01, 0.7);
        assert_int_equal(stood.moving, 0);
        assert_int_equal(stood.frame, moved.frame);
        assert_true(stood.confidence == moved.confidence && stood.mass == moved.mass);
        assert_near(stood.nearest, 39, 1);
    }
    vdna_localise_posterior(localise, after);
    assert_memory_equal(before, after, sizeof before);
    assert_true(vdna_localise_evidence(localise) == evidence);
}

static void a_robot_that_is_carried_once_jumps_once(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    for (int t = 0; t < 30; t++)
        fed(localise, 60 + t, 1);
    assert_int_equal(vdna_localise_jumps(localise), 0);
    for (int t = 0; t < 20; t++)
        fed(localise, 5 + t, 1);
    assert_int_equal(vdna_localise_jumps(localise), 1);
    /* Later than 64 steps it is forgotten. */
    for (int t = 0; t < 64; t++)
        fed(localise, 25 + t, 1);
    assert_int_equal(vdna_localise_jumps(localise), 0);
}

static void a_robot_without_a_track_jumps_again_and_again(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    for (int t = 0; t < 10; t++)
        fed(localise, t % 2 ? 5 + t : MAP - 5 - t, 0.7);
    assert_int_equal(vdna_localise_jumps(localise), 0); /* still looking for its place */
    for (int t = 0; t < 64; t++)
        fed(localise, t / 8 * 47 % (MAP - 8) + t % 8, 0.7);
    assert_true(vdna_localise_jumps(localise) >= VDNA_LOCALISE_LOST_JUMPS);
    vdna_localise_reset(localise);
    assert_int_equal(vdna_localise_jumps(localise), 0);
    assert_int_equal(vdna_localise_jumps(NULL), 0);
}

static void a_gate_of_0_counts_all_but_the_very_same_picture(void **state)
{
    (void)state;
    vdna_localise_config config = on_the_route();
    config.gate = 0;
    vdna_localise *localise = made(&config);
    drive(localise, 20, 1, 5);
    assert_int_equal(fed(localise, 24.001, 0.7).moving, 1);
    assert_int_equal(fed(localise, 24.001, 0.7).moving, 0);
}

static void before_the_first_step_nothing_is_known(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    float embedding[DIM];
    look(20, 0.7, embedding);
    OK(vdna_localise_warm_up(localise, embedding));
    vdna_localise_answer answer = fed(localise, 20, 0.7);
    assert_int_equal(answer.moving, 0);
    assert_int_equal(answer.frame, 0);
    assert_true(answer.confidence == 0 && answer.mass == 0);
    double posterior[MAP];
    vdna_localise_posterior(localise, posterior);
    for (int i = 0; i < MAP; i++)
        assert_near(posterior[i], 1 / (double)MAP, 1e-12);
}

static void the_mean_begins_as_the_maps_worth_three_frames(void **state)
{
    (void)state;
    const float embeddings[] = {0, 0, 2, 4}, live[] = {9, 10};
    const vdna_localise_config config = config_of(map_of(embeddings, 2, 2));
    vdna_localise *localise = made(&config);
    assert_true(vdna_localise_mean(localise)[0] == 1 && vdna_localise_mean(localise)[1] == 2);
    OK(vdna_localise_warm_up(localise, live));
    assert_true(vdna_localise_mean(localise)[0] == 3 && vdna_localise_mean(localise)[1] == 4);
}

static void a_mean_worth_nothing_begins_as_the_first_frame(void **state)
{
    (void)state;
    const float embeddings[] = {0, 0, 0.2f, 0.4f}, live[] = {0.9f, 0.7f};
    vdna_localise_config config = config_of(map_of(embeddings, 2, 2));
    config.mean_frames = 0;
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_feed(localise, live, &answer));
    assert_true(vdna_localise_mean(localise)[0] == 0.9f && vdna_localise_mean(localise)[1] == 0.7f);
    /* The frame is the mean itself. */
    assert_true(vdna_localise_distances(localise)[0] == 1 && answer.nearest_distance == 1);
    assert_int_equal(answer.nearest, 0);
}

static void the_mean_remembers_so_many_frames(void **state)
{
    (void)state;
    const float embeddings[] = {0, 2};
    vdna_localise_config config = config_of(map_of(embeddings, 2, 1));
    config.mean_frames_max = 4;
    vdna_localise *localise = made(&config);
    static const float live[] = {5, 10, 14};
    static const double means[] = {2, 4, 6.5}; /* worth 3, then 4 and 4 */
    for (int i = 0; i < 3; i++) {
        OK(vdna_localise_warm_up(localise, &live[i]));
        assert_true(vdna_localise_mean(localise)[0] == means[i]);
    }
}

static void without_centring_directions_are_from_the_origin(void **state)
{
    (void)state;
    const float embeddings[] = {1, 0, 0, 2, -3, 0}, live[] = {7, 0}, next[] = {7, 7};
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = 3;
    map_config.dim = 2;
    map_config.embeddings = embeddings;
    map_config.centred = 0;
    vdna_localise_map *map;
    OK(vdna_localise_map_init(&map_config, map_mem, sizeof map_mem, &map));
    const vdna_localise_config config = config_of(map);
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_warm_up(localise, next));
    OK(vdna_localise_feed(localise, live, &answer));
    const float *distances = vdna_localise_distances(localise);
    assert_true(distances[0] == 0 && distances[1] == 1 && distances[2] == 2);
    assert_true(vdna_localise_mean(localise)[0] == 0);
}

static void distances_are_never_below_0_or_above_2(void **state)
{
    (void)state;
    /* Each of its numbers is rounded away from 0, which makes the direction longer than 1. */
    const float embeddings[2][3] = {{3, 5, 5}, {-3, -5, -5}};
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = 2;
    map_config.dim = 3;
    map_config.centred = 0;
    map_config.embeddings = embeddings[0];
    vdna_localise_map *map = NULL;
    OK(vdna_localise_map_init(&map_config, map_mem, sizeof map_mem, &map));
    const vdna_localise_config config = config_of(map);
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_feed(localise, embeddings[0], &answer));
    assert_true(answer.nearest == 0 && answer.nearest_distance == 0);
    assert_true(vdna_localise_distances(localise)[1] == 2);
}

static void a_reset_forgets_everything(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    const vdna_localise_answer first = drive(localise, 20, 1, 20);
    vdna_localise_reset(localise);
    assert_true(vdna_localise_evidence(localise) == 0);
    assert_true(vdna_localise_distances(localise)[5] == 0);
    const vdna_localise_answer again = drive(localise, 20, 1, 20);
    assert_memory_equal(&first, &again, sizeof first);
    vdna_localise_reset(NULL);
}

/* ---- Degenerate maps ---- */

static void on_a_map_whose_frames_are_alike_nothing_is_seen(void **state)
{
    (void)state;
    float alike[9][DIM], live[DIM];
    for (int i = 0; i < 9; i++)
        look(5, 1, alike[i]);
    vdna_localise_config config = config_of(map_of(alike[0], 9, DIM));
    config.tolerance = 0;
    vdna_localise *localise = made(&config);
    for (int t = 0; t < 20; t++) {
        vdna_localise_answer answer;
        look(t, 0.7, live);
        OK(vdna_localise_feed(localise, live, &answer));
        assert_int_equal(answer.nearest, 0);
        assert_true(answer.nearest_distance == 1);
        assert_true(answer.confidence < 0.5);
    }
    assert_near(vdna_localise_evidence(localise), 0, 1e-12);
}

static void a_map_of_one_frame_always_has_all_of_the_mass(void **state)
{
    (void)state;
    float one[DIM], live[DIM];
    look(5, 1, one);
    const vdna_localise_config config = config_of(map_of(one, 1, DIM));
    vdna_localise *localise = made(&config);
    for (int t = 0; t < 5; t++) {
        vdna_localise_answer answer;
        look(t, 0.7, live);
        OK(vdna_localise_feed(localise, live, &answer));
        assert_int_equal(answer.frame, 0);
        assert_true(answer.mass == 1 - 1e-9);
        assert_true(answer.confidence < 0.1);
    }
}

static void on_a_long_map_that_says_nothing_confidence_has_a_floor(void **state)
{
    (void)state;
    enum { LONG = 5000 };
    static float zeros[LONG];
    static int64_t long_map_mem[LONG], long_mem[8 * LONG];
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = LONG;
    map_config.dim = 1;
    map_config.embeddings = zeros;
    vdna_localise_map *map;
    OK(vdna_localise_map_init(&map_config, long_map_mem, sizeof long_map_mem, &map));
    vdna_localise_config config = config_of(map);
    config.tolerance = 0;
    vdna_localise *localise;
    OK(vdna_localise_init(&config, long_mem, sizeof long_mem, &localise));
    vdna_localise_answer answer;
    OK(vdna_localise_feed_distances(localise, zeros, &answer));
    assert_near(answer.mass, 1 / (double)LONG, 1e-12);
    assert_near(answer.confidence, 1 / (1 + exp(-3.6 + 0.53 * 8)), 1e-12);
}

static void the_least_likelihoods_and_confidences_are_numbers(void **state)
{
    (void)state;
    enum { FEW = 200 };
    static const float embeddings[FEW] = {0};
    float distances[FEW];
    for (int i = 0; i < FEW; i++)
        distances[i] = i != 17;
    vdna_localise_config config = config_of(map_of(embeddings, FEW, 1));
    config.sharpness = 100;
    config.tolerance = 0;
    config.clutter = 1;
    config.confidence[0] = -100;
    config.confidence[1] = 100;
    config.confidence[3] = -100;
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_feed_distances(localise, distances, &answer));
    assert_true(answer.confidence >= 0 && answer.confidence < 1e-200);
    config.clutter = 1e-300;
    localise = made(&config);
    OK(vdna_localise_feed_distances(localise, distances, &answer));
    assert_int_equal(answer.frame, 17);
    assert_true(answer.mass == 1 - 1e-9 && answer.confidence == 1);
}

/* ---- Places ---- */

enum { LOOP = 80 };

/* Both passes of a loop look alike, so neither frame has most of the mass, but the place has. */
static void a_place_passed_twice_is_one_place(void **state)
{
    (void)state;
    static float twice[LOOP][DIM];
    int64_t place[LOOP];
    for (int i = 0; i < LOOP; i++) {
        place[i] = 500 + i % (LOOP / 2);
        look((double)(i % (LOOP / 2)), 1, twice[i]);
    }
    vdna_localise_config config = config_of(map_of(twice[0], LOOP, DIM));
    const double split = drive(made(&config), 0, 1, 30).mass;
    config.place = place;
    const vdna_localise_answer answer = drive(made(&config), 0, 1, 30);
    assert_true(split < 0.7);
    assert_true(answer.mass > 0.95);
    assert_near(answer.frame % (LOOP / 2), 29, TOLERANCE);
}

static void a_frame_without_a_place_is_a_place_of_its_own(void **state)
{
    (void)state;
    const float embeddings[5] = {0}, distances[5] = {0, 0, 2, 2, 2};
    const int64_t place[5] = {INT64_MIN, INT64_MIN, INT64_MIN + 1, INT64_MAX, INT64_MAX - 1};
    vdna_localise_config config = config_of(map_of(embeddings, 5, 1));
    config.place = place;
    config.sharpness = 0;
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_feed_distances(localise, distances, &answer));
    /* All are as likely; only the last two are one place. */
    assert_near(answer.mass, 0.4, 1e-12);
    assert_int_equal(answer.frame, 4);
}

static void without_any_places_all_frames_are_places_of_their_own(void **state)
{
    (void)state;
    const float embeddings[3] = {0}, distances[3] = {1, 0, 1};
    const int64_t place[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
    vdna_localise_config config = config_of(map_of(embeddings, 3, 1));
    config.place = place;
    vdna_localise *localise = made(&config);
    vdna_localise_answer answer;
    OK(vdna_localise_feed_distances(localise, distances, &answer));
    assert_int_equal(answer.frame, 1);
    assert_true(answer.mass < 0.99);
}

static void places_that_are_their_frames_change_nothing(void **state)
{
    (void)state;
    int64_t place[MAP];
    for (int i = 0; i < MAP; i++)
        place[i] = i - 60;
    vdna_localise_config config = on_the_route();
    const vdna_localise_answer without = drive(made(&config), 30, 2, 10);
    config.place = place;
    const vdna_localise_answer with = drive(made(&config), 30, 2, 10);
    assert_memory_equal(&with, &without, sizeof with);
}

/* ---- Properties ---- */

/* Gears that only stay or jump know no neighbours. */
static const vdna_gear staying[] = {{0, 0, {1}}, {0, 0, {1}}};

static void a_permuted_map_gives_permuted_answers(void **state)
{
    (void)state;
    enum { FACTOR = 77 }; /* has no divisor in common with MAP, nor is it near a power of two */
    vdna_localise_config config = on_the_route();
    static float permuted[MAP][DIM];
    int64_t place[MAP], permuted_place[MAP];
    for (int i = 0; i < MAP; i++) {
        place[i] = i / 2;
        permuted_place[i * FACTOR % MAP] = i / 2;
        memcpy(permuted[i * FACTOR % MAP], route[i], sizeof route[i]);
    }
    config.gears = staying;
    config.gear_count = 2;
    config.gate = 0;
    config.tolerance = 1;
    config.place = place;
    vdna_localise *localise = made(&config);
    vdna_localise_map_config map_config;
    vdna_localise_map_config_init(&map_config);
    map_config.frames = MAP;
    map_config.dim = DIM;
    map_config.embeddings = permuted[0];
    static int64_t permuted_mem[WORDS];
    vdna_localise_map *map;
    OK(vdna_localise_map_init(&map_config, permuted_mem, sizeof permuted_mem, &map));
    config.map = map;
    config.place = permuted_place;
    vdna_localise *other;
    OK(vdna_localise_init(&config, other_mem, sizeof other_mem, &other));

    for (int t = 0; t < 30; t++) {
        const vdna_localise_answer a = fed(localise, 40 + 0.3 * t, 0.7),
                                   b = fed(other, 40 + 0.3 * t, 0.7);
        assert_int_equal(b.frame, a.frame * FACTOR % MAP);
        assert_int_equal(b.nearest, a.nearest * FACTOR % MAP);
        assert_near(a.confidence, b.confidence, 1e-9);
        assert_near(a.mass, b.mass, 1e-9);
    }
}

/* Run the same drive on activations times `factor` plus `shift`. */
static void drive_scaled(double factor, double shift, vdna_localise_answer out[20])
{
    static float map[MAP][DIM];
    float live[DIM];
    for (int i = 0; i < MAP; i++) {
        look(i, 1, map[i]);
        for (int k = 0; k < DIM; k++)
            map[i][k] = (float)(factor * map[i][k] + shift * k);
    }
    const vdna_localise_config config = config_of(map_of(map[0], MAP, DIM));
    vdna_localise *localise = made(&config);
    for (int t = 0; t < 20; t++) {
        look(20 + 1.4 * t, 0.7, live);
        for (int k = 0; k < DIM; k++)
            live[k] = (float)(factor * live[k] + shift * k);
        OK(vdna_localise_feed(localise, live, &out[t]));
    }
}

static void the_scale_of_activations_changes_nothing(void **state)
{
    (void)state;
    vdna_localise_answer plain[20], scaled[20];
    drive_scaled(1, 0, plain);
    drive_scaled(0x1p-40, 0, scaled);
    assert_memory_equal(plain, scaled, sizeof plain);
    drive_scaled(-0x1p60, 0, scaled);
    assert_memory_equal(plain, scaled, sizeof plain);

    /* What floats round differently stays small. */
    static const double factors[] = {1000, 3e-7, 0.3}, shifts[] = {0, 0, 7};
    for (int i = 0; i < 3; i++) {
        drive_scaled(factors[i], shifts[i], scaled);
        for (int t = 0; t < 20; t++) {
            assert_int_equal(scaled[t].frame, plain[t].frame);
            assert_near(scaled[t].confidence, plain[t].confidence, 1e-4);
        }
    }
}

static void the_posterior_sums_to_1_after_a_million_steps(void **state)
{
    (void)state;
    enum { FEW = 7 };
    const float embeddings[FEW] = {0};
    const vdna_localise_config config = config_of(map_of(embeddings, FEW, 1));
    vdna_localise *localise = made(&config);
    uint32_t random = 1;
    for (int t = 0; t < 1000000; t++) {
        float distances[FEW];
        for (int i = 0; i < FEW; i++)
            distances[i] = (float)((random = random * 1664525u + 1013904223u) >> 8);
        vdna_localise_answer answer;
        OK(vdna_localise_feed_distances(localise, distances, &answer));
        assert_true(answer.confidence >= 0 && answer.confidence <= 1);
    }
    double posterior[FEW], sum = 0;
    vdna_localise_posterior(localise, posterior);
    for (int i = 0; i < FEW; i++)
        sum += posterior[i];
    assert_near(sum, 1, 1e-12);
}

/* ---- Refusals ---- */

static void a_frame_that_is_not_finite_changes_nothing(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    drive(localise, 20, 1, 5);
    static int64_t before[WORDS];
    memcpy(before, localise_mem, sizeof before);

    float embedding[DIM] = {0};
    vdna_localise_answer answer;
    embedding[DIM - 1] = NAN;
    assert_int_equal(vdna_localise_feed(localise, embedding, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_localise_warm_up(localise, embedding), VDNA_ERR_NONFINITE);
    static float distances[MAP];
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.1e18f, -1.1e18f};
    for (int i = 0; i < 5; i++) {
        distances[MAP - 1] = bad[i];
        assert_int_equal(vdna_localise_feed_distances(localise, distances, &answer),
                         VDNA_ERR_NONFINITE);
    }
    assert_memory_equal(before, localise_mem, sizeof before);
}

static void what_is_not_there_is_refused(void **state)
{
    (void)state;
    const vdna_localise_config config = on_the_route();
    vdna_localise *localise = made(&config);
    const float embedding[DIM] = {0}, distances[MAP] = {0};
    vdna_localise_answer answer;
    assert_int_equal(vdna_localise_warm_up(NULL, embedding), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_warm_up(localise, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed(NULL, embedding, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed(localise, NULL, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed(localise, embedding, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed_distances(NULL, distances, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed_distances(localise, NULL, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_feed_distances(localise, distances, NULL), VDNA_ERR_ARG);

    double posterior = 3;
    vdna_localise_posterior(NULL, &posterior);
    vdna_localise_posterior(localise, NULL);
    assert_true(posterior == 3);
    assert_null(vdna_localise_distances(NULL));
    assert_null(vdna_localise_mean(NULL));
    assert_true(vdna_localise_evidence(NULL) == 0);
}

static void assert_refused(const vdna_localise_config *config)
{
    vdna_localise *localise = NULL;
    assert_int_equal(vdna_localise_mem_size(config), 0);
    assert_int_equal(vdna_localise_init(config, localise_mem, sizeof localise_mem, &localise),
                     VDNA_ERR_ARG);
    assert_null(localise);
}

/* One field at a time. */
#define REFUSE(field, value)             \
    do {                                 \
        vdna_localise_config bad = good; \
        bad.field = (value);             \
        assert_refused(&bad);            \
    } while (0)

static void a_field_that_breaks_its_rule_is_refused(void **state)
{
    (void)state;
    const vdna_localise_config good = on_the_route();
    assert_refused(NULL);
    REFUSE(struct_size, sizeof good - 1);
    REFUSE(map, NULL);
    REFUSE(mean_frames_max, 0);
    REFUSE(mean_frames, 1001);
    REFUSE(gate, -0.1);
    REFUSE(gate, NAN);
    REFUSE(gate, INFINITY);
    REFUSE(sharpness, -1);
    REFUSE(sharpness, 101);
    REFUSE(clutter, 0);
    REFUSE(clutter, 1.1);
    REFUSE(clutter, NAN);
    REFUSE(jump, -0.1);
    REFUSE(jump, 1.1);
    REFUSE(gear_change, 1.1);
    REFUSE(evidence_share, -0.1);
    REFUSE(confidence[0], NAN);
    REFUSE(confidence[1], 101);
    REFUSE(confidence[2], -101);
    REFUSE(confidence[3], INFINITY);
    REFUSE(gear_count, 1);
    REFUSE(gears, staying);
}

static void a_gear_that_breaks_its_rule_is_refused(void **state)
{
    (void)state;
    static const vdna_gear bad[] = {
        {VDNA_GEAR_FIRST_MIN - 1, 0, {1}},
        {VDNA_GEAR_FIRST_MAX + 1, 0, {1}},
        {0, 0, {0.5, 0.4}},
        {0, 0, {0.5, 0.6}},
        {0, 0, {-0.1, 1.1}},
        {0, 0, {NAN, 1}},
    };
    vdna_localise_config config = on_the_route();
    config.gear_count = 1;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        config.gears = &bad[i];
        assert_refused(&config);
    }
    vdna_gear many[VDNA_GEARS_MAX + 1];
    for (size_t i = 0; i <= VDNA_GEARS_MAX; i++)
        many[i] = staying[0];
    config.gears = many;
    config.gear_count = VDNA_GEARS_MAX + 1;
    assert_refused(&config);
    config.gear_count = VDNA_GEARS_MAX;
    assert_non_null(made(&config));
}

static void a_block_that_does_not_do_is_refused(void **state)
{
    (void)state;
    vdna_localise_config config = on_the_route();
    int64_t place[MAP] = {0};
    config.place = place;
    const size_t size = vdna_localise_mem_size(&config);
    vdna_localise *localise = NULL;
    assert_int_equal(vdna_localise_init(&config, localise_mem, size - 1, &localise),
                     VDNA_ERR_NOMEM);
    assert_int_equal(vdna_localise_init(&config, NULL, size, &localise), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_init(&config, (char *)localise_mem + 4, size, &localise),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_init(&config, localise_mem, size, NULL), VDNA_ERR_ARG);
    assert_null(localise);
    assert_true(size < sizeof localise_mem - 16);
    localise_mem[size / sizeof *localise_mem + 1] = 42;
    OK(vdna_localise_init(&config, localise_mem, size, &localise));
    drive(localise, 20, 1, 20);
    assert_int_equal(localise_mem[size / sizeof *localise_mem + 1], 42);
    vdna_localise_config_init(NULL);
}

static void a_map_frame_takes_44_bytes_and_12_more_with_places(void **state)
{
    (void)state;
    static int64_t two_mem[2][64];
    size_t sizes[2], with_places[2];
    for (uint32_t i = 0; i < 2; i++) {
        static const float embeddings[2] = {0};
        static const int64_t place[2] = {0};
        vdna_localise_map_config map_config;
        vdna_localise_map_config_init(&map_config);
        map_config.frames = i + 1;
        map_config.dim = 1;
        map_config.embeddings = embeddings;
        vdna_localise_map *map;
        OK(vdna_localise_map_init(&map_config, two_mem[i], sizeof two_mem[i], &map));
        vdna_localise_config config = config_of(map);
        sizes[i] = vdna_localise_mem_size(&config);
        config.place = place;
        with_places[i] = vdna_localise_mem_size(&config);
    }
    assert_int_equal(sizes[1] - sizes[0], 44);
    assert_int_equal(with_places[1] - with_places[0], 56);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_robot_on_the_route_is_found_with_confidence),
        cmocka_unit_test(it_may_drive_backwards_or_at_five_times_the_speed),
        cmocka_unit_test(after_a_kidnapping_it_is_found_again),
        cmocka_unit_test(a_picture_of_elsewhere_does_not_carry_it_away),
        cmocka_unit_test(off_the_route_it_is_not_confident),
        cmocka_unit_test(at_the_end_of_the_map_it_waits_there),
        cmocka_unit_test(standing_still_says_nothing_new),
        cmocka_unit_test(a_robot_that_is_carried_once_jumps_once),
        cmocka_unit_test(a_robot_without_a_track_jumps_again_and_again),
        cmocka_unit_test(a_gate_of_0_counts_all_but_the_very_same_picture),
        cmocka_unit_test(before_the_first_step_nothing_is_known),
        cmocka_unit_test(the_mean_begins_as_the_maps_worth_three_frames),
        cmocka_unit_test(a_mean_worth_nothing_begins_as_the_first_frame),
        cmocka_unit_test(the_mean_remembers_so_many_frames),
        cmocka_unit_test(without_centring_directions_are_from_the_origin),
        cmocka_unit_test(distances_are_never_below_0_or_above_2),
        cmocka_unit_test(a_reset_forgets_everything),
        cmocka_unit_test(on_a_map_whose_frames_are_alike_nothing_is_seen),
        cmocka_unit_test(a_map_of_one_frame_always_has_all_of_the_mass),
        cmocka_unit_test(on_a_long_map_that_says_nothing_confidence_has_a_floor),
        cmocka_unit_test(the_least_likelihoods_and_confidences_are_numbers),
        cmocka_unit_test(a_place_passed_twice_is_one_place),
        cmocka_unit_test(a_frame_without_a_place_is_a_place_of_its_own),
        cmocka_unit_test(without_any_places_all_frames_are_places_of_their_own),
        cmocka_unit_test(places_that_are_their_frames_change_nothing),
        cmocka_unit_test(a_permuted_map_gives_permuted_answers),
        cmocka_unit_test(the_scale_of_activations_changes_nothing),
        cmocka_unit_test(the_posterior_sums_to_1_after_a_million_steps),
        cmocka_unit_test(a_frame_that_is_not_finite_changes_nothing),
        cmocka_unit_test(what_is_not_there_is_refused),
        cmocka_unit_test(a_field_that_breaks_its_rule_is_refused),
        cmocka_unit_test(a_gear_that_breaks_its_rule_is_refused),
        cmocka_unit_test(a_block_that_does_not_do_is_refused),
        cmocka_unit_test(a_map_frame_takes_44_bytes_and_12_more_with_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
