/* Properties of all histograms, tried on random ones. Everything follows from SEED and the number
 * of the case, which a failure prints. */
#include <math.h>
#include <string.h>

#include <vdna/rank.h>

#include "cmocka_all.h"

enum { SEED = 20260403, CASES = 10000, NEURONS_MOST = 7, SMALL_MASS = 1000 };

/* One double rounding is at most this much of its result. */
#define ROUNDING ldexp(1, -53)

static uint64_t random_state;
static uint32_t current_case;

#define CHECK(condition)                                                            \
    do {                                                                            \
        if (!(condition))                                                           \
            fail_msg("case %u of seed %d: not %s", current_case, SEED, #condition); \
    } while (0)

static void begin_case(uint32_t number)
{
    current_case = number;
    random_state = ((uint64_t)SEED << 32) + number;
}

/* splitmix64 */
static uint64_t random_word(void)
{
    uint64_t x = random_state += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

static uint32_t random_below(uint32_t limit)
{
    return (uint32_t)(random_word() % limit);
}

/* ---- Histograms written out directly, with any mass ---- */

enum { BINS_MOST = 1000, COUNTS_MOST = NEURONS_MOST * BINS_MOST };

typedef struct dna {
    uint32_t counts[COUNTS_MOST], mass[NEURONS_MOST];
} dna;

static float unit_range[2 * NEURONS_MOST];
static uint32_t neurons, bins;

static vdna_hist_view view_of(const dna *d)
{
    const vdna_hist_view view = {unit_range, d->counts, d->mass, neurons, bins};
    return view;
}

static void random_shape(void)
{
    static const uint32_t some_bins[] = {2, 3, 5, 17, 256, BINS_MOST};
    neurons = 1 + random_below(NEURONS_MOST);
    bins = some_bins[random_below(6)];
    for (uint32_t n = 0; n < neurons; n++)
        unit_range[2 * n + 1] = 1;
}

/* The largest mass within the exact bound. */
static uint32_t largest_mass(void)
{
    const double most = floor(sqrt((double)(INT64_MAX / (int64_t)(bins - 1)))) - 1;
    return most < UINT32_MAX ? (uint32_t)most : UINT32_MAX;
}

static void put(dna *d, uint32_t neuron, uint32_t bin, uint32_t count)
{
    d->counts[bin * neurons + neuron] += count;
    d->mass[neuron] += count;
}

/* Heaps of samples in the first `width` bins, at most `mass_most` in each neuron: one sample, one
 * heap, two heaps at the ends, or many. */
static void random_dna(dna *d, uint32_t width, uint32_t mass_most)
{
    memset(d, 0, sizeof *d);
    for (uint32_t n = 0; n < neurons; n++) {
        const uint32_t heaps = 1 + random_below(random_below(2) ? 2 : 12);
        const uint32_t most = random_below(2) ? 1 + random_below(4) : mass_most;
        const int ends = random_below(4) == 0;
        for (uint32_t h = 0; h < heaps; h++) {
            const uint32_t room = most / heaps ? most / heaps : 1;
            put(d, n, ends ? h % 2 * (width - 1) : random_below(width),
                random_below(4) == 0 ? room : 1 + random_below(room));
        }
    }
}

static uint32_t random_mass(void)
{
    return random_below(2) ? SMALL_MASS : largest_mass();
}

static void distances(const dna *p, const dna *q, double out_emd[NEURONS_MOST])
{
    const vdna_hist_view view_p = view_of(p), view_q = view_of(q);
    int64_t scratch[2 * NEURONS_MOST];
    CHECK(vdna_emd(&view_p, &view_q, scratch, sizeof scratch, out_emd) == VDNA_OK);
}

static void a_shift_by_k_bins_is_at_distance_k(void **state)
{
    (void)state;
    static dna p, q;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_shape();
        const uint32_t k = random_below(bins), mass = random_mass();
        random_dna(&p, bins - k, mass);
        memset(&q, 0, sizeof q);
        for (uint32_t b = 0; b + k < bins; b++)
            for (uint32_t n = 0; n < neurons; n++)
                put(&q, n, b + k, p.counts[b * neurons + n]);
        double emd[NEURONS_MOST];
        distances(&p, &q, emd);
        for (uint32_t n = 0; n < neurons; n++)
            CHECK(emd[n] == k);
    }
}

static void the_distance_is_symmetric(void **state)
{
    (void)state;
    static dna p, q;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_shape();
        const uint32_t mass = random_mass();
        random_dna(&p, bins, mass);
        random_dna(&q, bins, mass);
        double forth[NEURONS_MOST], back[NEURONS_MOST];
        distances(&p, &q, forth);
        distances(&q, &p, back);
        CHECK(memcmp(forth, back, neurons * sizeof *forth) == 0);
        for (uint32_t n = 0; n < neurons; n++)
            CHECK(forth[n] >= 0 && forth[n] <= bins - 1);
    }
}

