// Localisers in text, JSON, CSV and the page, with a confidence.
#include <cmath>

#include "cmocka.hpp"
#include "report/localisers.hpp"
#include "report/result_json.hpp"
#include "report/sections.hpp"

using namespace vdna;

namespace
{

// Queries "a" and "b" of each other: nn in each, fused in all at once with a confidence.
struct Fixture {
    std::vector<eval::Traversal> traversals = {{"a", "", {}, {}}, {"b", "", {}, {}}};
    eval::Evaluation evaluation;

    Fixture()
    {
        evaluation.traversals = &traversals;
        evaluation.warmup = "3";
        evaluation.references = {0, 1};
        evaluation.recall = {NAN, 40, 60, NAN};
        for (size_t q = 0; q < 2; q++) {
            eval::QueryResult query{q, 0, 3, {}, {}, {}, {}};
            query.pairs.push_back({1 - q, {}, {}});
            evaluation.queries.push_back(query);
        }
        evaluation.methods.push_back({"random", {}, {}});
        eval::LocaliserResult nn, fused;
        nn.name = "nn";
        nn.recall = evaluation.recall;
        nn.mean.recall = nn.chosen.recall = {50, 40, 60};
        fused.name = "fused";
        fused.in_each = false;
        fused.recall = {80, 90};
        fused.mean.recall = fused.chosen.recall = {85, NAN, NAN};
        fused.mean.confidence =
            eval::judge_confidence({{0.97, true}, {0.93, true}, {0.3, true}, {0.2, false}});
        evaluation.localisers = {nn, fused};
        fused.drive = nn.drive = "gap";
        nn.chosen.recall = {30, 20, 40};
        fused.mean.off_route = eval::Mean{4, 1, 7};
        evaluation.drives = {nn, fused};
    }
};

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

void the_text_has_means_recalls_and_confidences(void **)
{
    const Fixture f;
    const std::string text = report::localiser_tables(f.evaluation);
    assert_true(contains(text, "95 % interval over 2 queries"));
    assert_true(contains(text, "nn         50.00 (40.00 to 60.00)  50.00 (40.00 to 60.00)\n"));
    assert_true(contains(text, "fused      85.00                   85.00\n"));
    assert_true(contains(text, "query  reference  nn     fused\n"));
    assert_true(contains(text, "a      b          40.00  \n"));
    assert_true(contains(text, "b      all               90.00\n"));
    assert_true(contains(text, "Confidence of fused: AUROC 1.000, 4 answers, 3 good\n"));
    assert_true(contains(text, "from 0.9    2        0.95  100.00\n"));
    assert_true(contains(text, "from 0.5    0        -     -\n"));
    assert_true(contains(text, "0.96      100.00       33.33             25.00\n"));
}

void recalls_that_other_tables_have_are_not_repeated(void **)
{
    Fixture f;
    f.evaluation.localisers.pop_back();
    assert_false(contains(report::localiser_tables(f.evaluation), "query  reference  nn"));
    assert_false(contains(report::localisers_section(f.evaluation), "Every query in every"));
}

void json_has_each_recall_once_and_the_confidence_of_those_with_one(void **)
{
    const Fixture f;
    const program::Json json = report::localisers_json(f.evaluation);
    assert_true(json["nn"]["recall"]["a"] == program::Json({{"b", 40.0}}));
    assert_true(json["fused"]["recall"]["b"] == program::Json({{"all", 90.0}}));
    assert_true(json["nn"]["mean"]["low"] == 40.0);
    assert_false(json["nn"]["mean"].contains("confidence"));
    const program::Json &confidence = json["fused"]["mean"]["confidence"];
    assert_true(confidence["auroc"] == 1.0);
    assert_int_equal(confidence["reliability"].size(), 10);
    assert_true(confidence["reliability"][9]["answers"] == 2);
    assert_true(confidence["thresholds"][6]["confidence"] == 0.96);
    assert_true(confidence["thresholds"][6]["kept_percent"] == 100 * (1.0 / 3));
}

void drives_have_a_row_for_each_score(void **)
{
    Fixture f;
    const std::string text = report::localiser_tables(f.evaluation);
    assert_true(contains(text, "at a confidence of at least 0.96\n"));
    assert_true(contains(text, "\ngap    nn         each          50.00 (40.00 to 60.00)"));
    assert_true(contains(text, "\ngap    nn         first choice  30.00 (20.00 to 40.00)"));
    assert_true(contains(text, "\ngap    fused      together      85.00                   1.000  "
                               "100.00       33.33   4.00 (1.00 to 7.00)\n"));
    const std::string html = report::localisers_section(f.evaluation);
    assert_true(contains(html, "<td>first choice</td><td class=\"number\">30.00"));
    assert_true(contains(html, "4.00 (1.00 to 7.00)</td></tr>"));
    f.evaluation.drives.clear();
    assert_false(contains(report::localiser_tables(f.evaluation), "Drives"));
    assert_false(contains(report::localisers_section(f.evaluation), "Disturbed"));
}

void json_has_the_drives_by_name(void **)
{
    Fixture f;
    const program::Json json = report::json_of(f.evaluation, {})["drives"]["gap"];
    assert_true(json["nn"]["first_choice"] ==
                program::Json({{"recall", 30.0}, {"low", 20.0}, {"high", 40.0}}));
    assert_true(
        json["fused"]["mean"]["off_route"] ==
        program::Json(
            {{"confidence", 0.96}, {"answered_percent", 4.0}, {"low", 1.0}, {"high", 7.0}}));
    assert_true(json["fused"]["mean"]["confidence"]["auroc"] == 1.0);
    f.evaluation.drives.clear();
    assert_false(report::json_of(f.evaluation, {}).contains("drives"));
}

void csv_has_a_column_for_those_beyond_the_usual(void **)
{
    const Fixture f;
    const std::string csv = report::csv_of(f.evaluation);
    assert_true(contains(csv, "unreachable,recall_percent_fused,without_truth,note\n"));
    assert_true(contains(csv, "\nb,all,0.0,0,0,0,90.0,0,"));
    assert_true(contains(csv, "\nb,a,0.0,0,0,0,,0,\n"));
}

void the_page_has_a_curve_and_a_table_for_a_confidence(void **)
{
    const Fixture f;
    const std::string html = report::localisers_section(f.evaluation);
    assert_true(contains(html, "Nearest frame of the fused map: AUROC 1.000, 4 answers"));
    assert_true(contains(html, "2 answers, mean confidence 0.950, 100.0 % good"));
    assert_true(contains(html, "Answers of fused by their least confidence"));
    assert_true(contains(html, "nn, in the first choice: 50.00 (40.00 to 60.00) %"));
    assert_false(contains(html, "nan"));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_text_has_means_recalls_and_confidences),
        cmocka_unit_test(recalls_that_other_tables_have_are_not_repeated),
        cmocka_unit_test(json_has_each_recall_once_and_the_confidence_of_those_with_one),
        cmocka_unit_test(drives_have_a_row_for_each_score),
        cmocka_unit_test(json_has_the_drives_by_name),
        cmocka_unit_test(csv_has_a_column_for_those_beyond_the_usual),
        cmocka_unit_test(the_page_has_a_curve_and_a_table_for_a_confidence),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
