#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/trust.h>

#include "cmocka_all.h"

#define OK(call) assert_int_equal((call), VDNA_OK)
#define REFUSED(call) assert_int_equal((call), VDNA_ERR_ARG)
#define assert_near(found, expected) assert_true(fabs((found) - (expected)) <= 1e-9)

enum { RUNS = 7, WORDS = 2048 };

/* ---- A map: runs in the order of their looks, of which neighbours localise each other well ----
 */

static struct {
    uint32_t frames[RUNS];
    double own[RUNS], correlation[RUNS];
    vdna_trust_cell cells[RUNS * RUNS];
} map;
static vdna_trust_tables tables;
static int64_t mem[WORDS], other_mem[WORDS];

static vdna_trust_cell *cell(uint32_t a, uint32_t b, uint32_t runs)
{
    return &map.cells[a * runs + b];
}

/* Runs of 30 frames, so 7 windows; without likeness. */
static vdna_trust_config a_map_of(uint32_t runs)
{
    for (uint32_t a = 0; a < runs; a++) {
        map.frames[a] = 30;
        map.own[a] = 0.3 + 0.01 * a;
        map.correlation[a] = 2 + a;
        for (uint32_t b = 0; b < runs; b++)
            for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++) {
                const double apart = fabs((double)a - b) + 0.1 * sin(a + 2.0 * b + 3.0 * i);
                cell(a, b, runs)->nearest[i] = 0.1 + 0.03 * apart;
                cell(a, b, runs)->likeness[i] = NAN;
                cell(a, b, runs)->recall[i] = 0.97 - 0.1 * apart;
                cell(a, b, runs)->distance[i] = 4 + 2 * apart;
            }
    }
    tables = (vdna_trust_tables){map.frames, map.own, map.correlation, map.cells};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = runs;
    config.tables = &tables;
    return config;
}

static void set_recall(uint32_t a, uint32_t b, uint32_t runs, double recall)
{
    for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++)
        cell(a, b, runs)->recall[i] = recall;
}

static void without_labels(uint32_t run, uint32_t runs)
{
    for (uint32_t b = 0; b < runs; b++) {
        set_recall(run, b, runs, NAN);
        set_recall(b, run, runs, NAN);
    }
}

static vdna_trust *made(const vdna_trust_config *config)
{
    vdna_trust *trust = NULL;
    OK(vdna_trust_init(config, mem, sizeof mem, &trust));
    return trust;
}

/* A live run between runs 0 and 1, `by` times as far from all as they are; frames that vary in
 * common, as far as `apart` is 0. */
static void drive(vdna_trust *trust, uint32_t runs, int frames, double by, double apart)
{
    for (int t = 0; t < frames; t++) {
        double nearest[RUNS];
        for (uint32_t b = 0; b < runs; b++)
            nearest[b] = by * (0.1 + 0.03 * fabs(b - 0.3)) *
                         (1 + 0.1 * sin(5 * t) + apart * sin((2.0 + b) * t + b));
        OK(vdna_trust_feed(trust, nearest, NULL));
    }
}

static const double distances[RUNS] = {4.6, 5.4, 7.4, 9.4, 11.4, 13.4, 15.4};

static vdna_trust_answer predicted(vdna_trust *trust, const double *distance_bins,
                                   vdna_trust_prediction *out)
{
    vdna_trust_answer answer;
    OK(vdna_trust_predict(trust, distance_bins, out, &answer));
    return answer;
}

static void assert_no_prediction(const vdna_trust_prediction *p, uint32_t reason)
{
    assert_int_equal(p->reason, reason);
    assert_true(isnan(p->recall) && isnan(p->low) && isnan(p->high));
}

static void a_live_run_should_expect_most_of_its_like(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(5);
    vdna_trust *trust = made(&config);
    drive(trust, 5, 30, 1, 0);
    vdna_trust_prediction p[5];
    const vdna_trust_answer answer = predicted(trust, distances, p);
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS);
    assert_int_equal(answer.frames, 30);
    assert_int_equal(answer.choice, 0);
    for (int b = 0; b < 5; b++) {
        assert_int_equal(p[b].reason, VDNA_TRUST_REASON_NONE);
        assert_true(0 <= p[b].low && p[b].low < p[b].recall && p[b].recall < p[b].high);
        assert_true(p[b].high <= 1 && p[b].reserved == 0);
        assert_true(b == 0 || p[b].score < p[b - 1].score); /* as `choice` says */
        assert_true(b == 0 || (p[b].recall < p[b - 1].recall && p[b].transfer < p[b - 1].transfer));
    }
    assert_true(p[0].recall > 0.85 && p[4].recall < 0.8);
}

static void predicting_changes_nothing(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(5);
    vdna_trust *trust = made(&config);
    drive(trust, 5, 30, 1, 0.02);
    vdna_trust_prediction first[5], again[5];
    const vdna_trust_answer a = predicted(trust, distances, first);
    predicted(trust, NULL, again);
    const vdna_trust_answer b = predicted(trust, distances, again);
    assert_memory_equal(first, again, sizeof first);
    assert_memory_equal(&a, &b, sizeof a);
}

