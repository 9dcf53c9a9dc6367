#include <float.h>
#include <math.h>
#include <string.h>

#include <vdna/int8.h>
#include <vdna/knn.h>
#include <vdna/trust.h>

#include "cmocka_all.h"

#define OK(call) assert_int_equal((call), VDNA_OK)
#define REFUSED(call) assert_int_equal((call), VDNA_ERR_ARG)
#define assert_near(found, expected) assert_true(fabs((found) - (expected)) <= 1e-12)

enum { DIM = 3, FRAMES = 30 };

static double scratch[4096];

/* ---- Relative distances ---- */

static double nearest_of(const float *embedding, const float *frames, uint32_t count)
{
    double relative = NAN;
    OK(vdna_trust_nearest(embedding, frames, 2, count, &relative, NULL));
    return relative;
}

static void a_distance_is_relative_to_both_lengths(void **state)
{
    (void)state;
    static const float live[] = {3, 4}, frames[][2] = {{300, 400}, {0, 5}, {6, 8}, {3, -1}};
    uint32_t index;
    double relative;
    OK(vdna_trust_nearest(live, frames[0], 2, 4, &relative, &index));
    assert_int_equal(index, 1);
    assert_near(relative, sqrt(10.0 / 25));
    assert_near(nearest_of(live, frames[2], 1), sqrt(25.0 / 50));
}

static void its_ends_are_0_and_2(void **state)
{
    (void)state;
    static const float live[] = {3, 4}, far[] = {-300, 400}, zero[] = {0, 0};
    assert_true(nearest_of(live, live, 1) == 0);
    assert_true(nearest_of(live, far, 1) == 2);
    assert_true(nearest_of(live, zero, 1) == 2);
    assert_true(nearest_of(zero, zero, 1) == 0);
}

static void a_scale_of_all_numbers_changes_no_bit(void **state)
{
    (void)state;
    static const float live[] = {0.3f, 0.4f}, frames[] = {0.5f, 0.1f};
    static const float live_4[] = {1.2f, 1.6f}, frames_4[] = {2, 0.4f};
    assert_true(nearest_of(live, frames, 1) == nearest_of(live_4, frames_4, 1));
}

static void a_search_refuses_what_knn_refuses(void **state)
{
    (void)state;
    static const float live[] = {1, 2}, bad[] = {1, NAN};
    double relative = 7;
    uint32_t index = 7;
    REFUSED(vdna_trust_nearest(live, live, 2, 1, NULL, &index));
    REFUSED(vdna_trust_nearest(NULL, live, 2, 1, &relative, &index));
    REFUSED(vdna_trust_nearest(live, live, 2, 0, &relative, &index));
    assert_int_equal(vdna_trust_nearest(live, bad, 2, 1, &relative, &index), VDNA_ERR_NONFINITE);
    assert_true(relative == 7 && index == 7);
}

static void the_nearest_in_a_run_is_the_same_with_codes_and_without(void **state)
{
    (void)state;
    static const float live[] = {3, 4}, frames[][2] = {{300, 400}, {0, 5}, {6, 8}, {3, -1}};
    double codes[16], expected, relative = 7;
    uint32_t index = 7;
    OK(vdna_knn_encode(frames[0], 2, 4, codes, sizeof codes));
    OK(vdna_trust_nearest(live, frames[0], 2, 4, &expected, NULL));
    vdna_trust_run run = {.embeddings = frames[0], .frames = 4, .dim = 2};
    REFUSED(vdna_trust_nearest_in(live, NULL, &relative, &index));
    REFUSED(vdna_trust_nearest_in(live, &run, NULL, &index));
    assert_true(relative == 7 && index == 7);
    for (int with_codes = 0; with_codes < 2; with_codes++) {
        run.codes = with_codes ? codes : NULL;
        OK(vdna_trust_nearest_in(live, &run, &relative, &index));
        assert_true(index == 1 && relative == expected);
    }
}

