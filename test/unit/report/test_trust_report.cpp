// Trust in the choice in text, JSON, CSV and the page.
#include <cmath>

#include <vdna/trust.h>

#include "cmocka.hpp"
#include "report/chart.hpp"
#include "report/result_json.hpp"
#include "report/sections.hpp"
#include "report/trust.hpp"

using namespace vdna;

namespace
{

const eval::Mean none = {NAN, NAN, NAN};

// Query "live" in references "near", which is predicted, and "far", which is not.
struct Fixture {
    std::vector<eval::Traversal> traversals = {
        {"live", "", {}, {}}, {"near", "", {}, {}}, {"far", "", {}, {}}};
    eval::Evaluation evaluation;

    Fixture()
    {
        evaluation.traversals = &traversals;
        evaluation.warmup = "3";
        evaluation.references = {1, 2};
        evaluation.recall = {40, 60};
        eval::QueryResult query{0, 0, 3, {}, {}, {}, {}};
        query.pairs.push_back({1, {}, {}});
        query.pairs.push_back({2, {}, {}});
        evaluation.queries.push_back(query);
        evaluation.methods.push_back({"random", {}, {}});
        eval::TrustEvaluation trust;
        trust.truth = "centred";
        trust.rankings = {{"transfer", 0, "centred", {1, 0.5, 2}, {3, NAN, NAN}, {90, NAN, NAN}},
                          {"fused_filter", 0, "filter", none, {4, NAN, NAN}, {95, NAN, NAN}}};
        eval::PredictionScore score{};
        score.maps = score.predictions = 1;
        score.withheld = {0, 0, 0, 1, 0, 2, 0};
        score.error = {7, 6, 8};
        score.error_constant = {9, 8, 10};
        score.coverage = {81, 80, 82};
        score.skill = none;
        score.reliability[8] = {1, 85, {80, 70, 90}};
        trust.predictions = {score};
        trust.unlike = {{"black", 3, 20, {99, 98, 100}, none, none}};
        trust.settled = {{0, 1, {50, NAN, NAN}, {100, NAN, NAN}, {25, NAN, NAN}, {1, NAN, NAN}, 2}};
        trust.pairs = {
            {0, 1, 80, 85, 70, 95, 60, 75, 90, VDNA_TRUST_REASON_NONE},
            {0, 2, 50, NAN, NAN, NAN, 60, 75, 90, VDNA_TRUST_REASON_UNLIKE},
        };
        evaluation.trust = trust;
    }
};

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

void the_text_has_every_table(void **)
{
    const Fixture f;
    const std::string text = report::trust_text(*f.evaluation.trust);
    assert_true(contains(text, "all         transfer  1.00 (0.50 to 2.00)  3.00"));
    assert_true(contains(text, "all         fused_filter  -                4.00"));
    assert_true(contains(text, "all         full    1            7.00 (6.00 to 8.00)"));
    assert_true(contains(text, "all         full    1     81.00 (80.00 to 82.00)"));
    assert_true(contains(text, "unlike 1, not labelled 2\n"));
    assert_true(contains(text, "from 80      1            85.00  80.00 (70.00 to 90.00)\n"));
    assert_true(contains(text, "black     3           20    99.00 (98.00 to 100.00)  -"));
    assert_true(contains(text, "50.00          100.00         25.00     1.00           2.00\n"));
}

void a_sentence_says_what_predictions_were_worth(void **)
{
    Fixture f;
    eval::TrustEvaluation &trust = *f.evaluation.trust;
    const std::string summary = report::trust_summary(trust);
    assert_true(contains(summary,
                         "to 7.0 points on average, closer than by a reference's mean (9.0), "
                         "and 81 % lie in their 80 % intervals"));
    assert_true(contains(report::trust_text(trust), summary));
    assert_true(contains(report::trust_section(f.evaluation), "81 % lie in"));
    trust.predictions[0].error_constant.value = 7;
    assert_true(contains(report::trust_summary(trust), "no closer than"));
    trust.predictions[0].error = none;
    assert_true(contains(report::trust_summary(trust), "nothing is predicted"));
}

void json_has_scores_and_pairs(void **)
{
    const Fixture f;
    const program::Json json = report::json_of(f.evaluation, {})["trust"];
    assert_true(json["truth"] == "centred");
    assert_true(json["rankings"][0]["ranking_error_swap_once"]["high"] == 2.0);
    assert_true(json["rankings"][0]["references"] == "all");
    assert_true(json["predictions"][0]["warmup"] == "full");
    assert_true(json["predictions"][0]["withheld"].size() == 2);
    assert_true(json["predictions"][0]["reliability"][8]["achieved"]["mean"] == 80.0);
    assert_true(json["unlike"][0]["references"] == 3);
    assert_true(json["settled"][0]["recall_lost_worst"] == 2.0);
    assert_true(json["pairs"]["live"]["near"]["predicted"] == 85.0);
    assert_true(json["pairs"]["live"]["far"]["reason"] ==
                vdna_trust_reason_text(VDNA_TRUST_REASON_UNLIKE));
}

void csv_has_predictions_beside_recalls(void **)
{
    Fixture f;
    const std::string csv = report::csv_of(f.evaluation);
    assert_true(contains(csv, ",achieved_percent,predicted_percent,low_percent,high_percent,"));
    assert_true(contains(csv, "live,near,0.0,0,0,0,80.0,85.0,70.0,95.0,60.0,75.0,90.0,0,"));
    assert_true(contains(csv, "live,far,0.0,0,0,0,50.0,,,,60.0,75.0,90.0,0,"));
    assert_true(contains(csv, "live,all,0.0,0,0,0,,,,,,,,0,"));
    f.evaluation.trust.reset();
    assert_false(contains(report::csv_of(f.evaluation), "predicted"));
}

void the_page_has_tables_a_curve_and_each_pair(void **)
{
    Fixture f;
    const std::string html = report::trust_section(f.evaluation);
    assert_true(contains(html, "Rankings, judged by Recall@1 of the localiser filter"));
    assert_true(contains(html, "1 predictions, mean 85.0 %, achieved 80.00 (70.00 to 90.00) %"));
    assert_true(contains(html, "<td class=\"number\">7.00 (6.00 to 8.00)</td>"));
    assert_true(contains(html, vdna_trust_reason_text(VDNA_TRUST_REASON_UNLIKE)));
    assert_false(contains(html, "nan"));
    f.evaluation.trust.reset();
    assert_true(report::trust_section(f.evaluation).empty());
}

void a_point_of_a_diagonal_chart_has_a_line_over_its_interval(void **)
{
    const report::Figure plain = report::diagonal_chart("x", 1, "y", 1, {{0.5, 0.5, 0, "p"}});
    const report::Figure interval =
        report::diagonal_chart("x", 1, "y", 1, {{0.5, 0.5, 0, "p", 0.25, 0.75}});
    assert_int_equal(interval.items.size(), plain.items.size() + 1);
    // The drawing has y from 208 up to 10.
    assert_true(contains(report::svg_element(interval), "d=\"M199 158.5L199 59.5\""));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_text_has_every_table),
        cmocka_unit_test(a_sentence_says_what_predictions_were_worth),
        cmocka_unit_test(json_has_scores_and_pairs),
        cmocka_unit_test(csv_has_predictions_beside_recalls),
        cmocka_unit_test(the_page_has_tables_a_curve_and_each_pair),
        cmocka_unit_test(a_point_of_a_diagonal_chart_has_a_line_over_its_interval),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