static void the_order_of_the_candidates_is_theirs_alone(void **state)
{
    (void)state;
    enum { K = 4 };
    vdna_trust_config config = a_map_of(K);
    vdna_trust *trust = made(&config);
    drive(trust, K, 12, 1, 0.02);
    vdna_trust_prediction p[K], turned[K];
    const vdna_trust_answer answer = predicted(trust, distances, p);

    static vdna_trust_cell cells[K * K];
    uint32_t frames[K];
    double own[K], correlation[K], turned_distances[K];
    for (uint32_t a = 0; a < K; a++) {
        for (uint32_t b = 0; b < K; b++)
            cells[(K - 1 - a) * K + K - 1 - b] = *cell(a, b, K);
        frames[K - 1 - a] = map.frames[a];
        own[K - 1 - a] = map.own[a];
        correlation[K - 1 - a] = map.correlation[a];
        turned_distances[K - 1 - a] = distances[a];
    }
    const vdna_trust_tables other = {frames, own, correlation, cells};
    config.tables = &other;
    vdna_trust *turned_trust = NULL;
    OK(vdna_trust_init(&config, other_mem, sizeof other_mem, &turned_trust));
    for (int t = 0; t < 12; t++) {
        double nearest[K];
        for (uint32_t b = 0; b < K; b++)
            nearest[K - 1 - b] = (0.1 + 0.03 * fabs(b - 0.3)) *
                                 (1 + 0.1 * sin(5 * t) + 0.02 * sin((2.0 + b) * t + b));
        OK(vdna_trust_feed(turned_trust, nearest, NULL));
    }
    const vdna_trust_answer turned_answer = predicted(turned_trust, turned_distances, turned);
    assert_int_equal(turned_answer.choice, K - 1 - answer.choice);
    assert_int_equal(turned_answer.settled_frames, answer.settled_frames);
    for (uint32_t b = 0; b < K; b++) {
        assert_near(turned[K - 1 - b].recall, p[b].recall);
        assert_near(turned[K - 1 - b].low, p[b].low);
        assert_near(turned[K - 1 - b].transfer, p[b].transfer);
    }
}

/* ---- Reasons ---- */

static void a_map_that_knows_nothing_predicts_nothing(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(3);
    config.tables = NULL;
    vdna_trust *trust = made(&config);
    drive(trust, 3, 40, 1, 0);
    vdna_trust_prediction p[3];
    const vdna_trust_answer answer = predicted(trust, distances, p);
    assert_no_prediction(&p[0], VDNA_TRUST_REASON_NO_TABLES);
    assert_true(isnan(p[0].transfer) && isnan(answer.unlike));
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS);
    assert_int_equal(answer.settled_frames, 0);
    assert_int_equal(answer.choice, 0); /* nearest by rho */
    assert_true(p[0].nearest > 0.1 && p[0].nearest < 0.12);
    const vdna_trust_fit *fit = vdna_trust_fitted(trust);
    assert_true(fit->labelled == 0 && isnan(fit->slope) && isnan(fit->skill) && isnan(fit->far));
    assert_true(isnan(fit->sd) && isnan(fit->sd_best) && isnan(fit->quantile));
}

static void few_frames_predict_nothing(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = made(&config);
    vdna_trust_prediction p[3];
    vdna_trust_answer answer = predicted(trust, distances, p);
    assert_no_prediction(&p[0], VDNA_TRUST_REASON_FEW_FRAMES);
    assert_true(isnan(p[0].nearest) && isnan(answer.unlike));
    assert_int_equal(answer.choice, 0);
    drive(trust, 3, 4, 10, 0);
    answer = predicted(trust, distances, p);
    assert_no_prediction(&p[2], VDNA_TRUST_REASON_FEW_FRAMES);
    assert_true(answer.unlike > 1);
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS); /* too early to tell */
    drive(trust, 3, 1, 10, 0);
    answer = predicted(trust, distances, p);
    assert_no_prediction(&p[2], VDNA_TRUST_REASON_UNLIKE);
    assert_int_equal(answer.verdict, VDNA_TRUST_UNLIKE);
}

static void what_is_unlike_has_a_ranking_and_no_prediction(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    vdna_trust *trust = made(&config);
    drive(trust, 4, 20, 3, 0);
    vdna_trust_prediction p[4];
    const vdna_trust_answer answer = predicted(trust, distances, p);
    assert_int_equal(answer.verdict, VDNA_TRUST_UNLIKE);
    for (int b = 0; b < 4; b++)
        assert_no_prediction(&p[b], VDNA_TRUST_REASON_UNLIKE);
    assert_true(p[0].transfer > p[1].transfer && p[1].transfer > p[2].transfer);
}

static void the_distance_of_the_live_dna_is_needed_about_the_means_only(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(4);
    vdna_trust *trust = made(&config);
    vdna_trust_prediction p[4];
    drive(trust, 4, 20, 1, 0);
    predicted(trust, NULL, p);
    assert_no_prediction(&p[1], VDNA_TRUST_REASON_NO_DISTANCE);
    assert_true(isnan(p[1].transfer));

    config.localiser = VDNA_TRUST_EUCLIDEAN;
    trust = made(&config);
    drive(trust, 4, 20, 1, 0);
    predicted(trust, NULL, p);
    assert_int_equal(p[1].reason, VDNA_TRUST_REASON_NONE);
    const double recall = p[1].recall;
    predicted(trust, distances, p);
    assert_true(p[1].recall == recall && p[1].transfer > 0);
}

static void poor_is_below_the_recall_that_was_asked_for(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(4);
    vdna_trust_prediction p[4];
    config.min_recall = 1;
    vdna_trust *trust = made(&config);
    drive(trust, 4, 20, 1, 0);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_POOR);
    assert_int_equal(p[0].reason, VDNA_TRUST_REASON_NONE);
    assert_int_equal(predicted(trust, NULL, p).verdict, VDNA_TRUST_FITS); /* nothing is predicted */
    config.min_recall = 0.5;
    trust = made(&config);
    drive(trust, 4, 20, 1, 0);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
}

