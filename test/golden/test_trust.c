#include <math.h>
#include <string.h>

#include <vdna/int8.h>
#include <vdna/trust.h>

#include "cmocka_all.h"
#include "trust_golden.h"

/* Sums in another order. */
#define TOLERATED 1e-9

#define OK(call) assert_int_equal((call), VDNA_OK)
#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { RUNS_MOST = 6, WORDS = 512 };

static int64_t mem[WORDS];

static void assert_near(double found, double expected)
{
    if (isnan(found) && isnan(expected))
        return;
    if (!(fabs(found - expected) <= TOLERATED))
        fail_msg("%.17g is not %.17g", found, expected);
}

static void assert_all_near(const double *found, const double *expected, size_t count)
{
    for (size_t i = 0; i < count; i++)
        assert_near(found[i], expected[i]);
}

static vdna_trust *made(uint32_t runs, const uint32_t *frames, const double *own,
                        const double *correlation, const double *cells, uint32_t localiser,
                        double min_recall, double switch_cost)
{
    static vdna_trust_cell table[RUNS_MOST * RUNS_MOST];
    memcpy(table, cells, runs * runs * sizeof *table);
    const vdna_trust_tables tables = {frames, own, correlation, table};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = runs;
    config.tables = &tables;
    config.localiser = localiser;
    config.min_recall = min_recall;
    config.switch_cost = switch_cost;
    vdna_trust *trust = NULL;
    OK(vdna_trust_init(&config, mem, sizeof mem, &trust));
    return trust;
}

/* The map of golden numbers of a name. */
#define MADE(name, localiser, min_recall, switch_cost)                            \
    made(COUNT(golden_##name##_own), golden_##name##_frames, golden_##name##_own, \
         golden_##name##_correlation, golden_##name##_cells, localiser, min_recall, switch_cost)

static void feed_rows(vdna_trust *trust, const double *rows, size_t frames, size_t runs, double by)
{
    for (size_t f = 0; f < frames; f++) {
        double row[RUNS_MOST];
        for (size_t b = 0; b < runs; b++)
            row[b] = by * rows[f * runs + b];
        OK(vdna_trust_feed(trust, row, NULL));
    }
}

#define FEED(trust, name)                                               \
    feed_rows(trust, golden_##name##_live,                              \
              COUNT(golden_##name##_live) / COUNT(golden_##name##_own), \
              COUNT(golden_##name##_own), 1)

static void assert_fit(const vdna_trust *trust, const double *slope_sd_best_quantile,
                       const double *intercepts, size_t runs, double skill)
{
    const vdna_trust_fit *fit = vdna_trust_fitted(trust);
    const double found[] = {fit->slope, fit->sd, fit->sd_best, fit->quantile};
    assert_all_near(found, slope_sd_best_quantile, COUNT(found));
    assert_all_near(vdna_trust_intercepts(trust), intercepts, runs);
    assert_near(fit->skill, skill);
    assert_int_equal(fit->labelled, runs);
    assert_int_equal(fit->by_likeness, 0);
}

static void assert_predictions(const vdna_trust_prediction *found, size_t runs,
                               const double *recall, const double *low, const double *high)
{
    for (size_t b = 0; b < runs; b++) {
        assert_int_equal(found[b].reason, VDNA_TRUST_REASON_NONE);
        assert_near(found[b].recall, recall[b]);
        assert_near(found[b].low, low[b]);
        assert_near(found[b].high, high[b]);
    }
}

static void predictions_of_the_grid_localiser_are_those_of_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(centred, VDNA_TRUST_CENTRED, 0, 5);
    assert_fit(trust, golden_centred_fit, golden_centred_c, 4, golden_centred_skill[0]);
    FEED(trust, centred);
    vdna_trust_prediction found[4];
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, golden_centred_distances, found, &answer));
    assert_predictions(found, 4, golden_centred_recall, golden_centred_low, golden_centred_high);
    for (size_t b = 0; b < 4; b++)
        assert_near(found[b].transfer, golden_centred_transfer[b]);
}

static void predictions_of_six_runs_of_various_lengths_are_those_of_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(six, VDNA_TRUST_CENTRED, 0, 5);
    assert_fit(trust, golden_six_fit, golden_six_c, 6, golden_six_skill[0]);
    FEED(trust, six);
    vdna_trust_prediction found[6];
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, golden_six_distances, found, &answer));
    assert_predictions(found, 6, golden_six_recall, golden_six_low, golden_six_high);
    for (size_t b = 0; b < 6; b++)
        assert_near(found[b].transfer, golden_six_transfer[b]);
}

