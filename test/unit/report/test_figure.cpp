// Figures in each format, and names of their files.
#include "cmocka.hpp"
#include "report/figure.hpp"
#include "report/file_names.hpp"
#include "report/latex.hpp"
#include "report/matrix_figure.hpp"

using namespace vdna;

namespace
{

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

const report::Figure hostile = {
    "", "a \"title\"", 100, 50, {report::Text{10, 20, "a(b\\)<&>\x01\u00e9\u65e5\xff"}}};

void text_is_escaped_in_svg(void **)
{
    const std::string svg = report::svg_file(hostile);
    assert_true(contains(svg, ">a(b\\)&lt;&amp;&gt;\ufffd\u00e9\u65e5\ufffd</text>"));
    assert_true(contains(svg, "aria-label=\"a &quot;title&quot;\""));
    assert_true(contains(svg, "xmlns=\"http://www.w3.org/2000/svg\""));
}

void text_is_escaped_in_pdf(void **)
{
    const std::string pdf = report::pdf_file(hostile);
    assert_true(contains(pdf, "(a\\(b\\\\\\)<&>?\xe9?\?) Tj"));
    assert_true(contains(pdf, "/MediaBox[0 0 100.00 50.00 ]"));
}

void the_table_of_a_pdf_has_the_offset_of_each_object(void **)
{
    const std::string pdf = report::pdf_file(hostile);
    const size_t table = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
    assert_int_equal(pdf.compare(table, 7, "xref\n0 "), 0);
    const size_t objects = std::stoul(pdf.substr(table + 7)) - 1;
    assert_true(objects >= 5);
    const size_t first = pdf.find('\n', table + 5) + 21; // after that of object 0
    for (size_t i = 0; i < objects; i++) {
        const size_t offset = std::stoul(pdf.substr(first + 20 * i, 10));
        const std::string begin = std::to_string(i + 1) + " 0 obj\n";
        assert_int_equal(pdf.compare(offset, begin.size(), begin), 0);
    }
}

void a_png_has_the_size_of_the_figure_times_the_scale(void **)
{
    const std::string png = report::png_file(hostile, 2);
    assert_int_equal(png.compare(1, 3, "PNG"), 0);
    assert_int_equal(static_cast<unsigned char>(png[19]), 200);
    assert_int_equal(static_cast<unsigned char>(png[23]), 100);
}

void parts_are_arranged_in_rows(void **)
{
    const report::Figure part = {"", "", 40, 10, {report::Box{0, 0, 40, 10, report::ink}}};
    const report::Figure whole = report::arranged("name", "title", {part, part, part}, 100);
    assert_true(whole.width == 92 && whole.height == 32);
    const auto &last = std::get<report::Box>(whole.items[2]);
    assert_true(last.x == 0 && last.y == 22);
}

void long_text_is_cut_at_a_character(void **)
{
    assert_string_equal(report::shortened("\u00e4\u00f6\u00fc", 3).c_str(), "\u00e4\u00f6\u00fc");
    assert_string_equal(report::shortened("\u00e4\u00f6\u00fcx", 3).c_str(), "\u00e4\u00f6\u2026");
}

void file_names_are_portable_and_unique_in_any_case(void **)
{
    assert_string_equal(report::portable("a/b:c d.\u65e5-_9").c_str(), "a_b_c_d__-_9");
    report::FileNames names;
    assert_string_equal(names.unique("a b").c_str(), "a_b");
    assert_string_equal(names.unique("A.b").c_str(), "A_b-2");
    assert_string_equal(names.unique("a:b").c_str(), "a_b-3");
}

void latex_prints_text_literally(void **)
{
    assert_string_equal(
        report::latex_escaped("a_b & 50% $x# {~^\\} <\"> --[\n").c_str(),
        "a\\_b \\& 50\\% \\$x\\# \\{\\textasciitilde{}\\textasciicircum{}\\textbackslash{}\\} "
        "\\textless{}{\\char34}\\textgreater{} {-}{-}{[} ");
}

// Two live frames in a map of three.
report::MatrixPanel panel_with(report::Verdict verdict)
{
    report::MatrixPanel panel{"1  night", "Recall@1 50 %"};
    panel.difference = {2, 3, {0, 1, 2, 3, 4, 5}, 0, 5};
    panel.first_live = 10;
    panel.last_live = 30;
    panel.matches = {{0, 0, verdict}};
    return panel;
}

void a_matrix_has_axes_with_frame_numbers_and_titles(void **)
{
    const std::string svg =
        report::svg_element(report::panel_figure(panel_with(report::Verdict::right), 100, 100));
    for (const char *part : {">live frame<", ">map frame<", ">10<", ">30<", ">2<", "1  night"})
        assert_true(contains(svg, part));
    assert_false(contains(svg, ">chosen<") || contains(svg, ">best<"));
}

void a_match_is_grey_where_nothing_is_known_to_be_right(void **)
{
    const std::vector<std::pair<report::Verdict, report::Colour>> colours = {
        {report::Verdict::right, report::right_colour},
        {report::Verdict::wrong, report::wrong_colour},
        {report::Verdict::unknown, report::unknown_colour}};
    for (const auto &[verdict, colour] : colours) {
        const report::MatrixPanel panel = panel_with(verdict);
        const std::string svg = report::svg_element(report::panel_figure(panel, 100, 100));
        const std::string legend = report::svg_element(report::legend_figure({panel}));
        for (const auto &[other, other_colour] : colours) {
            const bool is_it = other == verdict;
            assert_true(contains(svg, report::hex_of(other_colour)) == is_it);
            assert_true(contains(legend, report::hex_of(other_colour)) == is_it);
        }
        assert_true(contains(legend, "near 0.00") && contains(legend, "far 5.00"));
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(text_is_escaped_in_svg),
        cmocka_unit_test(text_is_escaped_in_pdf),
        cmocka_unit_test(the_table_of_a_pdf_has_the_offset_of_each_object),
        cmocka_unit_test(a_png_has_the_size_of_the_figure_times_the_scale),
        cmocka_unit_test(parts_are_arranged_in_rows),
        cmocka_unit_test(long_text_is_cut_at_a_character),
        cmocka_unit_test(file_names_are_portable_and_unique_in_any_case),
        cmocka_unit_test(latex_prints_text_literally),
        cmocka_unit_test(a_matrix_has_axes_with_frame_numbers_and_titles),
        cmocka_unit_test(a_match_is_grey_where_nothing_is_known_to_be_right),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