/* The live run is nearest to run 0. */
static void one_candidate_is_judged_alone(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(4);
    config.min_recall = 0.5;
    vdna_trust *trust = made(&config);
    vdna_trust_prediction p[4];
    vdna_trust_answer before = predicted(trust, NULL, p);
    OK(vdna_trust_judge(trust, 3, p, &before));
    assert_int_equal(before.verdict, VDNA_TRUST_FITS); /* of no frame nothing is known */
    assert_true(isnan(before.unlike));

    drive(trust, 4, 20, 1, 0);
    const vdna_trust_answer answer = predicted(trust, distances, p);
    vdna_trust_answer of[4];
    for (uint32_t b = 0; b < 4; b++) {
        of[b] = answer;
        OK(vdna_trust_judge(trust, b, p, &of[b]));
        assert_int_equal(of[b].choice, answer.choice);
    }
    assert_memory_equal(&of[0], &answer, sizeof answer); /* the nearest is judged for all */
    assert_true(of[1].unlike > of[0].unlike && of[3].unlike > of[2].unlike);
    assert_int_equal(of[3].verdict, VDNA_TRUST_UNLIKE);
    p[0].recall = 0.4;
    OK(vdna_trust_judge(trust, 0, p, &of[0]));
    assert_int_equal(of[0].verdict, VDNA_TRUST_POOR);

    REFUSED(vdna_trust_judge(NULL, 0, p, &of[0]));
    REFUSED(vdna_trust_judge(trust, 4, p, &of[0]));
    REFUSED(vdna_trust_judge(trust, 0, NULL, &of[0]));
    REFUSED(vdna_trust_judge(trust, 0, p, NULL));
}

static void one_experience_is_settled_and_nothing_else_is_known(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(1);
    vdna_trust *trust = made(&config);
    drive(trust, 1, 9, 10, 0);
    assert_int_equal(vdna_trust_settled_frames(trust), 0);
    drive(trust, 1, 5, 10, 0);
    vdna_trust_prediction p[1];
    const vdna_trust_answer answer = predicted(trust, distances, p);
    assert_no_prediction(p, VDNA_TRUST_REASON_FEW_RUNS);
    assert_int_equal(answer.settled_frames, 10);
    assert_true(isnan(answer.unlike) && isnan(p->transfer));
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS);
}

static void two_experiences_transfer_and_may_be_unlike(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(2);
    map.correlation[0] = map.correlation[1] = NAN; /* of one candidate there is none */
    vdna_trust *trust = made(&config);
    drive(trust, 2, 30, 1, 0);
    vdna_trust_prediction p[2];
    vdna_trust_answer answer = predicted(trust, distances, p);
    assert_no_prediction(&p[0], VDNA_TRUST_REASON_FEW_RUNS);
    assert_true(p[0].transfer > p[1].transfer);
    assert_int_equal(answer.settled_frames, 0); /* not without a correlation time */
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS);
    vdna_trust_reset(trust);
    drive(trust, 2, 30, 3, 0);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_UNLIKE);
}

/* ---- Labels ---- */

static void without_labels_it_still_settles_and_tells_what_is_unlike(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    for (uint32_t a = 0; a < 4; a++) {
        without_labels(a, 4);
        map.own[a] = 1;
    }
    vdna_trust *trust = made(&config);
    drive(trust, 4, 40, 1, 0.01);
    vdna_trust_prediction p[4];
    vdna_trust_answer answer = predicted(trust, distances, p);
    assert_int_equal(vdna_trust_fitted(trust)->labelled, 0);
    assert_true(answer.settled_frames >= 10);
    assert_int_equal(answer.choice, 0);
    for (int b = 0; b < 4; b++) {
        assert_no_prediction(&p[b], VDNA_TRUST_REASON_FEW_RUNS);
        assert_true(isnan(p[b].transfer) && isnan(vdna_trust_intercepts(trust)[b]));
    }
    vdna_trust_reset(trust);
    drive(trust, 4, 40, 3, 0);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_UNLIKE);
}

static void a_run_without_labels_takes_nothing_from_the_others(void **state)
{
    (void)state;
    enum { K = 4 };
    vdna_trust_config config = a_map_of(K);
    vdna_trust *trust = made(&config);
    vdna_trust_prediction all[K], some[K + 1];
    drive(trust, K, 20, 1, 0);
    predicted(trust, distances, all);

    config = a_map_of(K + 1);
    without_labels(K, K + 1);
    vdna_trust *more = NULL;
    OK(vdna_trust_init(&config, other_mem, sizeof other_mem, &more));
    drive(more, K + 1, 20, 1, 0);
    const vdna_trust_answer answer = predicted(more, distances, some);
    assert_int_equal(vdna_trust_fitted(more)->labelled, K);
    assert_no_prediction(&some[K], VDNA_TRUST_REASON_NOT_LABELLED);
    assert_true(isnan(some[K].transfer) && isnan(vdna_trust_intercepts(more)[K]));
    for (int b = 0; b < K; b++) {
        /* The cells differ by nothing that depends on the number of runs. */
        assert_true(some[b].recall == all[b].recall && some[b].low == all[b].low);
        assert_true(some[b].transfer == all[b].transfer);
    }
    /* Recall does not compare, so the choice is by rho. */
    assert_int_equal(answer.choice, 0);
}

static void the_run_that_lacks_most_is_left_out(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(5);
    cell(1, 3, 5)->recall[2] = NAN;
    cell(3, 4, 5)->distance[6] = NAN;
    vdna_trust *trust = made(&config);
    const double *intercepts = vdna_trust_intercepts(trust);
    assert_int_equal(vdna_trust_fitted(trust)->labelled, 4);
    for (int b = 0; b < 5; b++)
        assert_true(isnan(intercepts[b]) == (b == 3));

    cell(3, 4, 5)->distance[6] = 5; /* a cell of 1 and 3: the last of equals */
    trust = made(&config);
    assert_true(isnan(vdna_trust_intercepts(trust)[3]));
}

