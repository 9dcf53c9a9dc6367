// Texts of unknown origin in the cells of a terminal.
#include <string>
#include <vector>

#include "cmocka.hpp"
#include "watch/display_text.hpp"

namespace
{

using namespace vdna::watch;

void assert_text(const std::string &found, const char *expected)
{
    assert_string_equal(found.c_str(), expected);
}

void what_would_control_a_terminal_is_a_question_mark(void **)
{
    assert_text(printable("winter, Zürich 冬"), "winter, Zürich 冬");
    assert_text(printable("\x1b[2Ja\nb\tc\x7f"), "?[2Ja?b?c?");
    assert_text(printable("a\xc2\x9b"
                          "b"),
                "a?b"); // CSI in one character
    assert_text(printable("a\xe2\x80\xae"
                          "b"),
                "a?b"); // from right to left
    assert_text(printable("\xff\xc3(\xed\xa0\x80"), "?"
                                                    "?(?"
                                                    "??"); // no UTF-8
    assert_text(printable(""), "");
}

void wide_characters_take_two_cells_and_accents_none(void **)
{
    assert_int_equal(width_of(std::string("winter")), 6);
    assert_int_equal(width_of(std::string("冬の道")), 6);
    assert_int_equal(width_of(std::string("u\xcc\x88")), 1);
    assert_int_equal(width_of(std::string("█▌░…–·")), 6);
}

void what_is_cut_off_leaves_a_mark_within_the_cells(void **)
{
    assert_text(cut("winter", 6), "winter");
    assert_text(cut("winter", 5), "wint…");
    assert_text(cut("冬の道", 6), "冬の道");
    assert_text(cut("冬の道", 5), "冬の…");
    assert_text(cut("冬の道", 4), "冬…"); // half of a character cannot be shown
    assert_text(cut("winter", 1), "…");
    assert_text(cut("winter", 0), "");
    assert_text(cut("winter", -3), "");
}

void lines_break_between_words(void **)
{
    const std::vector<std::string> lines = wrapped("a bb 冬冬 ccccc  d", 4);
    const std::vector<std::string> expected{"a bb", "冬冬", "ccc…", "d"};
    assert_true(lines == expected);
    assert_true(wrapped("", 4).empty());
    const std::vector<std::string> share{"ab", "97 %,", "c"};
    assert_true(wrapped("ab 97 %, c", 6) == share);
}

void ascii_is_as_wide(void **)
{
    assert_text(in_ascii("█▌░ Zürich… 冬 1–2 · 3"), "#=. Z?rich~ ?? 1-2 | 3");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_would_control_a_terminal_is_a_question_mark),
        cmocka_unit_test(wide_characters_take_two_cells_and_accents_none),
        cmocka_unit_test(what_is_cut_off_leaves_a_mark_within_the_cells),
        cmocka_unit_test(lines_break_between_words),
        cmocka_unit_test(ascii_is_as_wide),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
