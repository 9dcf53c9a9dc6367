/* Frame health on pictures small enough to check by hand. */
#include <stdlib.h>
#include <string.h>

#include <vdna/health.h>

#include "cmocka_all.h"

/* One pixel for each sample, grey: block (c, r) is the 10 x 10 pixels from (10 c, 10 r). */
enum { WIDTH = 160, HEIGHT = 120, BLOCK = 10, COLUMNS = 16, ROWS = 12 };

typedef struct canvas {
    uint8_t grey[HEIGHT][WIDTH];
} canvas;

static vdna_pixels pixels_of(const canvas *c)
{
    const vdna_pixels pixels = {c->grey[0], WIDTH, WIDTH, HEIGHT, 1, {0, 0, 0}};
    return pixels;
}

static vdna_health_picture measured(const vdna_pixels *pixels)
{
    vdna_health_picture picture;
    assert_int_equal(vdna_health_measure(pixels, &picture), VDNA_OK);
    return picture;
}

static vdna_health_picture measure(const canvas *c)
{
    const vdna_pixels pixels = pixels_of(c);
    return measured(&pixels);
}

static void fill(canvas *c, uint8_t level)
{
    memset(c->grey, level, sizeof c->grey);
}

static void fill_block(canvas *c, int column, int row, uint8_t level)
{
    for (int y = 0; y < BLOCK; y++)
        memset(&c->grey[row * BLOCK + y][column * BLOCK], level, BLOCK);
}

/* The left half black, the right half of this level. */
static void fill_halves(canvas *c, uint8_t right)
{
    fill(c, 0);
    for (int y = 0; y < HEIGHT; y++)
        memset(&c->grey[y][WIDTH / 2], right, WIDTH / 2);
}

static vdna_health started(const vdna_health_config *config)
{
    vdna_health health;
    assert_int_equal(vdna_health_init(&health, config), VDNA_OK);
    return health;
}

static vdna_health_config defaults(void)
{
    vdna_health_config config;
    config.struct_size = sizeof config;
    vdna_health_config_init(&config);
    return config;
}

/* A usable picture; another `number`, another picture. */
static vdna_health_picture usable(uint64_t number)
{
    const vdna_health_picture picture = {number, 640, 480, 128, 100, 30, 20, 0, 0};
    return picture;
}

static uint32_t take(vdna_health *health, uint64_t number)
{
    const vdna_health_picture picture = usable(number);
    return vdna_health_take(health, &picture);
}

static void one_grey_level_has_no_contrast(void **state)
{
    (void)state;
    canvas c;
    fill(&c, 77);
    const vdna_health_picture picture = measure(&c);
    assert_int_equal(picture.width, WIDTH);
    assert_int_equal(picture.height, HEIGHT);
    assert_int_equal(picture.mean, 77);
    assert_int_equal(picture.contrast, 0);
    assert_int_equal(picture.structure, 0);
    assert_int_equal(picture.grain, 1);
    assert_int_equal(picture.bright, 0);
}

/* Two halves of 0 and 200 lie 100 from the mean. Of the 15 * 12 + 16 * 11 = 356 pairs of
 * neighbours, 12 are of different halves: covariance 10000 * (344 - 12) / 356 = 9325. */
static void two_halves_have_structure_and_the_least_grain(void **state)
{
    (void)state;
    canvas c;
    fill_halves(&c, 200);
    const vdna_health_picture picture = measure(&c);
    assert_int_equal(picture.mean, 100);
    assert_int_equal(picture.contrast, 200);
    assert_int_equal(picture.structure, 96); /* 96^2 = 9216, 97^2 = 9409 */
    assert_int_equal(picture.grain, 1);
}

/* A fine pattern of 0 and 200: each block has mean 100 and deviation 100. */
static void a_fine_pattern_has_grain_and_no_structure(void **state)
{
    (void)state;
    canvas c;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            c.grey[y][x] = (x + y) % 2 ? 200 : 0;
    const vdna_health_picture picture = measure(&c);
    assert_int_equal(picture.mean, 100);
    assert_int_equal(picture.contrast, 0);
    assert_int_equal(picture.structure, 0);
    assert_int_equal(picture.grain, 100);
}