static void two_labelled_runs_among_three_are_too_few(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    without_labels(0, 3);
    vdna_trust *trust = made(&config);
    drive(trust, 3, 20, 1, 0);
    vdna_trust_prediction p[3];
    predicted(trust, distances, p);
    assert_int_equal(vdna_trust_fitted(trust)->labelled, 2);
    assert_no_prediction(&p[1], VDNA_TRUST_REASON_FEW_RUNS);
    assert_true(isnan(p[0].transfer) && p[1].transfer > 0 && p[2].transfer > 0);
}

/* ---- Odd maps ---- */

static void identical_experiences_share_everything(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    for (uint32_t i = 0; i < 9; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++) {
            map.cells[i].nearest[w] = map.cells[i].distance[w] = 0;
            map.cells[i].recall[w] = 1;
        }
    for (uint32_t a = 0; a < 3; a++) {
        map.own[a] = 0.3;
        map.correlation[a] = NAN;
    }
    map.correlation[1] = 0.2; /* counts as 1 */
    vdna_trust *trust = made(&config);
    assert_true(vdna_trust_fitted(trust)->correlation == 1);
    assert_near(vdna_trust_fitted(trust)->far, log(1e-6));
    for (int t = 0; t < 20; t++) {
        const double none[] = {0, 0, 0};
        OK(vdna_trust_feed(trust, none, NULL));
    }
    const double same[] = {7, 7, 7};
    vdna_trust_prediction p[3];
    const vdna_trust_answer answer = predicted(trust, same, p);
    assert_int_equal(answer.verdict, VDNA_TRUST_FITS);
    assert_int_equal(answer.settled_frames, 10);
    for (int b = 0; b < 3; b++) {
        assert_near(p[b].recall, p[0].recall);
        assert_near(p[b].transfer, 1);
        assert_true(p[b].recall > 0.9 && p[b].high == 1);
    }
}

static void of_two_alike_the_first_is_chosen_and_settles(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = made(&config);
    without_labels(0, 3);
    without_labels(1, 3); /* by rho alone */
    trust = made(&config);
    for (int t = 0; t < 40; t++) {
        const double nearest[] = {0.1 + 0.03 * sin(t), 0.1 + 0.03 * sin(t), 0.3};
        OK(vdna_trust_feed(trust, nearest, NULL));
    }
    vdna_trust_prediction p[3];
    const vdna_trust_answer answer = predicted(trust, distances, p);
    assert_int_equal(answer.choice, 0);
    assert_true(answer.settled_frames >= 10);
}

static void perfect_recalls_have_no_errors_and_no_skill(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    for (uint32_t i = 0; i < 16; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++)
            map.cells[i].recall[w] = 1;
    assert_true(vdna_trust_fitted(made(&config))->skill == 0);
}

static void recalls_that_never_differ_leave_no_skill_whatever_is_rounded(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    for (uint32_t i = 0; i < 16; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++)
            map.cells[i].recall[w] = 0.95 - 0.07 * (i % 4);
    assert_true(vdna_trust_fitted(made(&config))->skill == 0);
}

static void where_nothing_is_ever_recognised_nothing_is_expected(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    for (uint32_t i = 0; i < 9; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++) {
            map.cells[i].recall[w] = 0;
            map.cells[i].nearest[w] = 1.9;
        }
    vdna_trust *trust = made(&config);
    const double far[] = {1.9, 1.9, 1.9}, very_far[] = {4, 1e6, 1e6};
    for (int t = 0; t < 10; t++)
        OK(vdna_trust_feed(trust, far, NULL));
    vdna_trust_prediction p[3];
    predicted(trust, very_far, p);
    assert_int_equal(p[1].reason, VDNA_TRUST_REASON_NONE);
    assert_true(p[1].transfer < 1e-300 && p[1].recall < 0.01 && p[1].low == 0);
    assert_near(p[0].transfer, 1); /* its own vote */
    double expected[3];
    OK(vdna_trust_expect(trust, far, expected));
    assert_true(expected[0] < 0.01);
}

static void more_than_31_runs_have_the_last_quantile(void **state)
{
    (void)state;
    enum { MANY = 40 };
    vdna_trust_config config = a_map_of(3);
    static uint32_t frames[MANY];
    static double own[MANY], correlation[MANY];
    static vdna_trust_cell cells[MANY * MANY];
    for (uint32_t a = 0; a < MANY; a++) {
        frames[a] = 30;
        own[a] = 0.3;
        correlation[a] = 3;
        for (uint32_t b = 0; b < MANY; b++)
            cells[a * MANY + b] = *cell(a % 3, (a + b) % 3, 3);
    }
    const vdna_trust_tables many = {frames, own, correlation, cells};
    config.tables = &many;
    for (uint32_t runs = 28; runs <= MANY; runs += 4) {
        config.runs = runs;
        void *block = malloc(vdna_trust_mem_size(&config));
        vdna_trust *trust = NULL;
        OK(vdna_trust_init(&config, block, vdna_trust_mem_size(&config), &trust));
        assert_true(vdna_trust_fitted(trust)->quantile == (runs == 28 ? 1.311 : 1.310));
        free(block);
    }
}

/* ---- Likeness ---- */

static void set_likeness(uint32_t runs, double likeness)
{
    for (uint32_t i = 0; i < runs * runs; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++)
            map.cells[i].likeness[w] = likeness;
}

