// Orientation in EXIF: all values are read, and a damaged block states none.
#include <cstring>
#include <string>
#include <vector>

#include <cmocka.hpp>
#include <exif_block.hpp>

#include "picture/exif.h"

using Bytes = std::vector<uint8_t>;

// Copies to a block of exactly that size, so that a sanitizer sees a byte read past the end.
static uint32_t orientation_of(const Bytes &block)
{
    const Bytes exact(block);
    return vdna_exif_orientation(exact.data(), exact.size());
}

static uint32_t jpeg_orientation_of(const Bytes &jpeg)
{
    const Bytes exact(jpeg);
    return vdna_jpeg_orientation(exact.data(), exact.size());
}

static Bytes joined(std::initializer_list<Bytes> parts)
{
    Bytes all;
    for (const Bytes &part : parts)
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

// A segment of a JPEG picture: marker, length, content.
static Bytes segment(uint8_t marker, const Bytes &content)
{
    const size_t length = content.size() + 2;
    return joined(
        {{0xFF, marker, static_cast<uint8_t>(length >> 8), static_cast<uint8_t>(length)}, content});
}

static const Bytes start = {0xFF, 0xD8}, exif_name = {'E', 'x', 'i', 'f', 0, 0};

static void every_orientation_is_read_in_both_byte_orders(void **)
{
    for (uint8_t orientation = 1; orientation <= 8; orientation++)
        for (const bool little : {false, true})
            assert_int_equal(orientation_of(exif_block(orientation, little)), orientation);
}

static void values_that_exif_does_not_have_are_none(void **)
{
    for (const uint8_t value : Bytes{0, 9, 255})
        for (const bool little : {false, true})
            assert_int_equal(orientation_of(exif_block(value, little)), VDNA_UPRIGHT);
}

static void an_entry_of_another_type_or_count_is_none(void **)
{
    Bytes wrong_type = exif_block(6), two_values = exif_block(6), another_tag = exif_block(6);
    wrong_type[13] = 4;
    two_values[17] = 2;
    another_tag[11] = 0x13;
    for (const Bytes &block : {wrong_type, two_values, another_tag})
        assert_int_equal(orientation_of(block), VDNA_UPRIGHT);
}

static void the_entry_is_found_behind_others(void **)
{
    Bytes block = exif_block(8);
    const Bytes make(12, 1), number = {0, 2};
    block.insert(block.begin() + 10, make.begin(), make.end());
    std::memcpy(&block[8], number.data(), number.size());
    assert_int_equal(orientation_of(block), 8);
}

static void a_directory_that_leaves_the_block_is_none(void **)
{
    for (const bool little : {false, true}) {
        const Bytes whole = exif_block(6, little);
        // The last four bytes lead to the next directory, which nobody needs.
        for (size_t size = 0; size < whole.size() - 4; size++)
            assert_int_equal(orientation_of(Bytes(
                                 whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
                             VDNA_UPRIGHT);
        Bytes many_entries = whole;
        many_entries[little ? 9 : 8] = 0xFF;
        assert_int_equal(orientation_of(many_entries), VDNA_UPRIGHT);
        for (const size_t at : {4u, 5u, 6u, 7u}) {
            Bytes elsewhere = whole;
            elsewhere[at] = 0xFF;
            assert_int_equal(orientation_of(elsewhere), VDNA_UPRIGHT);
        }
        Bytes at_itself = whole;
        at_itself[little ? 4 : 7] = 0;
        assert_int_equal(orientation_of(at_itself), VDNA_UPRIGHT);
    }
}

static void a_block_with_any_byte_damaged_states_a_valid_orientation(void **)
{
    for (const bool little : {false, true})
        for (size_t at = 0; at < exif_block(6).size(); at++)
            for (uint32_t byte = 0; byte < 256; byte++) {
                Bytes block = exif_block(6, little);
                block[at] = static_cast<uint8_t>(byte);
                assert_in_range(orientation_of(block), 1, 8);
            }
}

static void what_does_not_begin_as_a_tiff_file_is_none(void **)
{
    for (const char *beginning : {"IM", "MI", "XX"}) {
        Bytes block = exif_block(6);
        std::memcpy(block.data(), beginning, 2);
        assert_int_equal(orientation_of(block), VDNA_UPRIGHT);
    }
    Bytes not_42 = exif_block(6);
    not_42[3] = 43;
    assert_int_equal(orientation_of(not_42), VDNA_UPRIGHT);
}

static void a_jpeg_has_it_in_its_first_segment_of_exif(void **)
{
    const Bytes jfif = segment(0xE0, Bytes(14, 0)), xmp = segment(0xE1, Bytes(40, 'h')),
                six = segment(0xE1, joined({exif_name, exif_block(6)})),
                three = segment(0xE1, joined({exif_name, exif_block(3, true)}));
    assert_int_equal(jpeg_orientation_of(joined({start, six})), 6);
    assert_int_equal(jpeg_orientation_of(joined({start, jfif, xmp, three, six})), 3);
    assert_int_equal(jpeg_orientation_of(joined({start, {0xFF, 0xFF, 0xFF}, six})), 6);
    assert_int_equal(jpeg_orientation_of(joined({start, jfif, xmp})), VDNA_UPRIGHT);
}

static void exif_after_the_pixels_begin_does_not_count(void **)
{
    const Bytes six = segment(0xE1, joined({exif_name, exif_block(6)})),
                scan = segment(0xDA, Bytes(6, 0));
    assert_int_equal(jpeg_orientation_of(joined({start, scan, six})), VDNA_UPRIGHT);
    assert_int_equal(jpeg_orientation_of(joined({start, {0xFF, 0xD9}, six})), VDNA_UPRIGHT);
}

static void a_jpeg_cut_short_anywhere_is_read_no_further(void **)
{
    const Bytes whole = joined(
        {start, segment(0xE0, Bytes(14, 0)), segment(0xE1, joined({exif_name, exif_block(6)}))});
    for (size_t size = 0; size < whole.size(); size++)
        assert_int_equal(jpeg_orientation_of(Bytes(
                             whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
                         VDNA_UPRIGHT);
    assert_int_equal(jpeg_orientation_of(whole), 6);
    Bytes no_length = whole;
    no_length[5] = 1; // a length counts its own two bytes
    assert_int_equal(jpeg_orientation_of(no_length), VDNA_UPRIGHT);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_orientation_is_read_in_both_byte_orders),
        cmocka_unit_test(values_that_exif_does_not_have_are_none),
        cmocka_unit_test(an_entry_of_another_type_or_count_is_none),
        cmocka_unit_test(the_entry_is_found_behind_others),
        cmocka_unit_test(a_directory_that_leaves_the_block_is_none),
        cmocka_unit_test(a_block_with_any_byte_damaged_states_a_valid_orientation),
        cmocka_unit_test(what_does_not_begin_as_a_tiff_file_is_none),
        cmocka_unit_test(a_jpeg_has_it_in_its_first_segment_of_exif),
        cmocka_unit_test(exif_after_the_pixels_begin_does_not_count),
        cmocka_unit_test(a_jpeg_cut_short_anywhere_is_read_no_further),
    };
    return cmocka_run_group_tests_name("exif", tests, nullptr, nullptr);
}