/* The integer before division: emd * mass_p * mass_q, exact for masses up to SMALL_MASS. */
static uint64_t sum_of(double emd, uint32_t mass_p, uint32_t mass_q)
{
    return (uint64_t)(emd * mass_p * mass_q + 0.5);
}

/* Small masses exactly, in whole numbers: with d = sum / (mass * mass), multiply d(p, r) <= d(p, q)
 * + d(q, r) by all three masses. Large masses with a tolerance for the three roundings. */
static void the_triangle_inequality_holds(void **state)
{
    (void)state;
    static dna p, q, r;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_shape();
        const uint32_t mass = random_mass();
        random_dna(&p, bins, mass);
        random_dna(&q, bins, mass);
        random_dna(&r, bins, mass);
        double pq[NEURONS_MOST], qr[NEURONS_MOST], pr[NEURONS_MOST];
        distances(&p, &q, pq);
        distances(&q, &r, qr);
        distances(&p, &r, pr);
        for (uint32_t n = 0; n < neurons; n++) {
            const uint32_t m_p = p.mass[n], m_q = q.mass[n], m_r = r.mass[n];
            CHECK(pr[n] <= (pq[n] + qr[n]) * (1 + 4 * ROUNDING));
            if (mass == SMALL_MASS)
                CHECK(sum_of(pr[n], m_p, m_r) * m_q <=
                      sum_of(pq[n], m_p, m_q) * m_r + sum_of(qr[n], m_q, m_r) * m_p);
        }
    }
}

static int same_shares(const dna *p, const dna *q, uint32_t n)
{
    for (uint32_t b = 0; b < bins; b++)
        if ((uint64_t)p->counts[b * neurons + n] * q->mass[n] !=
            (uint64_t)q->counts[b * neurons + n] * p->mass[n])
            return 0;
    return 1;
}

/* The second histogram is the first times a factor, in half of the neurons with one sample moved
 * by one bin: the least that can differ. */
static void the_distance_is_zero_if_and_only_if_the_shares_are_equal(void **state)
{
    (void)state;
    static dna p, q;
    uint32_t zeros = 0;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_shape();
        const uint32_t factor = 1 + random_below(5);
        random_dna(&p, bins, random_below(2) ? SMALL_MASS : largest_mass() / 5);
        q = p;
        for (uint32_t i = 0; i < bins * neurons; i++)
            q.counts[i] *= factor;
        for (uint32_t n = 0; n < neurons; n++) {
            q.mass[n] *= factor;
            uint32_t *count = q.counts + random_below(bins - 1) * neurons + n;
            if (random_below(2) && *count > 0) {
                count[0]--;
                count[neurons]++;
            }
        }
        double emd[NEURONS_MOST];
        distances(&p, &q, emd);
        for (uint32_t n = 0; n < neurons; n++) {
            CHECK((emd[n] == 0) == same_shares(&p, &q, n));
            zeros += emd[n] == 0;
        }
    }
    assert_true(zeros > CASES);
}

/* ---- Bounds ---- */

enum { CANDIDATES = 6, SUMS_MOST = NEURONS_MOST * (BINS_MOST / 25) };

static int64_t scratch[2 * NEURONS_MOST + SUMS_MOST / 2];
static dna live, candidates[CANDIDATES];
static uint32_t sums[CANDIDATES * SUMS_MOST];
static size_t sums_size; /* bytes of one */

/* Candidates near one another, some the same. */
static void random_candidates(void)
{
    random_shape();
    const uint32_t mass = random_below(2) ? SMALL_MASS : 90000000, width = 1 + random_below(bins);
    random_dna(&live, bins, mass);
    sums_size = vdna_bounds_size(neurons, bins);
    for (uint32_t i = 0; i < CANDIDATES; i++) {
        random_dna(&candidates[i], width, mass);
        if (random_below(3) == 0)
            candidates[i] = candidates[random_below(i + 1)];
        const vdna_hist_view view = view_of(&candidates[i]);
        CHECK(vdna_bounds_sum(&view, scratch, sizeof scratch,
                              sums + i * (sums_size / sizeof *sums)) == VDNA_OK);
    }
}

static void a_bound_never_passes_the_distance(void **state)
{
    (void)state;
    uint32_t below = 0;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_candidates();
        const uint32_t *const second = sums + sums_size / sizeof *sums;
        const vdna_hist_view p = view_of(&candidates[0]), q = view_of(&candidates[1]);
        double bound = -1, of_sums = -1, distance = -1;
        CHECK(vdna_bounds_mean(&p, sums, &q, second, scratch, sizeof scratch, &bound) == VDNA_OK);
        CHECK(vdna_bounds_from_sums(sums, p.mass, second, q.mass, neurons, bins, scratch,
                                    sizeof scratch, &of_sums) == VDNA_OK);
        CHECK(of_sums == bound);
        CHECK(vdna_emd_mean(&p, &q, scratch, sizeof scratch, &distance) == VDNA_OK);
        CHECK(bound >= 0 && bound <= distance);
        below += bound < distance;
    }
    assert_true(below > CASES / 10 && below < CASES);
}