static void codes_are_compared_as_what_they_stand_for(void **state)
{
    (void)state;
    static const int8_t live[] = {3, 4}, frames[] = {-127, 127, 6, 2, 0, 0};
    static const float scales[] = {0.5f, 0.25f, 0};
    double relative = NAN;
    /* (1.5, 2) and (1.5, 0.5) */
    OK(vdna_trust_nearest_int8(live, 0.5f, frames, scales, 2, 3, &relative));
    assert_near(relative, sqrt(2.25 / (2.5 * sqrt(2.5))));
    /* Alike: rounding must not go below 0. */
    OK(vdna_trust_nearest_int8(live, 0.1f, live, (const float[]){0.1f}, 2, 1, &relative));
    assert_near(relative, 0);
    OK(vdna_trust_nearest_int8(live, 0.5f, frames + 4, scales + 2, 2, 1, &relative));
    assert_true(relative == 2);
    OK(vdna_trust_nearest_int8(live, 0, frames, scales, 2, 3, &relative));
    assert_true(relative == 0);
}

static void codes_without_a_scale_or_a_frame_are_refused(void **state)
{
    (void)state;
    static const int8_t codes[] = {1, 2};
    static const float scale[] = {1};
    double relative = 7;
    REFUSED(vdna_trust_nearest_int8(NULL, 1, codes, scale, 2, 1, &relative));
    REFUSED(vdna_trust_nearest_int8(codes, 1, NULL, scale, 2, 1, &relative));
    REFUSED(vdna_trust_nearest_int8(codes, 1, codes, NULL, 2, 1, &relative));
    REFUSED(vdna_trust_nearest_int8(codes, 1, codes, scale, 0, 1, &relative));
    REFUSED(
        vdna_trust_nearest_int8(codes, 1, codes, scale, VDNA_TRUST_CODES_MAX + 1, 1, &relative));
    REFUSED(vdna_trust_nearest_int8(codes, 1, codes, scale, 2, 0, &relative));
    REFUSED(vdna_trust_nearest_int8(codes, 1, codes, scale, 2, 1, NULL));
    static const float bad[] = {INFINITY, -1, NAN};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(vdna_trust_nearest_int8(codes, bad[i], codes, scale, 2, 1, &relative),
                         VDNA_ERR_NONFINITE);
        assert_int_equal(vdna_trust_nearest_int8(codes, 1, codes, &bad[i], 2, 1, &relative),
                         VDNA_ERR_NONFINITE);
    }
    assert_true(relative == 7);
}

static void the_longest_codes_do_not_overflow(void **state)
{
    (void)state;
    static int8_t live[VDNA_TRUST_CODES_MAX], frame[VDNA_TRUST_CODES_MAX];
    memset(live, 127, sizeof live);
    memset(frame, -127, sizeof frame);
    static const float scale[] = {1};
    double relative = NAN;
    OK(vdna_trust_nearest_int8(live, 1, frame, scale, VDNA_TRUST_CODES_MAX, 1, &relative));
    assert_true(relative == 2);
    OK(vdna_trust_nearest_int8(live, 1, live, scale, VDNA_TRUST_CODES_MAX, 1, &relative));
    assert_true(relative == 0);
}

/* ---- Windows ---- */

static void windows_are_a_third_of_a_short_run(void **state)
{
    (void)state;
    static const struct {
        uint32_t frames, windows, length, first[VDNA_TRUST_WINDOWS];
    } trials[] = {
        {1, 1, 1, {0}},
        {2, 2, 1, {0, 1}},
        {5, 5, 1, {0, 1, 2, 3, 4}},
        {9, 7, 3, {0, 1, 2, 3, 4, 5, 6}},
        {48, 7, 16, {0, 5, 11, 16, 21, 27, 32}},
        {1150, 7, 40, {0, 185, 370, 555, 740, 925, 1110}},
        {UINT32_MAX,
         7,
         40,
         {0, 715827876, 1431655752, 2147483628, 2863311503, 3579139379, 4294967255}},
    };
    for (size_t i = 0; i < sizeof trials / sizeof *trials; i++) {
        uint32_t first[VDNA_TRUST_WINDOWS], length;
        assert_int_equal(vdna_trust_windows(trials[i].frames, first, &length), trials[i].windows);
        assert_int_equal(length, trials[i].length);
        assert_memory_equal(first, trials[i].first, trials[i].windows * sizeof *first);
        assert_int_equal(vdna_trust_windows(trials[i].frames, NULL, NULL), trials[i].windows);
    }
    assert_int_equal(vdna_trust_windows(0, NULL, NULL), 0);
}

