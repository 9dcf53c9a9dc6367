// Scores of trials, and the methods that rank by them, on numbers to be checked by hand.
#include <cmath>

#include "cmocka.hpp"
#include "eval/trust_methods.hpp"
#include "eval/trust_scores.hpp"

using namespace vdna;

namespace
{

constexpr double half_angle = 0.78539816339744831; // that of a recall of 50 %

vdna_trust_prediction predicted(double recall, double low, double high)
{
    return {recall, low, high, 0.7, 0.5, 1.0, VDNA_TRUST_REASON_NONE, 0};
}

// A map of two references, of which 80 and 40 % are achieved.
eval::TrustCase case_of(size_t query)
{
    eval::TrustCase c{query, 0, {0, 1}, {80, 40}, {}};
    c.trial.fit.skill = 0.5;
    c.trial.constant = {0.6, 0.5};
    c.trial.full.predictions = {predicted(0.9, 0.7, 0.95), predicted(0.5, 0.45, 0.8)};
    c.trial.full.angle = {half_angle, half_angle};
    c.trial.full.answer.frames = 40;
    return c;
}

bool near(double a, double b)
{
    return std::fabs(a - b) < 1e-9;
}

void predictions_are_judged_beside_other_predictors(void **)
{
    const eval::PredictionScore s = eval::score_predictions({case_of(0)}, false);
    assert_true(s.maps == 1 && s.predictions == 2 && s.frames == 0);
    assert_true(near(s.error.value, 10) && near(s.error_constant.value, 15));
    assert_true(near(s.error_nearest.value, 20) && near(s.error_transfer.value, 20));
    assert_true(near(s.coverage.value, 50) && near(s.width.value, 30) && s.skill.value == 0.5);
}

void a_query_of_many_maps_counts_as_much_as_one_of_few(void **)
{
    std::vector<eval::TrustCase> cases = {case_of(0), case_of(0), case_of(0), case_of(2)};
    cases.back().achieved = {90, 50};
    const eval::PredictionScore s = eval::score_predictions(cases, false);
    assert_true(near(s.error.value, 5) && near(s.error.low, 0) && near(s.error.high, 10));
}

void a_withheld_prediction_is_counted_by_its_reason_and_judges_no_predictor(void **)
{
    eval::TrustCase c = case_of(0);
    c.trial.full.predictions[1] = {NAN, NAN, NAN, 0.7, 0.5, 1.0, VDNA_TRUST_REASON_UNLIKE, 0};
    const eval::PredictionScore s = eval::score_predictions({c}, false);
    assert_true(s.predictions == 1 && s.withheld[VDNA_TRUST_REASON_UNLIKE] == 1);
    assert_true(near(s.error.value, 10) && near(s.error_constant.value, 20));
}

void predictions_fall_into_ten_bins_of_which_the_last_has_both_ends(void **)
{
    eval::TrustCase c = case_of(0);
    c.trial.full.predictions = {predicted(1, 1, 1), predicted(0, 0, 0)};
    const eval::PredictionScore s = eval::score_predictions({c}, false);
    assert_true(s.reliability[9].predictions == 1 && s.reliability[0].predictions == 1);
    assert_true(near(s.reliability[9].predicted, 100) && near(s.reliability[9].achieved.value, 80));
    assert_true(s.reliability[5].predictions == 0 && std::isnan(s.reliability[5].predicted));
}

void short_warmups_have_no_early_predictions(void **)
{
    eval::TrustCase c = case_of(0);
    c.trial.early = c.trial.full;
    c.trial.early->predictions[0].recall = 0.8;
    const eval::PredictionScore s = eval::score_predictions({c, case_of(1)}, true);
    assert_true(s.maps == 1 && s.frames == VDNA_TRUST_SETTLED_FRAMES);
    assert_true(near(s.error.value, 5));
}

void an_early_choice_is_judged_by_the_recall_that_it_loses(void **)
{
    eval::TrustCase early = case_of(0), full = case_of(1);
    early.trial.settled_frames = 10;
    early.trial.settled_choice = 1;
    const eval::SettledScore s = eval::score_settled({early, full});
    assert_true(near(s.settled.value, 50) && near(s.same.value, 50));
    assert_true(near(s.frames.value, (25 + 100) / 2.0) && near(s.loss.value, 20));
    assert_true(near(s.worst_loss, 40) && s.maps == 2);
}

void live_runs_of_a_kind_stand_together(void **)
{
    const std::vector<eval::UnlikeScore> s = eval::score_unlike({
        {"recorded", 3, 0, true, 50},
        {"recorded", 3, 0, false, 90},
        {"black", 3, 0, true, NAN},
        {"recorded", 0, 1, false, 80},
    });
    assert_int_equal(s.size(), 3);
    assert_true(s[0].live == "recorded" && s[0].references == 3 && s[0].maps == 2);
    assert_true(near(s[0].unlike.value, 50) && near(s[0].best_where_unlike.value, 50) &&
                near(s[0].best_where_like.value, 90));
    assert_true(s[1].live == "recorded" && s[1].references == 0 && s[1].unlike.value == 0);
    assert_true(s[2].live == "black" && std::isnan(s[2].best_where_unlike.value));
}

void rankings_are_judged_by_error_regret_and_the_recall_of_the_choice(void **)
{
    const eval::TrustRanking ranking =
        eval::score_ranking({{0, {80, 40}, {2, 1}}, {1, {80, 40}, {1, 2}}, {2, {60, 60}, {1, 2}}});
    assert_true(near(ranking.error.value, (20 + 0) / 2.0)); // the last truth ranks nothing
    assert_true(near(ranking.regret.value, 40 / 3.0) && near(ranking.recall.value, 180 / 3.0));
    const eval::TrustRanking chance = eval::score_ranking({{0, {80, 40}, {}}});
    assert_true(near(chance.error.value, 10) && near(chance.recall.value, 60) &&
                near(chance.regret.value, 20));
}

std::vector<double> distance(const std::string &key, const eval::TrustCase &c)
{
    for (const eval::TrustMethod &method : eval::trust_methods)
        if (method.key == key)
            return method.distance(c, {1, 3}, {7, 5});
    return {};
}

void each_method_ranks_by_its_own_number(void **)
{
    eval::TrustCase c = case_of(0);
    c.trial.full.angle = {0.3, 0.4};
    c.trial.full.predictions[1].transfer = 0.9;
    assert_true(distance("nearest", c) == (std::vector<double>{0.5, 1.5}));
    assert_true(distance("relative", c) == (std::vector<double>{-0.3, -0.4}));
    assert_true(distance("transfer", c) == (std::vector<double>{-0.7, -0.9}));
    assert_true(distance("predicted", c) == (std::vector<double>{-0.9, -0.5}));
}

void without_labels_methods_rank_by_distances(void **)
{
    eval::TrustCase c = case_of(0);
    c.trial.full.angle[0] = c.trial.full.predictions[0].transfer =
        c.trial.full.predictions[0].recall = NAN;
    assert_true(distance("relative", c) == (std::vector<double>{0.5, 1.5}));
    assert_true(distance("transfer", c) == (std::vector<double>{7, 5}));
    assert_true(distance("predicted", c) == (std::vector<double>{7, 5}));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(predictions_are_judged_beside_other_predictors),
        cmocka_unit_test(a_query_of_many_maps_counts_as_much_as_one_of_few),
        cmocka_unit_test(a_withheld_prediction_is_counted_by_its_reason_and_judges_no_predictor),
        cmocka_unit_test(predictions_fall_into_ten_bins_of_which_the_last_has_both_ends),
        cmocka_unit_test(short_warmups_have_no_early_predictions),
        cmocka_unit_test(an_early_choice_is_judged_by_the_recall_that_it_loses),
        cmocka_unit_test(live_runs_of_a_kind_stand_together),
        cmocka_unit_test(rankings_are_judged_by_error_regret_and_the_recall_of_the_choice),
        cmocka_unit_test(each_method_ranks_by_its_own_number),
        cmocka_unit_test(without_labels_methods_rank_by_distances),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