/* How many distances vdna_rank_top() computed, `ranking` being of vdna_rank(). */
static uint32_t check_top(const vdna_hist_view *views, uint32_t exact,
                          const vdna_rank_entry *ranking)
{
    const vdna_hist_view view = view_of(&live);
    vdna_rank_entry top[CANDIDATES];
    uint8_t is_bound[CANDIDATES];
    CHECK(vdna_rank_top(&view, views, sums, CANDIDATES, exact, scratch, sizeof scratch, top,
                        is_bound) == VDNA_OK);
    uint32_t found = 0, computed = 0;
    for (uint32_t i = 0; i < CANDIDATES; i++) {
        double distance = -1;
        CHECK(vdna_emd_mean(&view, &views[top[i].candidate], scratch, sizeof scratch, &distance) ==
              VDNA_OK);
        CHECK(is_bound[top[i].candidate] ? top[i].distance_bins <= distance && !top[i].tied
                                         : top[i].distance_bins == distance);
        CHECK(i == 0 || top[i - 1].distance_bins <= top[i].distance_bins);
        if (i < exact)
            CHECK(memcmp(&top[i], &ranking[i], sizeof *top) == 0 && !is_bound[top[i].candidate]);
        found |= 1u << top[i].candidate;
        computed += !is_bound[top[i].candidate];
    }
    CHECK(found == (1u << CANDIDATES) - 1);
    return computed;
}

static void the_top_of_a_ranking_is_that_of_the_whole(void **state)
{
    (void)state;
    uint32_t computed = 0, computed_of_all = 0;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_candidates();
        const vdna_hist_view view = view_of(&live);
        vdna_hist_view views[CANDIDATES];
        for (uint32_t i = 0; i < CANDIDATES; i++)
            views[i] = view_of(&candidates[i]);
        vdna_rank_entry ranking[CANDIDATES];
        CHECK(vdna_rank(&view, views, CANDIDATES, scratch, sizeof scratch, ranking) == VDNA_OK);
        computed += check_top(views, 1 + random_below(3), ranking);
        computed_of_all += check_top(views, CANDIDATES + random_below(2), ranking);
    }
    assert_int_equal(computed_of_all, CASES * CANDIDATES);
    assert_true(computed < computed_of_all / 4 * 3);
}

/* ---- Histograms of frames ---- */

enum { FRAMES_MOST = 12, SAMPLES_MOST = 6, HIST_BINS_MOST = 33 };
enum { VALUES_MOST = NEURONS_MOST * SAMPLES_MOST };
enum { WORDS = NEURONS_MOST * (HIST_BINS_MOST + 2) };

static float frames[FRAMES_MOST][VALUES_MOST], range[2 * NEURONS_MOST];
static uint32_t frame_count, samples;

typedef struct counted {
    vdna_hist hist;
    uint32_t mem[WORDS];
} counted;

static void empty(counted *c)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = neurons;
    config.bins = bins;
    config.range = range;
    memset(c->mem, 0, sizeof c->mem);
    CHECK(vdna_hist_init(&config, c->mem, sizeof c->mem, &c->hist) == VDNA_OK);
}

static void add_values(counted *c, const float *values, uint32_t count, uint32_t layout)
{
    const vdna_activations tap = {values, neurons, count, layout};
    CHECK(vdna_hist_add(&c->hist, &tap, 1) == VDNA_OK);
}

static void add(counted *c, uint32_t frame)
{
    add_values(c, frames[frame], samples, VDNA_LAYOUT_SAMPLES_NEURONS);
}

static int same(const counted *a, const counted *b)
{
    return memcmp(a->mem, b->mem, sizeof a->mem) == 0 && a->hist.frames == b->hist.frames;
}

/* Ranges from tiny to huge, about zero or far from it; values inside, on the edges and beyond. */
static void random_frames(void)
{
    neurons = 1 + random_below(NEURONS_MOST);
    bins = 2 + random_below(HIST_BINS_MOST - 1);
    samples = 1 + random_below(SAMPLES_MOST);
    frame_count = 2 + random_below(FRAMES_MOST - 1);
    for (uint32_t n = 0; n < neurons; n++) {
        const double width = ldexp(1 + random_below(9), (int)random_below(120) - 60);
        const double lo = random_below(2) ? -width * random_below(2) : width * random_below(1000);
        range[2 * n] = (float)lo;
        range[2 * n + 1] = (float)(lo + width);
    }
    for (uint32_t f = 0; f < frame_count; f++)
        for (uint32_t i = 0; i < neurons * samples; i++) {
            const float *lo_hi = range + 2 * (i % neurons);
            const float at = (float)((int)random_below(2 * bins) - (int)bins / 2) / (float)bins;
            frames[f][i] = lo_hi[0] + at * (lo_hi[1] - lo_hi[0]);
        }
}