/* Frames that are in turn nearer and farther than `mean` by a share of it. */
static void feed_varying(vdna_trust *trust, double mean, double share, int frames)
{
    vdna_trust_reset(trust);
    for (int t = 0; t < frames; t++) {
        const double nearest[] = {0.1, 0.2, 0.3};
        const double like = mean * (t % 2 == 0 ? 1 - share : 1 + share);
        const double likeness[] = {like, like, 2 * like};
        OK(vdna_trust_feed(trust, nearest, likeness));
    }
}

static void unlike_is_judged_on_the_last_layer_where_all_runs_have_it(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    set_likeness(3, 0.5);
    vdna_trust *trust = made(&config);
    vdna_trust_prediction p[3];
    assert_int_equal(vdna_trust_fitted(trust)->by_likeness, 1);
    assert_near(vdna_trust_fitted(trust)->far, log(0.5));
    feed_varying(trust, 0.5 * exp(0.09), 0.05, 20);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
    feed_varying(trust, 0.5 * exp(0.11), 0.05, 20);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_UNLIKE);

    cell(2, 1, 3)->likeness[6] = NAN;
    trust = made(&config);
    assert_int_equal(vdna_trust_fitted(trust)->by_likeness, 0);
    feed_varying(trust, 0.95, 0.05, 20);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
}

/* A map of two looks: its loneliest run is twice as far from the others as the median. */
static vdna_trust *a_map_with_a_lonely_run(void)
{
    const vdna_trust_config config = a_map_of(3);
    set_likeness(3, 0.4);
    for (uint32_t b = 0; b < 2; b++)
        for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++)
            cell(2, b, 3)->likeness[i] = 0.8;
    return made(&config);
}

static void frames_that_hardly_differ_and_are_far_are_blank(void **state)
{
    (void)state;
    vdna_trust *trust = a_map_with_a_lonely_run();
    vdna_trust_prediction p[3];
    assert_near(vdna_trust_fitted(trust)->far, log(0.8));
    feed_varying(trust, 0.4 * exp(0.06), 0.024, 20);
    vdna_trust_answer answer = predicted(trust, distances, p);
    assert_int_equal(answer.verdict, VDNA_TRUST_BLANK);
    assert_near(answer.unlike, log(0.5) + 0.06);
    assert_no_prediction(&p[0], VDNA_TRUST_REASON_UNLIKE);
    OK(vdna_trust_judge(trust, 1, p, &answer));
    assert_int_equal(answer.verdict, VDNA_TRUST_BLANK);
    OK(vdna_trust_judge(trust, 2, p, &answer));
    assert_int_equal(answer.verdict, VDNA_TRUST_BLANK); /* twice as far, and not yet unlike */

    feed_varying(trust, 0.4 * exp(0.06), 0.026, 20); /* frames differ */
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
    feed_varying(trust, 0.4 * exp(0.04), 0, 20); /* a robot that stands, near enough */
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
    feed_varying(trust, 0.8 * exp(0.11), 0, 20);
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_UNLIKE);
    feed_varying(trust, 0.7, 0, VDNA_TRUST_FRAMES_MIN - 1); /* too early to tell */
    assert_int_equal(predicted(trust, distances, p).verdict, VDNA_TRUST_FITS);
}

static void without_it_the_margin_is_twice_as_wide(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(3);
    vdna_trust_prediction p[3];
    for (uint32_t localiser = 0; localiser < 2; localiser++) {
        config.localiser = localiser;
        vdna_trust *trust = made(&config);
        const double at = exp(vdna_trust_fitted(trust)->far + 0.15);
        const double nearest[] = {at, at, at};
        for (int t = 0; t < 20; t++)
            OK(vdna_trust_feed(trust, nearest, NULL));
        const vdna_trust_answer answer = predicted(trust, distances, p);
        assert_near(answer.unlike, 0.15);
        assert_int_equal(answer.verdict,
                         localiser == VDNA_TRUST_CENTRED ? VDNA_TRUST_FITS : VDNA_TRUST_UNLIKE);
    }
}

/* ---- Settling ---- */

static void a_choice_settles_when_the_lead_outgrows_the_noise(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    uint32_t before = 0;
    for (int noise = 0; noise < 4; noise++) {
        vdna_trust *trust = made(&config);
        drive(trust, 4, 400, 1, 0.06 * noise);
        const uint32_t settled = vdna_trust_settled_frames(trust);
        assert_true(settled >= VDNA_TRUST_SETTLED_FRAMES && settled >= before);
        before = settled;
    }
    assert_true(before > VDNA_TRUST_SETTLED_FRAMES);
}

static void a_settled_choice_stays_so_until_a_reset(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(4);
    vdna_trust *trust = made(&config);
    drive(trust, 4, 20, 1, 0);
    assert_int_equal(vdna_trust_settled_frames(trust), 10);
    drive(trust, 4, 20, 1, 0.5);
    assert_int_equal(vdna_trust_settled_frames(trust), 10);
    vdna_trust_reset(trust);
    assert_int_equal(vdna_trust_settled_frames(trust), 0);
}

static void where_distances_tell_nothing_it_never_settles(void **state)
{
    (void)state;
    for (uint32_t runs = 5; runs <= 6; runs++) {
        const vdna_trust_config config = a_map_of(runs);
        /* Each candidate has a recall of its own, whatever the distance. */
        for (uint32_t a = 0; a < runs; a++)
            for (uint32_t b = 0; b < runs; b++)
                set_recall(a, b, runs, 0.2 + 0.1 * b);
        vdna_trust *trust = made(&config);
        drive(trust, runs, 100, 1, 0);
        assert_true(vdna_trust_fitted(trust)->skill <= 0);
        assert_int_equal(vdna_trust_settled_frames(trust) > 0, runs < VDNA_TRUST_SKILL_RUNS_MIN);
    }
    const vdna_trust_config config = a_map_of(6);
    vdna_trust *trust = made(&config);
    drive(trust, 6, 100, 1, 0);
    assert_true(vdna_trust_fitted(trust)->skill > 0.3);
    assert_int_equal(vdna_trust_settled_frames(trust), 10);
}

