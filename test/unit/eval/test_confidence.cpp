#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "eval/confidence.hpp"

using vdna::eval::ConfidenceMetrics;
using vdna::eval::judge_confidence;

namespace
{

bool is_near(double a, double b)
{
    return std::fabs(a - b) < 1e-12;
}

void auroc_is_the_share_of_pairs_in_order(void **)
{
    // Good 0.9 and 0.4, wrong 0.6 and 0.1: of four pairs only (0.4, 0.6) is out of order.
    assert_true(judge_confidence({{0.9, true}, {0.6, false}, {0.4, true}, {0.1, false}}).auroc ==
                0.75);
    assert_true(judge_confidence({{0.9, true}, {0.1, false}}).auroc == 1);
    assert_true(judge_confidence({{0.1, true}, {0.9, false}}).auroc == 0);
}

void a_tie_is_half_in_order(void **)
{
    // Good 0.5 and 0.5, wrong 0.5 and 0.2: two ties and two in order.
    assert_true(judge_confidence({{0.5, true}, {0.5, false}, {0.5, true}, {0.2, false}}).auroc ==
                0.75);
}

void without_good_or_without_wrong_answers_there_is_no_auroc(void **)
{
    const ConfidenceMetrics all_good = judge_confidence({{0.9, true}, {0.3, true}});
    assert_true(std::isnan(all_good.auroc));
    assert_true(std::isnan(judge_confidence({{0.9, false}}).auroc));
    assert_int_equal(all_good.answers, 2);
    assert_int_equal(all_good.good, 2);
}

void a_bin_has_its_lower_edge_and_the_last_one_both(void **)
{
    const ConfidenceMetrics m = judge_confidence({{0, false},
                                                  {0.05, true},
                                                  {0.5, true},
                                                  {0.59, false},
                                                  {0.55, true},
                                                  {0.9, true},
                                                  {1, true}});
    assert_int_equal(m.reliability[0].answers, 2);
    assert_true(is_near(m.reliability[0].confidence, 0.025));
    assert_true(is_near(m.reliability[0].good_percent, 50));
    assert_int_equal(m.reliability[5].answers, 3);
    assert_true(is_near(m.reliability[5].confidence, (0.5 + 0.59 + 0.55) / 3));
    assert_true(is_near(m.reliability[5].good_percent, 200.0 / 3));
    assert_int_equal(m.reliability[9].answers, 2);
    assert_int_equal(m.reliability[1].answers, 0);
    assert_true(std::isnan(m.reliability[1].confidence));
    assert_true(std::isnan(m.reliability[1].good_percent));
}

void a_threshold_keeps_answers_that_are_as_confident(void **)
{
    const ConfidenceMetrics m = judge_confidence(
        {{0.96, true}, {0.97, false}, {0.98, true}, {0.7, true}, {0.5, false}, {0.2, true}});
    const auto at = [&](size_t i) { return m.thresholds[i]; };
    assert_true(at(0).confidence == 0.5 && at(6).confidence == 0.96 && at(7).confidence == 0.99);
    assert_true(is_near(at(0).precision, 60)); // 3 of 5
    assert_true(is_near(at(0).kept, 75));      // 3 of 4
    assert_true(is_near(at(0).answered, 500.0 / 6));
    assert_true(is_near(at(6).precision, 200.0 / 3));
    assert_true(is_near(at(6).kept, 50));
    assert_true(is_near(at(6).answered, 50));
    assert_true(std::isnan(at(7).precision));
    assert_true(at(7).kept == 0 && at(7).answered == 0);
}

void a_confidence_beyond_0_to_1_is_refused(void **)
{
    for (const double confidence : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
        bool refused = false;
        try {
            judge_confidence({{0.5, true}, {confidence, true}});
        } catch (const vdna::Error &) {
            refused = true;
        }
        assert_true(refused);
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(auroc_is_the_share_of_pairs_in_order),
        cmocka_unit_test(a_tie_is_half_in_order),
        cmocka_unit_test(without_good_or_without_wrong_answers_there_is_no_auroc),
        cmocka_unit_test(a_bin_has_its_lower_edge_and_the_last_one_both),
        cmocka_unit_test(a_threshold_keeps_answers_that_are_as_confident),
        cmocka_unit_test(a_confidence_beyond_0_to_1_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
