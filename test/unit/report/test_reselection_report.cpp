// Choosing again while driving on the page.
#include "cmocka.hpp"
#include "report/chart.hpp"
#include "report/sections.hpp"

using namespace vdna;

namespace
{

void the_choice_over_time_has_a_lane_for_each_experience_and_a_mark_for_each_traversal(void **)
{
    const std::vector<eval::Traversal> traversals = {
        {"day", "", {}, {}}, {"night", "", {}, {}}, {"summer", "", {}, {}}, {"dark", "", {}, {}}};
    eval::Evaluation evaluation;
    evaluation.traversals = &traversals;
    eval::Reselection reselection{};
    reselection.drives = {
        {"day+night+day", {2, 3, 2}, {0, 70, 95}, {0, 60, 90, 120}, {9, 4}, 99, 90, 100}};
    evaluation.reselection = reselection;
    const std::string chart = report::svg_element(report::lane_chart(
        "frames after the warmup", 120, {"summer", "dark"}, {{0, 0, 70}, {1, 70, 95}, {0, 95, 120}},
        {{0, "day"}, {60, "night"}, {90, "day"}}));
    const std::string section = report::reselection_section(evaluation);
    assert_true(section.find(chart) != std::string::npos);
    assert_true(
        section.find("day+night+day: Recall@1 choosing again 99.00 %, never 90.00 %, in the "
                     "best in hindsight 100.00 %") != std::string::npos);
}

void lanes_lie_one_below_another_and_stretches_along_x(void **)
{
    const std::string chart = report::svg_element(
        report::lane_chart("frames", 100, {"a", "b"}, {{0, 0, 50}, {1, 50, 100}}, {{50, "dusk"}}));
    // The drawing has x from 48 to 350.
    for (const char *part : {"d=\"M48 115.6L199 115.6\"", "d=\"M199 181.6L350 181.6\"",
                             "d=\"M199 10L199 208\"", ">dusk<", ">a<", ">b<"})
        assert_true(chart.find(part) != std::string::npos);
}

void without_it_the_page_has_no_such_section(void **)
{
    assert_string_equal(report::reselection_section({}).c_str(), "");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(
            the_choice_over_time_has_a_lane_for_each_experience_and_a_mark_for_each_traversal),
        cmocka_unit_test(lanes_lie_one_below_another_and_stretches_along_x),
        cmocka_unit_test(without_it_the_page_has_no_such_section),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