/* ---- Choosing again ---- */

static uint32_t reconsidered(vdna_trust *trust, double r0, double r1, double r2)
{
    const double recall[] = {r0, r1, r2};
    uint32_t choice = 99;
    OK(vdna_trust_reconsider(trust, recall, 1, &choice));
    return choice;
}

static void a_switch_pays_after_as_many_frames_as_it_costs(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = made(&config);
    OK(vdna_trust_choose(trust, 0));
    for (int t = 0; t < 10; t++) /* gains 0.48 a frame */
        assert_int_equal(reconsidered(trust, 0.4, 0.9, 0.3), 0);
    assert_int_equal(reconsidered(trust, 0.4, 0.9, 0.3), 1);
    /* Back to 0 is a return: twice the cost. */
    for (int t = 0; t < 20; t++)
        assert_int_equal(reconsidered(trust, 0.9, 0.4, 0.3), 1);
    assert_int_equal(reconsidered(trust, 0.9, 0.4, 0.3), 0);
    OK(vdna_trust_choose(trust, 2)); /* all is forgotten */
    for (int t = 0; t < 10; t++)
        assert_int_equal(reconsidered(trust, 0.9, 0.4, 0.4), 2);
    assert_int_equal(reconsidered(trust, 0.9, 0.4, 0.4), 0);
}

static void an_unknown_recall_gains_nothing(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = made(&config);
    OK(vdna_trust_choose(trust, 0));
    for (int t = 0; t < 100; t++)
        assert_int_equal(reconsidered(trust, NAN, 1, 1), 0);
    for (int t = 0; t < 10; t++)
        assert_int_equal(reconsidered(trust, 0.4, 0.9, NAN), 0);
    assert_int_equal(reconsidered(trust, 0.4, NAN, NAN), 0); /* begins anew */
    for (int t = 0; t < 10; t++)
        assert_int_equal(reconsidered(trust, 0.4, 0.9, NAN), 0);
    assert_int_equal(reconsidered(trust, 0.4, 0.9, NAN), 1);
}

static void a_candidate_suits_by_nearness_and_by_confidence(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(2);
    vdna_trust *trust = made(&config);
    const double own[] = {map.own[0], map.own[1]};
    const double nearest[] = {0.4 * own[0], 0.8 * own[1]}, sure[] = {0.5, 1};
    double suits[2];
    OK(vdna_trust_suit(trust, nearest, NULL, suits));
    assert_near(suits[0], 1);
    assert_near(suits[1], 0.5);
    OK(vdna_trust_suit(trust, nearest, sure, suits));
    assert_near(suits[0], 0.75);
    assert_near(suits[1], 0.75);
    /* The very same picture in both. */
    const double same[] = {0, 0};
    OK(vdna_trust_suit(trust, same, NULL, suits));
    assert_true(suits[0] == 1 && suits[1] == 1);
}

static void after_a_change_of_light_the_candidate_that_suits_is_chosen(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(2);
    vdna_trust *trust = made(&config);
    OK(vdna_trust_choose(trust, 0));
    const double dark[] = {0.8 * map.own[0], 0.4 * map.own[1]}, sure[] = {0.9, 0.9};
    double suits[2];
    uint32_t choice = 0, frames = 0;
    for (; choice == 0 && frames < 100; frames++) {
        OK(vdna_trust_suit(trust, dark, sure, suits));
        OK(vdna_trust_reconsider(trust, suits, 1, &choice));
    }
    /* 0.25 - 0.02 a frame, until they are above the cost of 5. */
    assert_int_equal(frames, 22);
}

static void without_a_fit_no_recall_is_expected(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(2);
    vdna_trust *trust = made(&config);
    const double nearest[] = {0.1, 0.2};
    double recall[2] = {7, 7};
    OK(vdna_trust_expect(trust, nearest, recall));
    assert_true(isnan(recall[0]) && isnan(recall[1]));
}

/* ---- Arguments ---- */

static void a_bad_config_has_no_size_and_is_refused(void **state)
{
    (void)state;
    const vdna_trust_config good = a_map_of(3);
    vdna_trust *trust = NULL;
    vdna_trust_config bad[8];
    for (int i = 0; i < 8; i++)
        bad[i] = good;
    bad[0].runs = 0;
    bad[1].runs = VDNA_TRUST_RUNS_MAX + 1;
    bad[2].localiser = 2;
    bad[3].min_recall = 1.5;
    bad[4].min_recall = NAN;
    bad[5].switch_cost = 0.5;
    bad[6].struct_size--;
    bad[7].struct_size++;
    for (int i = 0; i < 8; i++) {
        assert_int_equal(vdna_trust_mem_size(&bad[i]), 0);
        REFUSED(vdna_trust_init(&bad[i], mem, sizeof mem, &trust));
    }
    assert_int_equal(vdna_trust_mem_size(NULL), 0);
    const size_t size = vdna_trust_mem_size(&good);
    assert_int_equal(vdna_trust_init(&good, mem, size - 1, &trust), VDNA_ERR_NOMEM);
    REFUSED(vdna_trust_init(&good, NULL, size, &trust));
    REFUSED(vdna_trust_init(&good, mem, size, NULL));
    REFUSED(vdna_trust_init(&good, (char *)mem + 4, size, &trust));
    assert_null(trust);
    OK(vdna_trust_init(&good, mem, size, &trust));
    vdna_trust_config_init(NULL);
}