/* Neighbours that always differ have a negative covariance. */
static void a_chessboard_of_blocks_has_no_structure(void **state)
{
    (void)state;
    canvas c;
    for (int row = 0; row < ROWS; row++)
        for (int column = 0; column < COLUMNS; column++)
            fill_block(&c, column, row, (column + row) % 2 ? 200 : 0);
    const vdna_health_picture picture = measure(&c);
    assert_int_equal(picture.contrast, 200);
    assert_int_equal(picture.structure, 0);
}

static void three_light_blocks_are_no_contrast_and_four_are(void **state)
{
    (void)state;
    canvas c;
    fill(&c, 10);
    for (int i = 0; i < 3; i++)
        fill_block(&c, 4 * i, 2, 210);
    assert_int_equal(measure(&c).contrast, 0);
    fill_block(&c, 12, 2, 210);
    assert_int_equal(measure(&c).contrast, 200);
}

/* Three of five rows of blocks: 36 of 192 blocks are light. */
static void bright_samples_are_counted_per_thousand(void **state)
{
    (void)state;
    canvas c;
    fill(&c, 249);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 12; column++)
            fill_block(&c, column, row, 250);
    assert_int_equal(measure(&c).bright, 187); /* 36 / 192 = 0.1875 */
    fill(&c, 255);
    assert_int_equal(measure(&c).bright, 1000);
}

static void colours_become_grey_in_any_order_of_bytes(void **state)
{
    (void)state;
    static const struct {
        uint8_t bytes[4];
        uint32_t channels, rgb[3];
    } orders[] = {{{200, 100, 50, 0}, 3, {0, 1, 2}},
                  {{50, 100, 200, 0}, 3, {2, 1, 0}},
                  {{9, 200, 100, 50}, 4, {1, 2, 3}}};
    for (size_t o = 0; o < sizeof orders / sizeof *orders; o++) {
        const uint32_t channels = orders[o].channels, *rgb = orders[o].rgb;
        const vdna_pixels pixels = {orders[o].bytes,         channels, 1, 1, channels,
                                    {rgb[0], rgb[1], rgb[2]}};
        /* (77 * 200 + 150 * 100 + 29 * 50 + 128) / 256 = 124.9 */
        assert_int_equal(measured(&pixels).mean, 124);
    }
}

static void every_pixel_counts_for_the_hash_and_no_padding_does(void **state)
{
    (void)state;
    enum { W = 13, H = 7, STRIDE = 45, CHANNELS = 3 };
    uint8_t padded[H * STRIDE], packed[H * W * CHANNELS];
    for (size_t i = 0; i < sizeof padded; i++)
        padded[i] = (uint8_t)(i * 37);
    for (size_t y = 0; y < H; y++)
        memcpy(packed + y * W * CHANNELS, padded + y * STRIDE, (size_t)W * CHANNELS);
    const vdna_pixels first = {padded, STRIDE, W, H, CHANNELS, {0, 1, 2}};
    const vdna_pixels second = {packed, (size_t)W * CHANNELS, W, H, CHANNELS, {0, 1, 2}};
    const uint64_t hash = measured(&first).hash;
    assert_true(measured(&second).hash == hash);
    for (size_t i = 0; i < sizeof packed; i++)
        for (int bit = 0; bit < 8; bit++) {
            packed[i] ^= (uint8_t)(1u << bit);
            assert_true(measured(&second).hash != hash);
            packed[i] ^= (uint8_t)(1u << bit);
        }
}

/* Words 0 and 4 follow one another in a lane: the second bit undoes the first in a hash that does
 * not bring high bits down. */
static void two_changed_bits_do_not_cancel(void **state)
{
    (void)state;
    uint8_t row[64] = {0};
    const vdna_pixels pixels = {row, sizeof row, sizeof row, 1, 1, {0, 0, 0}};
    const uint64_t hash = measured(&pixels).hash;
    for (size_t i = 0; i < 64; i++)
        for (size_t j = 0; j < 64; j++) {
            row[i / 8] = (uint8_t)(1u << i % 8);
            row[32 + j / 8] = (uint8_t)(1u << j % 8);
            assert_true(measured(&pixels).hash != hash);
            row[i / 8] = row[32 + j / 8] = 0;
        }
}