static void assert_euclidean(vdna_trust *trust, size_t runs, const double *nearest, double unlike,
                             double far, double tau, uint32_t settled,
                             const vdna_trust_prediction *found, const vdna_trust_answer *answer)
{
    for (size_t b = 0; b < runs; b++)
        assert_near(found[b].nearest, nearest[b]);
    assert_near(answer->unlike, unlike);
    assert_near(vdna_trust_fitted(trust)->far, far);
    assert_near(vdna_trust_fitted(trust)->correlation, tau);
    assert_int_equal(answer->settled_frames, settled);
    assert_int_equal(vdna_trust_settled_frames(trust), settled);
}

static void predictions_of_the_papers_localiser_are_those_of_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 5);
    assert_fit(trust, golden_euclidean_fit, golden_euclidean_c, 3, golden_euclidean_skill[0]);
    FEED(trust, euclidean);
    vdna_trust_prediction found[3];
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, NULL, found, &answer));
    assert_predictions(found, 3, golden_euclidean_recall, golden_euclidean_low,
                       golden_euclidean_high);
    assert_euclidean(trust, 3, golden_euclidean_nearest, golden_euclidean_unlike[0],
                     golden_euclidean_far[0], golden_euclidean_tau[0], golden_euclidean_settled[0],
                     found, &answer);
}

static void of_six_runs_they_are_so_too(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(six_euclidean, VDNA_TRUST_EUCLIDEAN, 0, 5);
    assert_fit(trust, golden_six_euclidean_fit, golden_six_euclidean_c, 6,
               golden_six_euclidean_skill[0]);
    FEED(trust, six_euclidean);
    vdna_trust_prediction found[6];
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, NULL, found, &answer));
    assert_predictions(found, 6, golden_six_euclidean_recall, golden_six_euclidean_low,
                       golden_six_euclidean_high);
    assert_euclidean(trust, 6, golden_six_euclidean_nearest, golden_six_euclidean_unlike[0],
                     golden_six_euclidean_far[0], golden_six_euclidean_tau[0],
                     golden_six_euclidean_settled[0], found, &answer);
}

static void far_frames_are_unlike_and_those_between_poor(void **state)
{
    (void)state;
    static const struct {
        double by;
        uint32_t verdict;
    } trials[] = {{2.5, VDNA_TRUST_UNLIKE}, {1, VDNA_TRUST_POOR}, {0.5, VDNA_TRUST_FITS}};
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0.95, 5);
    for (size_t i = 0; i < COUNT(trials); i++) {
        vdna_trust_reset(trust);
        feed_rows(trust, golden_euclidean_live, 20, 3, trials[i].by);
        vdna_trust_prediction found[3];
        vdna_trust_answer answer;
        OK(vdna_trust_predict(trust, NULL, found, &answer));
        assert_int_equal(answer.verdict, trials[i].verdict);
    }
}

static void a_clear_choice_settles_where_it_does_in_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 5);
    feed_rows(trust, golden_clear_live, 20, 3, 1);
    assert_int_equal(vdna_trust_settled_frames(trust), 10);
}

static void noise_delays_settling_as_in_the_reference(void **state)
{
    (void)state;
    static const double base[] = {0.2, 0.22, 0.25};
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 5);
    for (size_t level = 0; level < COUNT(golden_settling); level++) {
        vdna_trust_reset(trust);
        for (size_t t = 0; t < COUNT(golden_settling_noise) / 3; t++) {
            double nearest[3];
            for (size_t b = 0; b < 3; b++)
                nearest[b] =
                    base[b] * (1 + 0.02 * (double)level * golden_settling_noise[3 * t + b]);
            OK(vdna_trust_feed(trust, nearest, NULL));
        }
        assert_int_equal(vdna_trust_settled_frames(trust), golden_settling[level]);
    }
}

