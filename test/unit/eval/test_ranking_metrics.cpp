// Intervals of metrics over queries.
#include <cmath>

#include "cmocka.hpp"
#include "eval/ranking_metrics.hpp"

using namespace vdna;

namespace
{

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Three queries of two references; the first is predicted right, the others wrong.
const std::vector<double> recall = {90, 80, 60, 90, 50, 40};
const std::vector<double> distance = {1, 2, 1, 2, 2, 1};

void the_interval_of_the_regret_is_that_of_the_mean_of_each_querys(void **)
{
    const eval::JudgedRanking judged =
        eval::judge_ranking({recall.data(), distance.data(), 3, 2}, "test");
    const eval::Mean expected = eval::mean_with_interval({0, 30, 10});
    const eval::Mean regret = judged.of(&vdna_ranking_metrics::regret);
    assert_true(std::fabs(regret.value - expected.value) < 1e-12);
    assert_true(std::fabs(regret.low - expected.low) < 1e-12);
    assert_true(std::fabs(regret.high - expected.high) < 1e-12);
}

void every_metric_lies_in_its_interval(void **)
{
    const eval::JudgedRanking judged =
        eval::judge_ranking({recall.data(), distance.data(), 3, 2}, "test");
    for (const eval::RankingMetric &metric : eval::ranking_metrics) {
        const eval::Mean mean = judged.of(metric.value);
        assert_true(mean.low <= mean.value && mean.value <= mean.high);
    }
}

void queries_that_rank_nothing_or_have_no_pair_take_no_part(void **)
{
    std::vector<double> more = recall, farther = distance;
    more.insert(more.end(), {70, 70, none, none});
    farther.insert(farther.end(), {1, 2, none, none});
    const eval::JudgedRanking with =
        eval::judge_ranking({more.data(), farther.data(), 5, 2}, "test");
    const eval::JudgedRanking without =
        eval::judge_ranking({recall.data(), distance.data(), 3, 2}, "test");
    assert_int_equal(with.metrics.left_out, 1);
    for (const eval::RankingMetric &metric : eval::ranking_metrics) {
        assert_true(with.of(metric.value).low == without.of(metric.value).low);
        assert_true(with.of(metric.value).high == without.of(metric.value).high);
    }
}

void one_query_has_no_interval(void **)
{
    const eval::JudgedRanking judged =
        eval::judge_ranking({recall.data(), distance.data(), 1, 2}, "test");
    assert_true(judged.metrics.regret == 0);
    assert_true(std::isnan(judged.low.regret) && std::isnan(judged.high.regret));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_interval_of_the_regret_is_that_of_the_mean_of_each_querys),
        cmocka_unit_test(every_metric_lies_in_its_interval),
        cmocka_unit_test(queries_that_rank_nothing_or_have_no_pair_take_no_part),
        cmocka_unit_test(one_query_has_no_interval),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
