/* Parked cameras, on pictures small enough to check by hand. */
#include <string.h>

#include <vdna/parked.h>

#include "cmocka_all.h"

enum { WIDTH = 160, HEIGHT = 120, BLOCK = 10, COLUMNS = 16, LIMIT = 150 };

/* A view of one level with noise: block i of look `number` is `noise` hundredths lighter or not, by
 * a bit that no two looks have alike. */
static vdna_parked_picture view(uint32_t number, uint16_t level, uint16_t noise)
{
    vdna_parked_picture picture;
    for (uint32_t i = 0; i < VDNA_PARKED_BLOCKS; i++) {
        uint32_t bits = (number * 2654435761u) ^ (i * 2246822519u);
        bits = (bits ^ bits >> 15) * 2654435761u;
        picture.levels[i] = (uint16_t)(level + noise * (bits >> 31));
    }
    return picture;
}

static vdna_parked started(void)
{
    vdna_parked parked;
    assert_int_equal(vdna_parked_init(&parked, LIMIT), VDNA_OK);
    return parked;
}

static uint32_t look(vdna_parked *parked, uint32_t number, uint16_t level, uint16_t noise)
{
    const vdna_parked_picture picture = view(number, level, noise);
    return vdna_parked_look(parked, &picture);
}

/* A camera of this noise that has stood for a window, with its last look as the reference. */
static vdna_parked stood(uint16_t noise)
{
    vdna_parked parked = started();
    for (uint32_t i = 0; i < VDNA_PARKED_WINDOW; i++) {
        const int is_last = i == VDNA_PARKED_WINDOW - 1;
        assert_true(!look(&parked, i, 10000, noise) || is_last);
        vdna_parked_keep(&parked);
    }
    assert_true(parked.noise > 0);
    return parked;
}

static void blocks_are_summed_over_their_samples(void **state)
{
    (void)state;
    static uint8_t grey[HEIGHT][WIDTH];
    memset(grey, 0, sizeof grey);
    for (int y = 0; y < BLOCK; y++)
        memset(&grey[y][BLOCK], 255, BLOCK);
    grey[BLOCK][0] = 7;
    const vdna_pixels pixels = {grey[0], WIDTH, WIDTH, HEIGHT, 1, {0, 0, 0}};
    vdna_parked_picture picture;
    assert_int_equal(vdna_parked_measure(&pixels, &picture), VDNA_OK);
    assert_int_equal(picture.levels[0], 0);
    assert_int_equal(picture.levels[1], 25500);
    assert_int_equal(picture.levels[COLUMNS], 7);
    assert_int_equal(picture.levels[VDNA_PARKED_BLOCKS - 1], 0);
}