static void a_change_of_looks_switches_where_it_does_in_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 3);
    OK(vdna_trust_choose(trust, 2));
    for (size_t t = 0; t < COUNT(golden_drive_choice); t++) {
        double expected[3];
        uint32_t choice = 99;
        OK(vdna_trust_expect(trust, golden_drive_live + 3 * t, expected));
        assert_all_near(expected, golden_drive_expected + 3 * t, 3);
        OK(vdna_trust_reconsider(trust, expected, 1, &choice));
        assert_int_equal(choice, golden_drive_choice[t]);
    }
}

static void returns_cost_as_in_the_reference(void **state)
{
    (void)state;
    vdna_trust *trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 1);
    uint32_t choice;
    OK(vdna_trust_choose(trust, 1));
    for (size_t t = 0; t < COUNT(golden_flicker_choice); t++) {
        OK(vdna_trust_reconsider(trust, golden_flicker + 3 * t, 1, &choice));
        assert_int_equal(choice, golden_flicker_choice[t]);
    }
    trust = MADE(euclidean, VDNA_TRUST_EUCLIDEAN, 0, 2);
    OK(vdna_trust_choose(trust, 1));
    for (size_t t = 0; t < COUNT(golden_flicker_strided); t++) {
        OK(vdna_trust_reconsider(trust, golden_flicker + 3 * 3 * t, 3, &choice));
        assert_int_equal(choice, golden_flicker_strided[t]);
    }
}

static void the_transfer_of_two_and_three_is_that_of_the_reference(void **state)
{
    (void)state;
    const uint32_t one_window[] = {1, 1, 1};
    const double own[] = {1, 1, 1}, correlation[] = {NAN, NAN, NAN};
    for (uint32_t runs = 2; runs <= 3; runs++) {
        vdna_trust_cell cells[9];
        for (uint32_t i = 0; i < runs * runs; i++) {
            const size_t at = 3 * (i / runs) + i % runs;
            const vdna_trust_cell cell = {
                {0.5}, {0.5}, {golden_transfer_recall[at]}, {golden_transfer_distance[at]}};
            cells[i] = cell;
        }
        vdna_trust *trust = made(runs, one_window, own, correlation, (const double *)cells,
                                 VDNA_TRUST_CENTRED, 0, 5);
        vdna_trust_prediction found[3];
        vdna_trust_answer answer;
        OK(vdna_trust_predict(trust, golden_transfer_live, found, &answer));
        for (uint32_t b = 0; b < runs; b++)
            assert_near(found[b].transfer,
                        runs == 2 ? golden_transfer_of_two[b] : golden_transfer_of_three[b]);
    }
}

/* ---- The tables of runs ---- */

enum { RUNS = 3, DIM = 8, FRAMES_MOST = 40 };

static const float *const embeddings[] = {golden_run0, golden_run1, golden_run2};
static const uint32_t lengths[] = {COUNT(golden_run0) / DIM, COUNT(golden_run1) / DIM,
                                   COUNT(golden_run2) / DIM};

/* The runs, labelled with places, or with positions of 5 m from place to place. */
static void make_runs(vdna_trust_run runs[RUNS], int in_metres)
{
    static int64_t places[COUNT(golden_run_places)];
    static double positions[COUNT(golden_run_places)][3];
    for (size_t i = 0; i < COUNT(golden_run_places); i++) {
        places[i] = golden_run_places[i];
        positions[i][0] = 3.0 * golden_run_places[i];
        positions[i][1] = 4.0 * golden_run_places[i];
    }
    size_t begin = 0;
    for (size_t r = 0; r < RUNS; begin += lengths[r++]) {
        memset(&runs[r], 0, sizeof runs[r]);
        runs[r].embeddings = embeddings[r];
        runs[r].place = places + begin;
        runs[r].position = in_metres ? positions[begin] : NULL;
        runs[r].frames = lengths[r];
        runs[r].dim = DIM;
    }
}