static void the_size_is_as_stated(void **state)
{
    (void)state;
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    for (uint32_t runs = 1; runs <= 100; runs++) {
        config.runs = runs;
        const size_t stated = 32 * runs * runs + 104 * runs;
        const size_t found = vdna_trust_mem_size(&config);
        assert_true(found >= stated - 12 * runs && found <= stated + 400);
    }
}

static void tables_with_a_hole_are_refused(void **state)
{
    (void)state;
    vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = NULL;
    vdna_trust_tables bad[5] = {tables, tables, tables, tables, tables};
    bad[0].frames = NULL;
    bad[1].own_scale = NULL;
    bad[2].correlation = NULL;
    bad[3].cells = NULL;
    bad[4].frames = (const uint32_t[]){30, 0, 30};
    for (int i = 0; i < 5; i++) {
        config.tables = &bad[i];
        REFUSED(vdna_trust_init(&config, mem, sizeof mem, &trust));
    }
    assert_null(trust);
    assert_int_equal(vdna_trust_tables_check(&tables, 3), VDNA_OK);
    REFUSED(vdna_trust_tables_check(NULL, 3));
    REFUSED(vdna_trust_tables_check(&tables, 0));
    REFUSED(vdna_trust_tables_check(&tables, VDNA_TRUST_RUNS_MAX + 1));
}

static void a_number_of_the_tables_beyond_its_range_is_refused(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    struct {
        double *number, value;
    } trials[] = {
        {&map.own[1], 0},
        {&map.own[1], NAN},
        {&map.own[2], 2.1},
        {&map.correlation[0], -1},
        {&map.correlation[0], INFINITY},
        {&cell(0, 1, 3)->nearest[0], NAN},
        {&cell(2, 1, 3)->nearest[6], 2.1},
        {&cell(0, 1, 3)->likeness[0], -0.1},
        {&cell(0, 1, 3)->likeness[0], 2.1},
        {&cell(0, 1, 3)->recall[3], 1.1},
        {&cell(0, 1, 3)->recall[3], -0.1},
        {&cell(1, 0, 3)->distance[3], INFINITY},
        {&cell(1, 0, 3)->distance[3], -1},
    };
    vdna_trust *trust = NULL;
    for (size_t i = 0; i < sizeof trials / sizeof *trials; i++) {
        const double kept = *trials[i].number;
        *trials[i].number = trials[i].value;
        assert_int_equal(vdna_trust_init(&config, mem, sizeof mem, &trust), VDNA_ERR_NONFINITE);
        *trials[i].number = kept;
    }
    /* What is on the diagonal, or beyond the windows of the row, is ignored. */
    cell(1, 1, 3)->nearest[0] = NAN;
    map.frames[2] = 1;
    cell(2, 0, 3)->nearest[1] = NAN;
    OK(vdna_trust_init(&config, mem, sizeof mem, &trust));
}