static void an_eighth_of_a_picture_measures_as_all_of_it(void **state)
{
    (void)state;
    static uint8_t all[480][640], eighth[60][80];
    for (int y = 0; y < 480; y++)
        for (int x = 0; x < 640; x++)
            all[y][x] = eighth[y / 8][x / 8] = (uint8_t)(x / 8 + y / 8);
    const vdna_pixels large = {all[0], 640, 640, 480, 1, {0, 0, 0}};
    const vdna_pixels small = {eighth[0], 80, 80, 60, 1, {0, 0, 0}};
    vdna_parked_picture a, b;
    assert_int_equal(vdna_parked_measure(&large, &a), VDNA_OK);
    assert_int_equal(vdna_parked_measure(&small, &b), VDNA_OK);
    assert_memory_equal(&a, &b, sizeof a);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    vdna_parked parked;
    vdna_parked_picture picture;
    static const uint8_t grey[4];
    const vdna_pixels none = {grey, 0, 0, 2, 1, {0, 0, 0}}, pixels = {grey, 2, 2, 2, 1, {0, 0, 0}};
    assert_int_equal(vdna_parked_init(NULL, LIMIT), VDNA_ERR_ARG);
    assert_int_equal(vdna_parked_init(&parked, VDNA_PARKED_LIMIT_MAX + 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_parked_measure(&none, &picture), VDNA_ERR_ARG);
    assert_int_equal(vdna_parked_measure(&pixels, NULL), VDNA_ERR_ARG);
}

static void the_noise_is_that_between_neighbours(void **state)
{
    (void)state;
    /* Half of the blocks differ between two looks, each by 20: 192 / 2 * 400. */
    const vdna_parked parked = stood(20);
    assert_in_range(parked.noise, 38400 * 9 / 10, 38400 * 11 / 10);
}

static void a_view_that_stands_is_parked_once_its_noise_is_known(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    for (uint32_t i = 100; i < 1000; i++)
        assert_int_equal(look(&parked, i, 10000, 20), 1);
}

/* The mean square of noise is 200, of the difference 2.25 times that at most: a shift of all levels
 * by 15 adds 225, one by 17 adds 289. */
static void a_change_beyond_the_noise_is_not_parked(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    assert_int_equal(look(&parked, 100, 10010, 20), 1);
    assert_int_equal(look(&parked, 101, 10020, 20), 0);
    assert_int_equal(look(&parked, 102, 9980, 20), 0);
}

static void slow_changes_add_up(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    uint32_t number = 100;
    uint16_t level = 10000;
    while (look(&parked, number, level, 20)) {
        number++;
        level++;
    }
    assert_in_range(level, 10012, 10019);
}

static void nothing_beyond_the_limit_is_parked(void **state)
{
    (void)state;
    /* A root mean square of 0.5 x 400 = 283 between looks, which is also the noise. */
    vdna_parked parked = stood(400);
    for (uint32_t i = 100; i < 200; i++)
        assert_int_equal(look(&parked, i, 10000, 400), 0);
}

static void motion_is_not_taken_for_noise(void **state)
{
    (void)state;
    vdna_parked parked = started();
    for (uint32_t i = 0; i < 10 * VDNA_PARKED_WINDOW; i++) {
        assert_int_equal(look(&parked, i, (uint16_t)(10000 + 5 * i), 20), 0);
        vdna_parked_keep(&parked);
    }
    assert_int_equal(parked.noise, 0);
}

static void a_frozen_picture_is_never_parked(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    assert_int_equal(look(&parked, 100, 10000, 20), 1);
    for (uint32_t i = 0; i < 100; i++) {
        assert_int_equal(look(&parked, 100, 10000, 20), 0);
        vdna_parked_keep(&parked);
    }
}

static void pictures_in_turn_are_parked_the_first_time_only(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    for (uint32_t i = 0; i < 10 * VDNA_PARKED_REMEMBERED; i++)
        assert_int_equal(look(&parked, 100 + i % VDNA_PARKED_REMEMBERED, 10000, 20),
                         i < VDNA_PARKED_REMEMBERED);
}

static void a_camera_without_noise_is_never_parked(void **state)
{
    (void)state;
    vdna_parked parked = started();
    for (uint32_t i = 0; i < 3 * VDNA_PARKED_WINDOW; i++) {
        assert_int_equal(look(&parked, i, 10000, 0), 0);
        vdna_parked_keep(&parked);
    }
    assert_int_equal(parked.noise, 0);
}

static void before_the_first_reference_nothing_is_parked(void **state)
{
    (void)state;
    vdna_parked parked = started();
    for (uint32_t i = 0; i < 2 * VDNA_PARKED_WINDOW; i++)
        assert_int_equal(look(&parked, i, 10000, 20), 0);
    assert_true(parked.noise > 0);
    vdna_parked_keep(&parked);
    assert_int_equal(look(&parked, 100, 10000, 20), 1);
}

static void after_a_drive_the_noise_is_measured_anew(void **state)
{
    (void)state;
    vdna_parked parked = stood(20);
    for (uint32_t i = 0; i < 3 * VDNA_PARKED_WINDOW; i++) {
        look(&parked, 1000 + i, 14000, 60);
        vdna_parked_keep(&parked);
    }
    assert_int_equal(look(&parked, 2000, 14000, 60), 1);
    assert_in_range(parked.noise, 9 * 38400 * 9 / 10, 9 * 38400 * 11 / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_summed_over_their_samples),
        cmocka_unit_test(an_eighth_of_a_picture_measures_as_all_of_it),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(the_noise_is_that_between_neighbours),
        cmocka_unit_test(a_view_that_stands_is_parked_once_its_noise_is_known),
        cmocka_unit_test(a_change_beyond_the_noise_is_not_parked),
        cmocka_unit_test(slow_changes_add_up),
        cmocka_unit_test(nothing_beyond_the_limit_is_parked),
        cmocka_unit_test(motion_is_not_taken_for_noise),
        cmocka_unit_test(a_frozen_picture_is_never_parked),
        cmocka_unit_test(pictures_in_turn_are_parked_the_first_time_only),
        cmocka_unit_test(a_camera_without_noise_is_never_parked),
        cmocka_unit_test(before_the_first_reference_nothing_is_parked),
        cmocka_unit_test(after_a_drive_the_noise_is_measured_anew),
    };
    return cmocka_run_group_tests_name("parked", tests, NULL, NULL);
}