/* ---- Runs: a route of frames that all differ ---- */

static float route[FRAMES][DIM], other[FRAMES][DIM];
static int64_t places[FRAMES];
static double positions[FRAMES][3];

static vdna_trust_run run_of(float frames[][DIM], double look, uint32_t count)
{
    for (int i = 0; i < FRAMES; i++) {
        places[i] = i;
        for (int k = 0; k < DIM; k++) {
            frames[i][k] = (float)(2 + sin(0.2 * i * (k + 1) + k) + look * k);
            positions[i][k] = k == 0 ? i : 7;
        }
    }
    const vdna_trust_run run = {
        .embeddings = frames[0], .place = places, .frames = count, .dim = DIM};
    return run;
}

static double own_of(const vdna_trust_run *run, double tolerance)
{
    double own = NAN;
    OK(vdna_trust_own_scale(run, tolerance, &own));
    return own;
}

/* The definition, with no search in stretches. */
static double own_by_definition(const vdna_trust_run *run, double tolerance)
{
    double sum = 0;
    int count = 0;
    for (uint32_t f = 0; f < run->frames; f++) {
        double least = INFINITY, relative = NAN;
        for (uint32_t g = 0; g < run->frames; g++) {
            if (run->place[f] == INT64_MIN || run->place[g] == INT64_MIN ||
                fabs((double)(run->place[f] - run->place[g])) <= 2 * tolerance)
                continue;
            double sq = 0, of_f = 0, of_g = 0;
            for (uint32_t k = 0; k < DIM; k++) {
                const double x = run->embeddings[f * DIM + k], y = run->embeddings[g * DIM + k];
                sq += (x - y) * (x - y);
                of_f += x * x;
                of_g += y * y;
            }
            if (sq < least) {
                least = sq;
                relative = fmin(sqrt(sq / sqrt(of_f * of_g)), 2);
            }
        }
        sum += isnan(relative) ? 0 : relative;
        count += !isnan(relative);
    }
    return count ? sum / count : 1;
}

static void own_scales_search_other_places_in_any_order(void **state)
{
    (void)state;
    const vdna_trust_run run = run_of(route, 0, FRAMES);
    assert_near(own_of(&run, 2), own_by_definition(&run, 2));
    for (int i = 0; i < FRAMES; i++)
        places[i] = i * 7 % 11;
    assert_near(own_of(&run, 1), own_by_definition(&run, 1));
    for (int i = 0; i < FRAMES; i += 3)
        places[i] = INT64_MIN;
    assert_near(own_of(&run, 1), own_by_definition(&run, 1));
}

static void a_run_without_other_places_has_own_scale_1(void **state)
{
    (void)state;
    vdna_trust_run run = run_of(route, 0, FRAMES);
    assert_true(own_of(&run, 15) == 1);
    run.place = NULL;
    assert_true(own_of(&run, 0) == 1);
}

static void a_run_of_one_picture_has_the_least_own_scale(void **state)
{
    (void)state;
    const vdna_trust_run run = run_of(route, 0, FRAMES);
    for (int i = 1; i < FRAMES; i++)
        memcpy(route[i], route[0], sizeof route[0]);
    assert_true(own_of(&run, 2) == 1e-6);
}

