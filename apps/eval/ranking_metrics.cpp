#include "eval/ranking_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

vdna_ranking_metrics judged(const vdna_ranking_table &table, const std::string &what)
{
    vdna_ranking_metrics metrics;
    require(vdna_judge_ranking(&table, &metrics), what);
    return metrics;
}

// The queries that count in the metrics.
std::vector<uint32_t> judged_queries(const vdna_ranking_table &table, const std::string &what)
{
    std::vector<uint32_t> queries;
    for (uint32_t q = 0; q < table.queries; q++) {
        const double *row = table.recall + size_t{q} * table.references;
        if (std::all_of(row, row + table.references, [](double r) { return std::isnan(r); }))
            continue;
        if (judged({row, nullptr, 1, table.references}, what).left_out == 0)
            queries.push_back(q);
    }
    return queries;
}

// Some queries of a table, as often as they are named.
class Sample
{
  public:
    explicit Sample(const vdna_ranking_table &whole) : whole_(whole) {}

    void add(uint32_t query)
    {
        append(whole_.recall, query, recall_);
        if (whole_.distance)
            append(whole_.distance, query, distance_);
        queries_++;
    }

    vdna_ranking_table table() const
    {
        return {recall_.data(), whole_.distance ? distance_.data() : nullptr, queries_,
                whole_.references};
    }

  private:
    void append(const double *cells, uint32_t query, std::vector<double> &copy) const
    {
        std::copy_n(&cells[size_t{query} * whole_.references], whole_.references,
                    std::back_inserter(copy));
    }

    const vdna_ranking_table &whole_;
    std::vector<double> recall_, distance_;
    uint32_t queries_ = 0;
};

void set_interval(const RankingMetric &metric, const std::vector<vdna_ranking_metrics> &resamples,
                  JudgedRanking &result)
{
    std::vector<double> values;
    for (const vdna_ranking_metrics &resample : resamples)
        if (!std::isnan(resample.*metric.value))
            values.push_back(resample.*metric.value);
    std::sort(values.begin(), values.end());
    const bool is_known = values.size() > resamples.size() / 2;
    result.low.*metric.value = is_known ? quantile(values, 0.025) : undefined;
    result.high.*metric.value = is_known ? quantile(values, 0.975) : undefined;
}

} // namespace

JudgedRanking judge_ranking(const vdna_ranking_table &table, const std::string &what)
{
    JudgedRanking result;
    result.metrics = result.low = result.high = judged(table, what);
    const std::vector<uint32_t> queries = judged_queries(table, what);
    std::vector<vdna_ranking_metrics> resamples;
    std::mt19937 random(1);
    for (uint32_t k = 0; queries.size() >= 2 && k < bootstrap_resamples; k++) {
        Sample sample(table);
        for (size_t i = 0; i < queries.size(); i++)
            sample.add(queries[random() % queries.size()]);
        resamples.push_back(judged(sample.table(), what));
    }
    for (const RankingMetric &metric : ranking_metrics)
        set_interval(metric, resamples, result);
    return result;
}

} // namespace vdna::eval
