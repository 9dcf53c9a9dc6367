// Turning: the eight orientations of EXIF, each written out by hand.
#include <string>
#include <vector>

#include <cmocka.hpp>

#include "picture/turn.h"

// A picture as text: a letter a pixel, rows one after the other.
struct Case {
    uint32_t orientation, width, height;
    const char *upright;
};

// Stored rows "abc" and "def".
static const Case cases[] = {
    {1, 3, 2, "abcdef"}, {2, 3, 2, "cbafed"}, {3, 3, 2, "fedcba"}, {4, 3, 2, "defabc"},
    {5, 2, 3, "adbecf"}, {6, 2, 3, "daebfc"}, {7, 2, 3, "fcebda"}, {8, 2, 3, "cfbead"},
};

static std::vector<uint8_t> pixels_of(const std::string &letters)
{
    std::vector<uint8_t> bytes;
    for (const char letter : letters)
        for (uint8_t channel = 0; channel < 3; channel++)
            bytes.push_back(static_cast<uint8_t>(letter + 50 * channel));
    return bytes;
}

static std::vector<uint8_t> turned(const vdna_turn &turn, const std::string &letters,
                                   uint32_t width, uint32_t height)
{
    const std::vector<uint8_t> stored = pixels_of(letters);
    std::vector<uint8_t> out(stored.size(), 0);
    for (uint32_t y = 0; y < height; y++)
        vdna_turn_row(&turn, &stored[size_t{3} * width * y], width, y, out.data());
    return out;
}

static void each_orientation_puts_every_pixel_in_its_place(void **)
{
    for (const Case &c : cases) {
        const vdna_turn turn = vdna_turn_of(c.orientation, 3, 2);
        assert_int_equal(turn.width, c.width);
        assert_int_equal(turn.height, c.height);
        const std::vector<uint8_t> found = turned(turn, "abcdef", 3, 2),
                                   expected = pixels_of(c.upright);
        assert_memory_equal(found.data(), expected.data(), expected.size());
    }
}

static void only_upright_and_upside_down_mirrored_pictures_keep_their_rows(void **)
{
    for (const Case &c : cases) {
        const vdna_turn turn = vdna_turn_of(c.orientation, 3, 2);
        assert_int_equal(vdna_turn_keeps_rows(&turn), c.orientation == 1 || c.orientation == 4);
    }
}

static void a_picture_of_one_pixel_is_itself(void **)
{
    const std::vector<uint8_t> expected = pixels_of("a");
    for (const Case &c : cases) {
        const std::vector<uint8_t> found = turned(vdna_turn_of(c.orientation, 1, 1), "a", 1, 1);
        assert_memory_equal(found.data(), expected.data(), expected.size());
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(each_orientation_puts_every_pixel_in_its_place),
        cmocka_unit_test(only_upright_and_upside_down_mirrored_pictures_keep_their_rows),
        cmocka_unit_test(a_picture_of_one_pixel_is_itself),
    };
    return cmocka_run_group_tests_name("turn", tests, nullptr, nullptr);
}