static void positions_decide_before_places(void **state)
{
    (void)state;
    vdna_trust_run run = run_of(route, 0, FRAMES);
    const double by_place = own_of(&run, 2);
    run.position = positions[0];
    assert_true(own_of(&run, 2) == by_place);
    memset(places, 0, sizeof places);
    assert_true(own_of(&run, 2) == by_place);
    for (int i = 0; i < FRAMES; i++)
        positions[i][2] = NAN;
    assert_true(own_of(&run, 2) == 1);
}

static void own_scales_refuse_bad_runs(void **state)
{
    (void)state;
    const vdna_trust_run good = run_of(route, 0, FRAMES);
    vdna_trust_run run = good;
    double own = 7;
    REFUSED(vdna_trust_own_scale(NULL, 2, &own));
    REFUSED(vdna_trust_own_scale(&good, 2, NULL));
    REFUSED(vdna_trust_own_scale(&good, -1, &own));
    REFUSED(vdna_trust_own_scale(&good, NAN, &own));
    REFUSED(vdna_trust_own_scale(&good, INFINITY, &own));
    run.embeddings = NULL;
    REFUSED(vdna_trust_own_scale(&run, 2, &own));
    run = good;
    run.frames = 0;
    REFUSED(vdna_trust_own_scale(&run, 2, &own));
    run = good;
    run.dim = 0;
    REFUSED(vdna_trust_own_scale(&run, 2, &own));
    run.dim = UINT32_MAX;
    REFUSED(vdna_trust_own_scale(&run, 2, &own));
    run = good;
    run.last_layer_dim = VDNA_TRUST_CODES_MAX + 1;
    REFUSED(vdna_trust_own_scale(&run, 2, &own));
    route[9][1] = NAN;
    assert_int_equal(vdna_trust_own_scale(&good, 2, &own), VDNA_ERR_NONFINITE);
    assert_true(own == 7);
}

/* ---- Cells ---- */

static vdna_trust_cell cell_of(const vdna_trust_run *live, const vdna_trust_run *candidate,
                               uint32_t localiser)
{
    static double relative[FRAMES];
    vdna_trust_cell cell;
    OK(vdna_trust_pair(live, candidate, 1, localiser, scratch, sizeof scratch, relative, &cell));
    return cell;
}

static void a_shift_of_all_frames_is_nothing_about_the_means_alone(void **state)
{
    (void)state;
    const vdna_trust_run live = run_of(other, 0.7, FRAMES), map = run_of(route, 0, FRAMES);
    const vdna_trust_cell centred = cell_of(&live, &map, VDNA_TRUST_CENTRED);
    const vdna_trust_cell plain = cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN);
    assert_true(centred.recall[0] == 1 && plain.recall[0] < 0.6);
    assert_memory_equal(centred.nearest, plain.nearest, sizeof plain.nearest);
}

static void a_run_of_five_frames_has_five_windows(void **state)
{
    (void)state;
    const vdna_trust_run live = run_of(other, 0, 5), map = run_of(route, 0, FRAMES);
    const vdna_trust_cell cell = cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN);
    for (int i = 0; i < 5; i++)
        assert_true(cell.nearest[i] == 0 && cell.recall[i] == 1);
    assert_true(isnan(cell.nearest[5]) && isnan(cell.recall[5]) && isnan(cell.distance[0]));
}

static void of_a_run_of_one_frame_no_recall_is_known(void **state)
{
    (void)state;
    const vdna_trust_run live = run_of(other, 0, 1), map = run_of(route, 0, FRAMES);
    const vdna_trust_cell cell = cell_of(&live, &map, VDNA_TRUST_CENTRED);
    assert_true(cell.nearest[0] == 0 && isnan(cell.recall[0]));
    /* As a candidate, its only frame is always the nearest: right from places 0 and 1 only. */
    assert_near(cell_of(&map, &live, VDNA_TRUST_CENTRED).recall[6], 2.0 / 20);
}