static void black_pictures_of_two_sizes_have_two_hashes(void **state)
{
    (void)state;
    const uint8_t black[64] = {0};
    const vdna_pixels wide = {black, 16, 16, 4, 1, {0, 0, 0}};
    const vdna_pixels high = {black, 4, 4, 16, 1, {0, 0, 0}};
    assert_true(measured(&wide).hash != measured(&high).hash);
}

/* The numbers are those of the header's definitions in Python. */
static void a_picture_has_the_same_measures_on_every_machine(void **state)
{
    (void)state;
    enum { W = 201, H = 77, CHANNELS = 3 };
    static uint8_t bgr[H][W][CHANNELS];
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int c = 0; c < CHANNELS; c++)
                bgr[y][x][c] = (uint8_t)(x * y / 8 + 50 * c + x);
    const vdna_pixels pixels = {bgr[0][0], (size_t)W * CHANNELS, W, H, CHANNELS, {2, 1, 0}};
    const vdna_health_picture picture = measured(&pixels);
    assert_true(picture.hash == UINT64_C(0xF593028C90F45146));
    assert_int_equal(picture.mean, 126);
    assert_int_equal(picture.contrast, 105);
    assert_int_equal(picture.structure, 5);
    assert_int_equal(picture.grain, 36);
    assert_int_equal(picture.bright, 0);
}

static void the_longest_sides_are_measured(void **state)
{
    (void)state;
    uint8_t *line = malloc(65535);
    assert_non_null(line);
    memset(line, 0, 65535);
    memset(line + 65535 / 2, 100, 65535 - 65535 / 2);
    const vdna_pixels wide = {line, 65535, 65535, 1, 1, {0, 0, 0}};
    assert_int_equal(measured(&wide).contrast, 100);
    const vdna_pixels high = {line, 1, 1, 65535, 1, {0, 0, 0}};
    assert_int_equal(measured(&high).contrast, 100);
    free(line);
}

static void pixels_that_cannot_be_are_refused(void **state)
{
    (void)state;
    const uint8_t byte = 0;
    const vdna_pixels good = {&byte, 4, 1, 1, 4, {0, 1, 2}};
    vdna_pixels bad[10];
    for (size_t i = 0; i < 10; i++)
        bad[i] = good;
    bad[0].data = NULL;
    bad[1].width = 0;
    bad[2].width = 65536;
    bad[3].height = 0;
    bad[4].height = 65536;
    bad[5].channels = 2;
    bad[6].rgb[0] = 4;
    bad[7].rgb[1] = 4;
    bad[8].rgb[2] = 4;
    bad[9].stride = 3;
    vdna_health_picture picture;
    memset(&picture, 7, sizeof picture);
    const vdna_health_picture before = picture;
    for (size_t i = 0; i < 10; i++)
        assert_int_equal(vdna_health_measure(&bad[i], &picture), VDNA_ERR_ARG);
    assert_int_equal(vdna_health_measure(NULL, &picture), VDNA_ERR_ARG);
    assert_int_equal(vdna_health_measure(&good, NULL), VDNA_ERR_ARG);
    assert_memory_equal(&picture, &before, sizeof picture);
}

static void each_limit_is_where_its_comment_says(void **state)
{
    (void)state;
    const vdna_health health = started(NULL);
    vdna_health_picture picture = usable(1);
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_OK);

    picture.width = picture.height = 32;
    picture.bright = 900;
    picture.contrast = 16;
    picture.structure = 10;
    picture.grain = 40;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_OK);
    picture.grain = 41;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_NOISE);
    picture.structure = 0;
    picture.grain = 1;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_NOISE);
    picture.contrast = 15;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_UNIFORM);
    picture.bright = 901;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_SATURATED);
    picture.width = 31;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_TOO_SMALL);
    picture.width = 32;
    picture.height = 31;
    assert_int_equal(vdna_health_judge(&health, &picture), VDNA_HEALTH_TOO_SMALL);
}

