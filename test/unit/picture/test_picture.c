/* The C ABI of lib/picture. */
#include <string.h>

#include <vdna/picture.h>

#include "cmocka_all.h"

static const uint8_t two_pixels[] = {1, 2, 3, 4, 5, 6};
static const vdna_image small = {two_pixels, sizeof two_pixels, 2, 1, 0, VDNA_PIXEL_RGB3};

static void pixels_in_a_format_of_ours_are_borrowed_from_the_image(void **state)
{
    (void)state;
    vdna_decoder *decoder = NULL;
    vdna_pixels pixels;
    assert_int_equal(vdna_decoder_open(2, NULL, &decoder), VDNA_OK);
    assert_int_equal(vdna_decoder_decode(decoder, &small, NULL, &pixels), VDNA_OK);
    assert_ptr_equal(pixels.data, two_pixels);
    assert_int_equal(pixels.stride, 6);
    assert_int_equal(pixels.width, 2);
    assert_int_equal(pixels.height, 1);
    assert_int_equal(pixels.channels, 3);
    for (uint32_t c = 0; c < 3; c++)
        assert_int_equal(pixels.rgb[c], c);
    /* 0.299 * 2.5 + 0.587 * 3.5 + 0.114 * 4.5 */
    assert_float_equal(vdna_pixels_mean_grey(&pixels), 3.315f, 1e-5f);
    vdna_decoder_close(decoder);
}

static void a_reduced_picture_in_a_raw_format_is_the_same(void **state)
{
    (void)state;
    vdna_decoder *decoder = NULL;
    vdna_pixels pixels, reduced;
    memset(&pixels, 0, sizeof pixels);
    memset(&reduced, 0, sizeof reduced);
    assert_int_equal(vdna_decoder_open(2, NULL, &decoder), VDNA_OK);
    assert_int_equal(vdna_decoder_decode(decoder, &small, NULL, &pixels), VDNA_OK);
    assert_int_equal(vdna_decoder_decode_reduced(decoder, &small, 1, 1, NULL, &reduced), VDNA_OK);
    assert_memory_equal(&pixels, &reduced, sizeof pixels);
    vdna_decoder_close(decoder);
}

static void what_cannot_be_decoded_leaves_the_pixels_and_fills_the_error(void **state)
{
    (void)state;
    vdna_decoder *decoder = NULL;
    assert_int_equal(vdna_decoder_open(1, NULL, &decoder), VDNA_OK);
    vdna_pixels pixels, before;
    memset(&pixels, 0x5A, sizeof pixels);
    before = pixels;
    vdna_error error = {""};
    assert_int_equal(vdna_decoder_decode(decoder, &small, &error, &pixels), VDNA_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, "2x1 pixels are too many"));
    vdna_image cut = small;
    cut.width = 1;
    cut.size = 2;
    assert_int_equal(vdna_decoder_decode_reduced(decoder, &cut, 1, 1, NULL, &pixels),
                     VDNA_ERR_FORMAT);
    assert_int_equal(vdna_decoder_decode(decoder, &cut, &error, &pixels), VDNA_ERR_FORMAT);
    assert_non_null(strstr(error.text, "expected at least 3 bytes"));
    assert_memory_equal(&pixels, &before, sizeof pixels);
    vdna_decoder_close(decoder);
}

static void arguments_out_of_range_are_refused(void **state)
{
    (void)state;
    vdna_decoder *decoder = NULL;
    vdna_error error = {""};
    vdna_pixels pixels;
    assert_int_equal(vdna_decoder_open(0, &error, &decoder), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_open(VDNA_IMAGE_PIXELS_MAX + 1, &error, &decoder), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_open(1, &error, NULL), VDNA_ERR_ARG);
    assert_null(decoder);
    assert_non_null(strstr(error.text, "1 to 67108864 pixels"));

    assert_int_equal(vdna_decoder_open(2, NULL, &decoder), VDNA_OK);
    assert_int_equal(vdna_decoder_decode(NULL, &small, NULL, &pixels), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_decode(decoder, NULL, NULL, &pixels), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_decode(decoder, &small, NULL, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_decode_reduced(NULL, &small, 1, 1, NULL, &pixels), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_decode_reduced(decoder, NULL, 1, 1, NULL, &pixels), VDNA_ERR_ARG);
    assert_int_equal(vdna_decoder_decode_reduced(decoder, &small, 1, 1, NULL, NULL), VDNA_ERR_ARG);
    vdna_decoder_close(decoder);
    vdna_decoder_close(NULL);
    assert_true(vdna_pixels_mean_grey(NULL) == 0.0f);
}

static void the_bound_of_memory_grows_by_nine_bytes_a_pixel(void **state)
{
    (void)state;
    /* 3 for the pixels, 6 for the coefficients of a progressive JPEG; the rest is a few rows. */
    const uint32_t pixels = 1920 * 1080;
    const uint64_t bytes = vdna_decoder_bytes_max(pixels);
    assert_in_range(bytes, 9u * pixels, 9u * pixels + (8u << 20));
    assert_in_range(vdna_decoder_bytes_max(2 * pixels) - bytes, 9u * pixels, 9u * pixels + 40000);
    assert_int_equal(vdna_decoder_bytes_max(0), 0);
    assert_int_equal(vdna_decoder_bytes_max(VDNA_IMAGE_PIXELS_MAX + 1), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_in_a_format_of_ours_are_borrowed_from_the_image),
        cmocka_unit_test(a_reduced_picture_in_a_raw_format_is_the_same),
        cmocka_unit_test(what_cannot_be_decoded_leaves_the_pixels_and_fills_the_error),
        cmocka_unit_test(arguments_out_of_range_are_refused),
        cmocka_unit_test(the_bound_of_memory_grows_by_nine_bytes_a_pixel),
    };
    return cmocka_run_group_tests_name("picture", tests, NULL, NULL);
}