static void frames_without_labels_do_not_count(void **state)
{
    (void)state;
    vdna_trust_run live = run_of(other, 0, 9);
    const vdna_trust_run map = run_of(route, 0, FRAMES);
    static int64_t labels[9] = {0, INT64_MIN, 99, 3, 4, INT64_MIN, 6, 7, 8};
    live.place = labels; /* windows of 3 frames; one label is wrong */
    const vdna_trust_cell cell = cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN);
    assert_near(cell.recall[0], 1);
    assert_near(cell.recall[3], 4.0 / 5);
    assert_near(cell.recall[6], 3.0 / 4);
    live.place = NULL;
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN).recall[0]));
}

static void of_a_map_with_some_labels_those_frames_count_that_meet_one(void **state)
{
    (void)state;
    const vdna_trust_run live = run_of(other, 0, 9);
    vdna_trust_run map = run_of(route, 0, FRAMES);
    static int64_t labels[FRAMES] = {INT64_MIN, 1, 2, 9, 4, 5, 6, 7, 8};
    map.place = labels;
    assert_near(cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN).recall[6], 4.0 / 5);
}

static void places_and_positions_do_not_compare(void **state)
{
    (void)state;
    vdna_trust_run live = run_of(other, 0, 9), map = run_of(route, 0, FRAMES);
    live.place = NULL;
    live.position = positions[0];
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN).recall[0]));
    map.position = positions[0];
    assert_true(cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN).recall[0] == 1);
    map.place = live.place = NULL;
    map.position = NULL;
    live.position = NULL;
    live.place = places;
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_EUCLIDEAN).recall[0]));
}

static void a_frame_at_the_mean_is_alike_to_none(void **state)
{
    (void)state;
    /* About the mean (0, 0, 0): the first row has no direction, and is at a right angle to all. The
     * live frames are a little nearer than that to a row. */
    static const float map_frames[][DIM] = {{0, 0, 0}, {1, 1, 0}, {-1, -1, 0}};
    static const float live_frames[][DIM] = {{0.3f, 0, 1}, {-0.3f, 0, -1}, {0, 0, 0}};
    static const int64_t map_places[] = {50, 1, 2}, live_places[] = {1, 2, 50};
    const vdna_trust_run map = {
        .embeddings = map_frames[0], .place = map_places, .frames = 3, .dim = DIM};
    const vdna_trust_run live = {
        .embeddings = live_frames[0], .place = live_places, .frames = 3, .dim = DIM};
    assert_true(cell_of(&live, &map, VDNA_TRUST_CENTRED).recall[0] == 1);
}

static void likeness_needs_the_last_layer_of_both(void **state)
{
    (void)state;
    enum { CODES = 2 };
    static int8_t live_codes[9 * CODES], map_codes[FRAMES * CODES];
    static float live_scales[9], map_scales[FRAMES];
    vdna_trust_run live = run_of(other, 0, 9), map = run_of(route, 0, FRAMES);
    for (int i = 0; i < FRAMES; i++) {
        const float row[] = {(float)i, 40};
        OK(vdna_int8_encode(row, CODES, map_codes + CODES * i, &map_scales[i]));
        if (i < 9)
            OK(vdna_int8_encode(row, CODES, live_codes + CODES * i, &live_scales[i]));
    }
    map.last_layer = map_codes;
    map.last_layer_scale = map_scales;
    map.last_layer_dim = CODES;
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_CENTRED).likeness[0]));
    live.last_layer = live_codes;
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_CENTRED).likeness[0]));
    live.last_layer_scale = live_scales;
    assert_true(isnan(cell_of(&live, &map, VDNA_TRUST_CENTRED).likeness[0]));
    live.last_layer_dim = CODES;
    assert_near(cell_of(&live, &map, VDNA_TRUST_CENTRED).likeness[6], 0);
    assert_true(
        isnan(cell_of(&map, &(vdna_trust_run){.embeddings = route[0], .frames = 9, .dim = DIM},
                      VDNA_TRUST_CENTRED)
                  .likeness[0]));

    double relative[FRAMES];
    vdna_trust_cell cell;
    live.last_layer_dim = 1;
    assert_int_equal(vdna_trust_pair(&live, &map, 1, 0, scratch, sizeof scratch, relative, &cell),
                     VDNA_ERR_MISMATCH);
    live.last_layer_dim = CODES;
    live_scales[4] = NAN;
    assert_int_equal(vdna_trust_pair(&live, &map, 1, 0, scratch, sizeof scratch, relative, &cell),
                     VDNA_ERR_NONFINITE);
}