static void every_limit_can_be_turned_off(void **state)
{
    (void)state;
    vdna_health_config config = defaults();
    config.min_side = config.min_contrast = config.min_structure = 0;
    config.settle = config.remembered = 0;
    config.max_bright = 1000;
    vdna_health health = started(&config);
    const uint8_t pixel = 255;
    const vdna_pixels pixels = {&pixel, 1, 1, 1, 1, {0, 0, 0}};
    vdna_health_picture picture = measured(&pixels);
    for (uint32_t i = 0; i < 100; i++) {
        assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
        picture.width = i % 2 ? 4000 : 1;
    }
    picture.grain = 127;
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_OK);
}

static void the_same_picture_is_frozen_and_an_earlier_one_repeated(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    assert_int_equal(take(&health, 1), VDNA_HEALTH_OK);
    assert_int_equal(take(&health, 1), VDNA_HEALTH_FROZEN);
    assert_int_equal(take(&health, 2), VDNA_HEALTH_OK);
    assert_int_equal(take(&health, 1), VDNA_HEALTH_REPEATED);
    assert_int_equal(take(&health, 2), VDNA_HEALTH_REPEATED);
    assert_int_equal(health.counts[VDNA_HEALTH_OK], 2);
    assert_int_equal(health.counts[VDNA_HEALTH_FROZEN], 1);
    assert_int_equal(health.counts[VDNA_HEALTH_REPEATED], 2);
    assert_int_equal(health.frames, 5);
}

static void a_hash_of_zero_is_a_hash_like_others(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    assert_int_equal(take(&health, 0), VDNA_HEALTH_OK);
    assert_int_equal(take(&health, 0), VDNA_HEALTH_FROZEN);
}

static void the_newest_pictures_are_remembered(void **state)
{
    (void)state;
    vdna_health_config config = defaults();
    config.remembered = 3;
    vdna_health health = started(&config);
    for (uint64_t number = 1; number <= 4; number++)
        assert_int_equal(take(&health, number), VDNA_HEALTH_OK);
    assert_int_equal(take(&health, 2), VDNA_HEALTH_REPEATED);
    assert_int_equal(take(&health, 1), VDNA_HEALTH_OK);
    assert_int_equal(take(&health, 2), VDNA_HEALTH_OK); /* 3, 4 and 1 were remembered */
    assert_int_equal(take(&health, 2), VDNA_HEALTH_FROZEN);
}

static void a_loop_of_as_many_pictures_as_are_remembered_is_seen(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    for (uint64_t i = 0; i < 3 * VDNA_HEALTH_REMEMBERED_MAX; i++)
        assert_int_equal(take(&health, i % VDNA_HEALTH_REMEMBERED_MAX),
                         i < VDNA_HEALTH_REMEMBERED_MAX ? VDNA_HEALTH_OK : VDNA_HEALTH_REPEATED);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_REPEATED);
}

static void a_new_size_settles_after_five_frames(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    vdna_health_picture picture = usable(1);
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
    picture.height = 319;
    for (int i = 0; i < 5; i++) {
        picture.hash++;
        assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_SIZE_CHANGED);
    }
    picture.hash++;
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
    picture.hash++;
    picture.width = 961;
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_SIZE_CHANGED);
}

static void another_crop_is_no_other_size(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    vdna_health_picture picture = usable(1);
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
    picture.hash++;
    picture.width = 960;
    picture.height = 320;
    assert_int_equal(vdna_health_take(&health, &picture), VDNA_HEALTH_OK);
}

static void a_faulty_frame_of_another_size_also_unsettles_it(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    assert_int_equal(take(&health, 1), VDNA_HEALTH_OK);
    vdna_health_picture small = usable(2);
    small.width = 8;
    assert_int_equal(vdna_health_take(&health, &small), VDNA_HEALTH_TOO_SMALL);
    assert_int_equal(take(&health, 3), VDNA_HEALTH_SIZE_CHANGED);
}

static void more_than_half_of_the_window_degrades(void **state)
{
    (void)state;
    vdna_health_config config = defaults();
    config.window = 4;
    vdna_health health = started(&config);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_OK); /* nothing came yet */
    take(&health, 1);
    take(&health, 1);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_OK); /* one of two */
    take(&health, 1);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_FROZEN); /* two of three */
    take(&health, 2);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_OK); /* two of four */
    take(&health, 3);
    take(&health, 4);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_OK); /* one of the last four */
}

