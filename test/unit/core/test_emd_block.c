/* Many pairs at once: the bits of vdna_emd_mean(), whatever the groups, tiles and masses. */
#include <stdlib.h>
#include <string.h>

#include <vdna/emd.h>

#include "cmocka_all.h"

enum { SIDE_MOST = 37 }; /* more than a group */

static uint64_t random_state;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(random_state >> 33) % limit;
}

static void *memory(size_t size)
{
    void *const block = calloc(1, size);
    assert_non_null(block);
    return block;
}

typedef struct side {
    vdna_hist_view views[SIDE_MOST];
    uint32_t count;
    float *range;
} side;

/* Histograms of random counts.
 * masses: of the first neurons, then of the last one */
static void fill(side *s, uint32_t count, uint32_t neurons, uint32_t bins, uint32_t mass,
                 uint32_t growth, uint32_t last_mass)
{
    s->count = count;
    s->range = memory(neurons * 2 * sizeof(float));
    for (uint32_t n = 0; n < neurons; n++)
        s->range[2 * n + 1] = 1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t *const counts = memory((size_t)neurons * bins * sizeof *counts);
        uint32_t *const masses = memory(neurons * sizeof *masses);
        for (uint32_t n = 0; n < neurons; n++) {
            masses[n] = n + 1 < neurons ? mass + growth * i : last_mass + growth * i;
            uint32_t left = masses[n];
            for (; left > 1 && random_below(4) > 0;) {
                const uint32_t some = 1 + random_below(left - 1);
                counts[(size_t)random_below(bins) * neurons + n] += some;
                left -= some;
            }
            counts[(size_t)random_below(bins) * neurons + n] += left;
        }
        const vdna_hist_view view = {s->range, counts, masses, neurons, bins};
        s->views[i] = view;
    }
}

static void empty(side *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        free((void *)(uintptr_t)s->views[i].counts);
        free((void *)(uintptr_t)s->views[i].mass);
    }
    free(s->range);
}

static void assert_pairs_have_the_bits_of_the_mean(const side *p, const side *q)
{
    const size_t size = vdna_emd_block_scratch_size(p->views[0].neurons);
    void *const scratch = memory(size);
    double *const distances = memory(sizeof(double) * SIDE_MOST * SIDE_MOST);
    assert_int_equal(
        vdna_emd_block(p->views, p->count, q->views, q->count, scratch, size, distances), VDNA_OK);
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t j = 0; j < q->count; j++) {
            double mean;
            assert_int_equal(vdna_emd_mean(&p->views[i], &q->views[j], scratch, size, &mean),
                             VDNA_OK);
            assert_memory_equal(&distances[i * q->count + j], &mean, sizeof mean);
        }
    free(distances);
    free(scratch);
}

static void every_pair_has_the_bits_of_the_mean(void **state)
{
    (void)state;
    static const struct {
        uint32_t count_p, count_q, neurons, bins, mass_p, mass_q, growth, last_mass;
    } cases[] = {
        {4, 4, 3, 10, 100, 1150, 0, 100},              /* all scaled alike */
        {5, 37, 129, 18, 100, 1150, 0, 100},           /* groups and tiles that are not whole */
        {33, 6, 128, 17, 7, 7, 0, 7},                  /* nothing to scale */
        {6, 7, 5, 26, 100, 1150, 1, 100},              /* each mass is another */
        {5, 5, 1, 2, 3, 1000003, 1, 3},                /* one neuron, two bins */
        {4, 5, 4, 9, 100, 90, 0, 40},                  /* two taps: one by one */
        {4, 4, 2, 1000, 1000003, 1000033, 0, 1000003}, /* sums of more than 32 bits */
        {3, 9, 6, 12, 50, 60, 0, 50},                  /* a few */
        {9, 3, 6, 12, 50, 60, 0, 50},
        {1, 1, 6, 12, 50, 60, 0, 50},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        random_state = c;
        side p, q;
        fill(&p, cases[c].count_p, cases[c].neurons, cases[c].bins, cases[c].mass_p,
             cases[c].growth, cases[c].last_mass);
        fill(&q, cases[c].count_q, cases[c].neurons, cases[c].bins, cases[c].mass_q, 0,
             cases[c].mass_q);
        assert_pairs_have_the_bits_of_the_mean(&p, &q);
        assert_pairs_have_the_bits_of_the_mean(&q, &p);
        empty(&p);
        empty(&q);
    }
}

static void what_does_not_compare_is_refused(void **state)
{
    (void)state;
    side p, q, wider;
    fill(&p, 4, 2, 5, 9, 0, 9);
    fill(&q, 4, 2, 5, 9, 0, 9);
    fill(&wider, 4, 2, 6, 9, 0, 9);
    const size_t size = vdna_emd_block_scratch_size(2);
    int64_t *const scratch = memory(size + sizeof *scratch);
    double distances[16];
    const vdna_hist_view *const a = p.views, *const b = q.views;
    assert_int_equal(vdna_emd_block(NULL, 4, b, 4, scratch, size, distances), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 0, b, 4, scratch, size, distances), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, NULL, 4, scratch, size, distances), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, b, 0, scratch, size, distances), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, b, 4, NULL, size, distances), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, b, 4, (char *)scratch + 1, size, distances),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, b, 4, scratch, size, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_block(a, 4, b, 4, scratch, size - 1, distances), VDNA_ERR_NOMEM);
    q.views[3] = wider.views[3];
    assert_int_equal(vdna_emd_block(a, 4, b, 4, scratch, size, distances), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_emd_block(b, 4, a, 4, scratch, size, distances), VDNA_ERR_MISMATCH);
    q.views[3] = p.views[3];
    empty(&wider);
    free(scratch);
    q.count = 3; /* the fourth is p's */
    empty(&q);
    empty(&p);
}

static void a_distance_that_overflows_is_refused(void **state)
{
    (void)state;
    static const float range[2] = {0, 1};
    uint32_t p_counts[1000] = {4294967291u}, q_counts[1000] = {0};
    q_counts[999] = 4294967279u; /* two primes */
    const uint32_t masses[2] = {4294967291u, 4294967279u};
    const vdna_hist_view p = {range, p_counts, &masses[0], 1, 1000};
    const vdna_hist_view q = {range, q_counts, &masses[1], 1, 1000};
    const size_t size = vdna_emd_block_scratch_size(1);
    void *const scratch = memory(size);
    double distance;
    assert_int_equal(vdna_emd_block(&p, 1, &q, 1, scratch, size, &distance), VDNA_ERR_OVERFLOW);
    free(scratch);
}

static void its_memory_is_that_of_a_distance_if_that_needs_more(void **state)
{
    (void)state;
    assert_int_equal(vdna_emd_block_scratch_size(0), 0);
    assert_int_equal(vdna_emd_block_scratch_size(1), vdna_emd_block_scratch_size(1280));
    assert_int_equal(vdna_emd_block_scratch_size(1000000), vdna_emd_scratch_size(1000000));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pair_has_the_bits_of_the_mean),
        cmocka_unit_test(what_does_not_compare_is_refused),
        cmocka_unit_test(a_distance_that_overflows_is_refused),
        cmocka_unit_test(its_memory_is_that_of_a_distance_if_that_needs_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
