#include <float.h>
#include <math.h>
#include <string.h>

#include <vdna/localise.h>

#include "cmocka_all.h"

enum { WORDS = 256 };
static int64_t mem[WORDS];

static vdna_localise_map_config config_of(const float *embeddings, uint32_t frames, uint32_t dim)
{
    vdna_localise_map_config config;
    vdna_localise_map_config_init(&config);
    config.frames = frames;
    config.dim = dim;
    config.embeddings = embeddings;
    return config;
}

static vdna_localise_map *map_of(const float *embeddings, uint32_t frames, uint32_t dim)
{
    const vdna_localise_map_config config = config_of(embeddings, frames, dim);
    vdna_localise_map *map = NULL;
    assert_int_equal(vdna_localise_map_init(&config, mem, sizeof mem, &map), VDNA_OK);
    return map;
}

static void the_defaults_are_those_of_the_header(void **state)
{
    (void)state;
    const vdna_localise_map_config config = config_of(NULL, 0, 0);
    assert_int_equal(config.struct_size, sizeof config);
    assert_int_equal(config.centred, 1);
    vdna_localise_map_config_init(NULL);
}

static void the_mean_is_that_of_the_frames(void **state)
{
    (void)state;
    const float embeddings[] = {1, 10, 2, 20, 6, 0};
    const double *mean = vdna_localise_map_mean(map_of(embeddings, 3, 2));
    assert_true(mean[0] == 3 && mean[1] == 10);
    assert_null(vdna_localise_map_mean(NULL));
}

static void the_mean_is_0_unless_centred(void **state)
{
    (void)state;
    const float embeddings[] = {1, 10, 2, 20};
    vdna_localise_map_config config = config_of(embeddings, 2, 2);
    config.centred = 0;
    vdna_localise_map *map;
    assert_int_equal(vdna_localise_map_init(&config, mem, sizeof mem, &map), VDNA_OK);
    const double *mean = vdna_localise_map_mean(map);
    assert_true(mean[0] == 0 && mean[1] == 0);
}

static void the_step_is_the_median_of_neighbours(void **state)
{
    (void)state;
    const float odd[] = {0, 3, 4, 14}; /* steps 3, 1, 10 */
    assert_true(vdna_localise_map_step(map_of(odd, 4, 1)) == 3);
    const float even[] = {0, 3, 4, 14, 19}; /* and 5 */
    assert_true(vdna_localise_map_step(map_of(even, 5, 1)) == 4);
    const float diagonal[] = {0, 0, 3, 4}; /* 5 */
    assert_true(fabs(vdna_localise_map_step(map_of(diagonal, 2, 2)) - 5) < 1e-6);
    assert_true(vdna_localise_map_step(NULL) == 0);
}

static void frames_that_do_not_differ_have_no_step(void **state)
{
    (void)state;
    const float one[] = {7, 8}, alike[] = {0.1f, 0.7f, 0.1f, 0.7f, 0.1f, 0.7f};
    assert_true(vdna_localise_map_step(map_of(one, 1, 2)) == 0);
    assert_true(vdna_localise_map_step(map_of(alike, 3, 2)) == 0);
}

static void the_greatest_numbers_are_taken(void **state)
{
    (void)state;
    const float embeddings[] = {FLT_MAX, -FLT_MAX, -FLT_MAX, FLT_MAX, FLT_MAX, 1};
    assert_true(vdna_localise_map_step(map_of(embeddings, 3, 2)) == FLT_MAX);
}

static void a_number_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        float embeddings[] = {1, 2, 3, 4};
        embeddings[i] = bad[i];
        const vdna_localise_map_config config = config_of(embeddings, 2, 2);
        vdna_localise_map *map = NULL;
        assert_int_equal(vdna_localise_map_init(&config, mem, sizeof mem, &map),
                         VDNA_ERR_NONFINITE);
        assert_null(map);
    }
}

static void assert_refused(vdna_localise_map_config config, int is_shape)
{
    vdna_localise_map *map = NULL;
    assert_int_equal(vdna_localise_map_init(&config, mem, sizeof mem, &map), VDNA_ERR_ARG);
    assert_null(map);
    if (is_shape)
        assert_int_equal(vdna_localise_map_mem_size(&config), 0);
}

static void a_field_that_breaks_its_rule_is_refused(void **state)
{
    (void)state;
    static const float embeddings[4];
    const vdna_localise_map_config good = config_of(embeddings, 2, 2);
    vdna_localise_map_config bad = good;
    bad.frames = 0;
    assert_refused(bad, 1);
    bad = good;
    bad.dim = 0;
    assert_refused(bad, 1);
    bad.dim = VDNA_LOCALISE_DIM_MAX + 1;
    assert_refused(bad, 1);
    bad = good;
    bad.centred = 2;
    assert_refused(bad, 1);
    bad = good;
    bad.struct_size--;
    assert_refused(bad, 1);
    bad = good;
    bad.embeddings = NULL;
    assert_refused(bad, 0);
    assert_int_equal(vdna_localise_map_mem_size(NULL), 0);
}

static void a_block_that_does_not_do_is_refused(void **state)
{
    (void)state;
    static const float embeddings[3 * 3];
    const vdna_localise_map_config config = config_of(embeddings, 3, 3);
    const size_t size = vdna_localise_map_mem_size(&config);
    vdna_localise_map *map = NULL;
    assert_int_equal(vdna_localise_map_init(&config, mem, size - 1, &map), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_localise_map_init(&config, NULL, size, &map), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_map_init(&config, (char *)mem + 4, size, &map), VDNA_ERR_ARG);
    assert_int_equal(vdna_localise_map_init(&config, mem, size, NULL), VDNA_ERR_ARG);
    assert_null(map);

    mem[size / sizeof *mem + 1] = 42;
    assert_int_equal(vdna_localise_map_init(&config, mem, size, &map), VDNA_OK);
    assert_int_equal(mem[size / sizeof *mem + 1], 42);
}

static void the_largest_dimension_takes_two_bytes_a_number(void **state)
{
    (void)state;
    vdna_localise_map_config config = config_of(NULL, 1000, VDNA_LOCALISE_DIM_MAX);
    const size_t fewer = vdna_localise_map_mem_size(&config);
    config.frames++;
    assert_int_equal(vdna_localise_map_mem_size(&config) - fewer, 2 * VDNA_LOCALISE_DIM_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_defaults_are_those_of_the_header),
        cmocka_unit_test(the_mean_is_that_of_the_frames),
        cmocka_unit_test(the_mean_is_0_unless_centred),
        cmocka_unit_test(the_step_is_the_median_of_neighbours),
        cmocka_unit_test(frames_that_do_not_differ_have_no_step),
        cmocka_unit_test(the_greatest_numbers_are_taken),
        cmocka_unit_test(a_number_that_is_not_finite_is_refused),
        cmocka_unit_test(a_field_that_breaks_its_rule_is_refused),
        cmocka_unit_test(a_block_that_does_not_do_is_refused),
        cmocka_unit_test(the_largest_dimension_takes_two_bytes_a_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