static void the_most_frequent_fault_is_the_reason(void **state)
{
    (void)state;
    vdna_health health = started(NULL);
    vdna_health_picture black = usable(1);
    black.contrast = 0;
    vdna_health_picture noise = usable(2);
    noise.structure = 0;
    vdna_health_take(&health, &noise);
    vdna_health_take(&health, &black);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_UNIFORM); /* the first of equals */
    vdna_health_take(&health, &noise);
    assert_int_equal(vdna_health_degraded(&health), VDNA_HEALTH_NOISE);
}

static void configurations_out_of_limits_are_refused(void **state)
{
    (void)state;
    vdna_health health;
    memset(&health, 7, sizeof health);
    const vdna_health before = health;
    vdna_health_config bad[5] = {defaults(), defaults(), defaults(), defaults(), defaults()};
    bad[0].struct_size = 4;
    bad[1].remembered = VDNA_HEALTH_REMEMBERED_MAX + 1;
    bad[2].window = 0;
    bad[3].window = VDNA_HEALTH_WINDOW_MAX + 1;
    bad[4].max_resize = 99;
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(vdna_health_init(&health, &bad[i]), VDNA_ERR_ARG);
    assert_int_equal(vdna_health_init(NULL, NULL), VDNA_ERR_ARG);
    assert_memory_equal(&health, &before, sizeof health);
    vdna_health_config_init(NULL);
}

static void every_verdict_has_a_text_of_its_own(void **state)
{
    (void)state;
    for (uint32_t a = 0; a <= VDNA_HEALTH_COUNT; a++)
        for (uint32_t b = 0; b < a; b++)
            assert_string_not_equal(vdna_health_text(a), vdna_health_text(b));
    assert_string_equal(vdna_health_text(VDNA_HEALTH_OK), "ok");
    assert_string_equal(vdna_health_text(VDNA_HEALTH_REPEATED), "repeated");
    assert_string_equal(vdna_health_text(VDNA_HEALTH_COUNT), "unknown verdict");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_grey_level_has_no_contrast),
        cmocka_unit_test(two_halves_have_structure_and_the_least_grain),
        cmocka_unit_test(a_fine_pattern_has_grain_and_no_structure),
        cmocka_unit_test(a_chessboard_of_blocks_has_no_structure),
        cmocka_unit_test(three_light_blocks_are_no_contrast_and_four_are),
        cmocka_unit_test(bright_samples_are_counted_per_thousand),
        cmocka_unit_test(colours_become_grey_in_any_order_of_bytes),
        cmocka_unit_test(every_pixel_counts_for_the_hash_and_no_padding_does),
        cmocka_unit_test(two_changed_bits_do_not_cancel),
        cmocka_unit_test(black_pictures_of_two_sizes_have_two_hashes),
        cmocka_unit_test(a_picture_has_the_same_measures_on_every_machine),
        cmocka_unit_test(the_longest_sides_are_measured),
        cmocka_unit_test(pixels_that_cannot_be_are_refused),
        cmocka_unit_test(each_limit_is_where_its_comment_says),
        cmocka_unit_test(every_limit_can_be_turned_off),
        cmocka_unit_test(the_same_picture_is_frozen_and_an_earlier_one_repeated),
        cmocka_unit_test(a_hash_of_zero_is_a_hash_like_others),
        cmocka_unit_test(the_newest_pictures_are_remembered),
        cmocka_unit_test(a_loop_of_as_many_pictures_as_are_remembered_is_seen),
        cmocka_unit_test(a_new_size_settles_after_five_frames),
        cmocka_unit_test(another_crop_is_no_other_size),
        cmocka_unit_test(a_faulty_frame_of_another_size_also_unsettles_it),
        cmocka_unit_test(more_than_half_of_the_window_degrades),
        cmocka_unit_test(the_most_frequent_fault_is_the_reason),
        cmocka_unit_test(configurations_out_of_limits_are_refused),
        cmocka_unit_test(every_verdict_has_a_text_of_its_own),
    };
    return cmocka_run_group_tests_name("health", tests, NULL, NULL);
}