static void a_bad_frame_changes_nothing(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    set_likeness(3, 0.5);
    vdna_trust *trust = made(&config);
    const double good[] = {0.1, 0.2, 0.3}, below[] = {0.1, -0.1, 0.3}, nan[] = {0.1, 0.2, NAN};
    REFUSED(vdna_trust_feed(NULL, good, good));
    REFUSED(vdna_trust_feed(trust, NULL, good));
    REFUSED(vdna_trust_feed(trust, good, NULL));
    assert_int_equal(vdna_trust_feed(trust, below, good), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_trust_feed(trust, good, nan), VDNA_ERR_NONFINITE);
    vdna_trust_prediction p[3];
    vdna_trust_answer answer;
    assert_int_equal(predicted(trust, distances, p).frames, 0);
    REFUSED(vdna_trust_predict(NULL, distances, p, &answer));
    REFUSED(vdna_trust_predict(trust, distances, NULL, &answer));
    REFUSED(vdna_trust_predict(trust, distances, p, NULL));
    assert_int_equal(vdna_trust_predict(trust, below, p, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_trust_predict(trust, nan, p, &answer), VDNA_ERR_NONFINITE);
    vdna_trust_reset(NULL);
}

static void a_warmup_ends_at_a_million_frames(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(1);
    vdna_trust *trust = made(&config);
    const double nearest[] = {0.25};
    for (uint32_t t = 0; t < VDNA_TRUST_FRAMES_MAX; t++)
        if (vdna_trust_feed(trust, nearest, NULL) != VDNA_OK)
            fail();
    assert_int_equal(vdna_trust_feed(trust, nearest, NULL), VDNA_ERR_FULL);
    vdna_trust_prediction p[1];
    assert_int_equal(predicted(trust, distances, p).frames, VDNA_TRUST_FRAMES_MAX);
    assert_near(p->nearest, 0.25 / 0.3);
}

static void a_bad_choice_is_refused(void **state)
{
    (void)state;
    const vdna_trust_config config = a_map_of(3);
    vdna_trust *trust = made(&config);
    const double recall[] = {0.1, 0.2, 0.3}, above[] = {0.1, 1.2, 0.3};
    double expected[3];
    uint32_t choice = 7;
    REFUSED(vdna_trust_reconsider(trust, recall, 1, &choice)); /* nothing chosen */
    REFUSED(vdna_trust_choose(NULL, 0));
    REFUSED(vdna_trust_choose(trust, 3));
    OK(vdna_trust_choose(trust, 2));
    REFUSED(vdna_trust_reconsider(NULL, recall, 1, &choice));
    REFUSED(vdna_trust_reconsider(trust, NULL, 1, &choice));
    REFUSED(vdna_trust_reconsider(trust, recall, 0, &choice));
    REFUSED(vdna_trust_reconsider(trust, recall, 1000001, &choice));
    REFUSED(vdna_trust_reconsider(trust, recall, 1, NULL));
    REFUSED(vdna_trust_reconsider(trust, above, 1, &choice));
    assert_int_equal(choice, 7);
    REFUSED(vdna_trust_expect(NULL, recall, expected));
    REFUSED(vdna_trust_expect(trust, NULL, expected));
    REFUSED(vdna_trust_expect(trust, recall, NULL));
    const double far[] = {0.1, 2.2, 0.3};
    assert_int_equal(vdna_trust_expect(trust, far, expected), VDNA_ERR_NONFINITE);
    REFUSED(vdna_trust_suit(NULL, recall, recall, expected));
    REFUSED(vdna_trust_suit(trust, NULL, recall, expected));
    REFUSED(vdna_trust_suit(trust, recall, recall, NULL));
    REFUSED(vdna_trust_suit(trust, recall, above, expected));
    assert_int_equal(vdna_trust_suit(trust, far, NULL, expected), VDNA_ERR_NONFINITE);
    vdna_trust_reset(trust); /* no candidate is chosen any more */
    REFUSED(vdna_trust_reconsider(trust, recall, 1, &choice));
}

static void accessors_bear_null_and_every_reason_has_a_text(void **state)
{
    (void)state;
    assert_int_equal(vdna_trust_settled_frames(NULL), 0);
    assert_int_equal(vdna_trust_runs(NULL), 0);
    const vdna_trust_config config = a_map_of(3);
    assert_int_equal(vdna_trust_runs(made(&config)), 3);
    assert_null(vdna_trust_fitted(NULL));
    assert_null(vdna_trust_intercepts(NULL));
    assert_string_equal(vdna_trust_reason_text(VDNA_TRUST_REASON_NONE), "");
    for (uint32_t i = 1; i <= VDNA_TRUST_REASON_NO_DISTANCE; i++) {
        assert_true(strlen(vdna_trust_reason_text(i)) > 10);
        for (uint32_t j = 1; j < i; j++)
            assert_string_not_equal(vdna_trust_reason_text(i), vdna_trust_reason_text(j));
    }
    assert_string_equal(vdna_trust_reason_text(VDNA_TRUST_REASON_NO_DISTANCE + 1), "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_live_run_should_expect_most_of_its_like),
        cmocka_unit_test(predicting_changes_nothing),
        cmocka_unit_test(the_order_of_the_candidates_is_theirs_alone),
        cmocka_unit_test(a_map_that_knows_nothing_predicts_nothing),
        cmocka_unit_test(few_frames_predict_nothing),
        cmocka_unit_test(what_is_unlike_has_a_ranking_and_no_prediction),
        cmocka_unit_test(the_distance_of_the_live_dna_is_needed_about_the_means_only),
        cmocka_unit_test(poor_is_below_the_recall_that_was_asked_for),
        cmocka_unit_test(one_candidate_is_judged_alone),
        cmocka_unit_test(one_experience_is_settled_and_nothing_else_is_known),
        cmocka_unit_test(two_experiences_transfer_and_may_be_unlike),
        cmocka_unit_test(without_labels_it_still_settles_and_tells_what_is_unlike),
        cmocka_unit_test(a_run_without_labels_takes_nothing_from_the_others),
        cmocka_unit_test(the_run_that_lacks_most_is_left_out),
        cmocka_unit_test(two_labelled_runs_among_three_are_too_few),
        cmocka_unit_test(identical_experiences_share_everything),
        cmocka_unit_test(of_two_alike_the_first_is_chosen_and_settles),
        cmocka_unit_test(perfect_recalls_have_no_errors_and_no_skill),
        cmocka_unit_test(recalls_that_never_differ_leave_no_skill_whatever_is_rounded),
        cmocka_unit_test(where_nothing_is_ever_recognised_nothing_is_expected),
        cmocka_unit_test(more_than_31_runs_have_the_last_quantile),
        cmocka_unit_test(unlike_is_judged_on_the_last_layer_where_all_runs_have_it),
        cmocka_unit_test(frames_that_hardly_differ_and_are_far_are_blank),
        cmocka_unit_test(without_it_the_margin_is_twice_as_wide),
        cmocka_unit_test(a_choice_settles_when_the_lead_outgrows_the_noise),
        cmocka_unit_test(a_settled_choice_stays_so_until_a_reset),
        cmocka_unit_test(where_distances_tell_nothing_it_never_settles),
        cmocka_unit_test(a_switch_pays_after_as_many_frames_as_it_costs),
        cmocka_unit_test(an_unknown_recall_gains_nothing),
        cmocka_unit_test(a_candidate_suits_by_nearness_and_by_confidence),
        cmocka_unit_test(after_a_change_of_light_the_candidate_that_suits_is_chosen),
        cmocka_unit_test(without_a_fit_no_recall_is_expected),
        cmocka_unit_test(a_bad_config_has_no_size_and_is_refused),
        cmocka_unit_test(the_size_is_as_stated),
        cmocka_unit_test(tables_with_a_hole_are_refused),
        cmocka_unit_test(a_number_of_the_tables_beyond_its_range_is_refused),
        cmocka_unit_test(a_bad_frame_changes_nothing),
        cmocka_unit_test(a_warmup_ends_at_a_million_frames),
        cmocka_unit_test(a_bad_choice_is_refused),
        cmocka_unit_test(accessors_bear_null_and_every_reason_has_a_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