static void a_pair_refuses_bad_arguments(void **state)
{
    (void)state;
    const vdna_trust_run live = run_of(other, 0, 9), map = run_of(route, 0, FRAMES);
    vdna_trust_run bad = map;
    double r[FRAMES];
    vdna_trust_cell cell;
    const size_t size = vdna_trust_pair_scratch_size(&live, &map);
    assert_true(size > 0 && size <= sizeof scratch);
    OK(vdna_trust_pair(&live, &map, 1, 0, scratch, size, r, &cell));
    assert_int_equal(vdna_trust_pair(&live, &map, 1, 0, scratch, size - 1, r, &cell),
                     VDNA_ERR_NOMEM);
    REFUSED(vdna_trust_pair(NULL, &map, 1, 0, scratch, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, NULL, 1, 0, scratch, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, &map, -1, 0, scratch, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, &map, 1, 2, scratch, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, &map, 1, 0, NULL, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, &map, 1, 0, (char *)scratch + 4, size, r, &cell));
    REFUSED(vdna_trust_pair(&live, &map, 1, 0, scratch, size, NULL, &cell));
    REFUSED(vdna_trust_pair(&live, &map, 1, 0, scratch, size, r, NULL));
    bad.embeddings = NULL;
    REFUSED(vdna_trust_pair(&live, &bad, 1, 0, scratch, size, r, &cell));
    REFUSED(vdna_trust_pair(&bad, &map, 1, 0, scratch, sizeof scratch, r, &cell));
    bad = map;
    bad.dim = DIM - 1;
    assert_int_equal(vdna_trust_pair(&live, &bad, 1, 0, scratch, size, r, &cell),
                     VDNA_ERR_MISMATCH);
    other[8][0] = INFINITY;
    assert_int_equal(vdna_trust_pair(&live, &map, 1, 0, scratch, size, r, &cell),
                     VDNA_ERR_NONFINITE);
}

static void a_pair_beyond_any_memory_has_no_size(void **state)
{
    (void)state;
    const vdna_trust_run huge = {.frames = UINT32_MAX, .dim = UINT32_MAX - 1};
    assert_int_equal(vdna_trust_pair_scratch_size(&huge, &huge), 0);
    assert_int_equal(vdna_trust_pair_scratch_size(NULL, &huge), 0);
}

/* ---- Correlation times ---- */

static void alternating_blocks_are_correlated_and_alternating_frames_are_not(void **state)
{
    (void)state;
    enum { LONG = 64 };
    double rows[3][LONG], pairs[3], tau = NAN;
    for (int t = 0; t < LONG; t++) {
        rows[0][t] = 1;
        rows[1][t] = 1 + (t / 8 % 2 ? 0.1 : -0.1);
        rows[2][t] = 1 + (t % 2 ? 0.1 : -0.1);
    }
    /* Blocks of 8: their means vary as the frames do, but for the unbiased counts. */
    OK(vdna_trust_correlation_time(rows[0], 2, LONG, pairs, &tau));
    assert_near(tau, 8 * (8.0 / 7) / (64.0 / 63));
    OK(vdna_trust_correlation_time(rows[0], 3, LONG, pairs, &tau)); /* 9, 4.5 and about 0 */
    assert_near(tau, 4 * (8.0 / 7) / (64.0 / 63));
    memcpy(rows[1], rows[2], sizeof rows[1]);
    OK(vdna_trust_correlation_time(rows[0], 2, LONG, pairs, &tau));
    assert_near(tau, 0);
}