static void own_scales_are_those_of_the_reference(void **state)
{
    (void)state;
    vdna_trust_run runs[RUNS];
    for (size_t r = 0; r < RUNS; r++) {
        double own = NAN;
        make_runs(runs, 0);
        OK(vdna_trust_own_scale(&runs[r], 2, &own));
        assert_near(own, golden_run_own[r]);
        make_runs(runs, 1);
        OK(vdna_trust_own_scale(&runs[r], 7, &own));
        assert_near(own, golden_run_own_metres[r]);
    }
}

static void assert_cell(const vdna_trust_cell *found, const double *expected)
{
    assert_all_near(found->nearest, expected, VDNA_TRUST_WINDOWS);
    assert_all_near(found->recall, expected + 2 * VDNA_TRUST_WINDOWS, VDNA_TRUST_WINDOWS);
    for (size_t i = 0; i < VDNA_TRUST_WINDOWS; i++)
        assert_true(isnan(found->likeness[i]) && isnan(found->distance[i]));
}

static void cells_and_correlation_times_are_those_of_the_reference(void **state)
{
    (void)state;
    vdna_trust_run runs[RUNS];
    double relative[RUNS * FRAMES_MOST], scratch[1024], tau;
    for (size_t a = 0; a < RUNS; a++) {
        size_t others = 0;
        for (size_t b = 0; b < RUNS; b++) {
            if (a == b)
                continue;
            vdna_trust_cell cell;
            double *const row = relative + others++ * lengths[a];
            const size_t at = (a * RUNS + b) * 4 * VDNA_TRUST_WINDOWS;
            make_runs(runs, 1); /* 10 m are two places */
            OK(vdna_trust_pair(&runs[a], &runs[b], 10, VDNA_TRUST_EUCLIDEAN, scratch,
                               sizeof scratch, row, &cell));
            assert_cell(&cell, golden_run_cells_euclidean + at);
            make_runs(runs, 0);
            OK(vdna_trust_pair(&runs[a], &runs[b], 2, VDNA_TRUST_CENTRED, scratch, sizeof scratch,
                               row, &cell));
            assert_cell(&cell, golden_run_cells + at);
        }
        OK(vdna_trust_correlation_time(relative, RUNS - 1, lengths[a], scratch, &tau));
        assert_near(tau, golden_run_correlation[a]);
    }
}

static void likeness_on_codes_is_that_of_the_reference_on_what_they_stand_for(void **state)
{
    (void)state;
    int8_t codes[RUNS][FRAMES_MOST * DIM];
    float scales[RUNS][FRAMES_MOST];
    for (size_t r = 0; r < RUNS; r++)
        for (size_t f = 0; f < lengths[r]; f++)
            OK(vdna_int8_encode(embeddings[r] + f * DIM, DIM, codes[r] + f * DIM, &scales[r][f]));
    for (size_t r = 1; r < RUNS; r++) {
        double sum = 0;
        for (size_t f = 0; f < lengths[0]; f++) {
            double relative;
            OK(vdna_trust_nearest_int8(codes[0] + f * DIM, scales[0][f], codes[r], scales[r], DIM,
                                       lengths[r], &relative));
            sum += relative;
        }
        assert_near(sum / lengths[0], golden_run_likeness[r - 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(predictions_of_the_grid_localiser_are_those_of_the_reference),
        cmocka_unit_test(predictions_of_six_runs_of_various_lengths_are_those_of_the_reference),
        cmocka_unit_test(predictions_of_the_papers_localiser_are_those_of_the_reference),
        cmocka_unit_test(of_six_runs_they_are_so_too),
        cmocka_unit_test(far_frames_are_unlike_and_those_between_poor),
        cmocka_unit_test(a_clear_choice_settles_where_it_does_in_the_reference),
        cmocka_unit_test(noise_delays_settling_as_in_the_reference),
        cmocka_unit_test(a_change_of_looks_switches_where_it_does_in_the_reference),
        cmocka_unit_test(returns_cost_as_in_the_reference),
        cmocka_unit_test(the_transfer_of_two_and_three_is_that_of_the_reference),
        cmocka_unit_test(own_scales_are_those_of_the_reference),
        cmocka_unit_test(cells_and_correlation_times_are_those_of_the_reference),
        cmocka_unit_test(likeness_on_codes_is_that_of_the_reference_on_what_they_stand_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