static void merging_commutes_and_associates_and_subtracting_undoes_it(void **state)
{
    (void)state;
    static counted a, b, c, ab, ba, bc, left, right;
    for (uint32_t number = 0; number < CASES; number++) {
        begin_case(number);
        random_frames();
        empty(&a), empty(&b), empty(&c), empty(&ab), empty(&ba), empty(&bc), empty(&left);
        empty(&right);
        counted *parts[] = {&a, &b, &c};
        for (uint32_t f = 0; f < frame_count; f++)
            add(parts[random_below(3)], f);

        CHECK(vdna_hist_merge(&ab.hist, &a.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&ab.hist, &b.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&ba.hist, &b.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&ba.hist, &a.hist) == VDNA_OK);
        CHECK(same(&ab, &ba));

        CHECK(vdna_hist_merge(&left.hist, &ab.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&left.hist, &c.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&bc.hist, &b.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&bc.hist, &c.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&right.hist, &a.hist) == VDNA_OK);
        CHECK(vdna_hist_merge(&right.hist, &bc.hist) == VDNA_OK);
        CHECK(same(&left, &right));

        CHECK(vdna_hist_subtract(&left.hist, &c.hist) == VDNA_OK);
        CHECK(same(&left, &ab));
        CHECK(vdna_hist_subtract(&right.hist, &right.hist) == VDNA_OK);
        empty(&left);
        CHECK(same(&right, &left));
    }
}

static void shuffle(uint32_t *order, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        order[i] = i;
    for (uint32_t i = count; i > 1; i--) {
        const uint32_t j = random_below(i), kept = order[i - 1];
        order[i - 1] = order[j];
        order[j] = kept;
    }
}

static void the_order_of_frames_and_their_division_into_parts_change_nothing(void **state)
{
    (void)state;
    static counted all, parts[3], merged;
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_frames();
        empty(&all), empty(&merged);
        for (uint32_t f = 0; f < frame_count; f++)
            add(&all, f);

        uint32_t order[FRAMES_MOST];
        shuffle(order, frame_count);
        for (int p = 0; p < 3; p++)
            empty(&parts[p]);
        for (uint32_t f = 0; f < frame_count; f++)
            add(&parts[random_below(3)], order[f]);
        for (int p = 0; p < 3; p++)
            CHECK(vdna_hist_merge(&merged.hist, &parts[p].hist) == VDNA_OK);
        CHECK(same(&all, &merged));
    }
}

/* Each sample as a frame of its own, and each frame in the other layout with its samples in
 * another order. */
static void how_samples_are_batched_and_laid_out_changes_nothing(void **state)
{
    (void)state;
    static counted all, singly, transposed;
    static float values[VALUES_MOST];
    for (uint32_t c = 0; c < CASES; c++) {
        begin_case(c);
        random_frames();
        empty(&all), empty(&singly), empty(&transposed);
        for (uint32_t f = 0; f < frame_count; f++) {
            uint32_t order[SAMPLES_MOST];
            shuffle(order, samples);
            add(&all, f);
            for (uint32_t s = 0; s < samples; s++) {
                add_values(&singly, frames[f] + s * neurons, 1, VDNA_LAYOUT_NEURONS_SAMPLES);
                for (uint32_t n = 0; n < neurons; n++)
                    values[n * samples + order[s]] = frames[f][s * neurons + n];
            }
            add_values(&transposed, values, samples, VDNA_LAYOUT_NEURONS_SAMPLES);
        }
        CHECK(same(&all, &transposed));
        CHECK(memcmp(all.mem, singly.mem, sizeof all.mem) == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_shift_by_k_bins_is_at_distance_k),
        cmocka_unit_test(the_distance_is_symmetric),
        cmocka_unit_test(the_triangle_inequality_holds),
        cmocka_unit_test(the_distance_is_zero_if_and_only_if_the_shares_are_equal),
        cmocka_unit_test(a_bound_never_passes_the_distance),
        cmocka_unit_test(the_top_of_a_ranking_is_that_of_the_whole),
        cmocka_unit_test(merging_commutes_and_associates_and_subtracting_undoes_it),
        cmocka_unit_test(the_order_of_frames_and_their_division_into_parts_change_nothing),
        cmocka_unit_test(how_samples_are_batched_and_laid_out_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