static void what_cannot_be_told_is_nan(void **state)
{
    (void)state;
    static double rows[2 * FRAMES], pairs[1], tau;
    for (int i = 0; i < 2 * FRAMES; i++)
        rows[i] = 1 + sin(i);
    OK(vdna_trust_correlation_time(rows, 0, FRAMES, pairs, &tau));
    assert_true(isnan(tau));
    OK(vdna_trust_correlation_time(rows, 1, FRAMES, pairs, &tau));
    assert_true(isnan(tau));
    OK(vdna_trust_correlation_time(rows, 2, 15, pairs, &tau));
    assert_true(isnan(tau));
    OK(vdna_trust_correlation_time(rows, 2, 16, pairs, &tau));
    assert_true(tau > 0);
    memcpy(rows + FRAMES, rows, FRAMES * sizeof *rows);
    OK(vdna_trust_correlation_time(rows, 2, FRAMES, pairs, &tau));
    assert_true(isnan(tau));
    memset(rows, 0, sizeof rows);
    OK(vdna_trust_correlation_time(rows, 2, FRAMES, pairs, &tau));
    assert_true(isnan(tau));
}

static void a_correlation_time_refuses_bad_arguments(void **state)
{
    (void)state;
    double row = 1, tau;
    REFUSED(vdna_trust_correlation_time(NULL, 1, 1, &row, &tau));
    REFUSED(vdna_trust_correlation_time(&row, VDNA_TRUST_RUNS_MAX + 1, 1, &row, &tau));
    REFUSED(vdna_trust_correlation_time(&row, 1, 1, NULL, &tau));
    REFUSED(vdna_trust_correlation_time(&row, 1, 1, &row, NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_distance_is_relative_to_both_lengths),
        cmocka_unit_test(its_ends_are_0_and_2),
        cmocka_unit_test(a_scale_of_all_numbers_changes_no_bit),
        cmocka_unit_test(a_search_refuses_what_knn_refuses),
        cmocka_unit_test(the_nearest_in_a_run_is_the_same_with_codes_and_without),
        cmocka_unit_test(codes_are_compared_as_what_they_stand_for),
        cmocka_unit_test(codes_without_a_scale_or_a_frame_are_refused),
        cmocka_unit_test(the_longest_codes_do_not_overflow),
        cmocka_unit_test(windows_are_a_third_of_a_short_run),
        cmocka_unit_test(own_scales_search_other_places_in_any_order),
        cmocka_unit_test(a_run_without_other_places_has_own_scale_1),
        cmocka_unit_test(a_run_of_one_picture_has_the_least_own_scale),
        cmocka_unit_test(positions_decide_before_places),
        cmocka_unit_test(own_scales_refuse_bad_runs),
        cmocka_unit_test(a_shift_of_all_frames_is_nothing_about_the_means_alone),
        cmocka_unit_test(a_run_of_five_frames_has_five_windows),
        cmocka_unit_test(of_a_run_of_one_frame_no_recall_is_known),
        cmocka_unit_test(frames_without_labels_do_not_count),
        cmocka_unit_test(of_a_map_with_some_labels_those_frames_count_that_meet_one),
        cmocka_unit_test(places_and_positions_do_not_compare),
        cmocka_unit_test(a_frame_at_the_mean_is_alike_to_none),
        cmocka_unit_test(likeness_needs_the_last_layer_of_both),
        cmocka_unit_test(a_pair_refuses_bad_arguments),
        cmocka_unit_test(a_pair_beyond_any_memory_has_no_size),
        cmocka_unit_test(alternating_blocks_are_correlated_and_alternating_frames_are_not),
        cmocka_unit_test(what_cannot_be_told_is_nan),
        cmocka_unit_test(a_correlation_time_refuses_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
