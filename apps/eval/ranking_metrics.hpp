// The metrics of a ranking: one table of their names, and their intervals over queries.
#pragma once

#include <array>
#include <string>

#include <vdna/baseline.h>

#include "eval/bootstrap.hpp"

namespace vdna::eval
{

struct RankingMetric {
    const char *key;         // in JSON and CSV
    const char *short_title; // in text tables
    const char *title;       // for people
    double vdna_ranking_metrics::*value;
};

constexpr std::array<RankingMetric, 8> ranking_metrics = {{
    {"ranking_error_swap_once", "ranking error/%", "Swap-once, %",
     &vdna_ranking_metrics::ranking_error_swap_once},
    {"ranking_error_half_l1", "half-L1/%", "Half-L1, %",
     &vdna_ranking_metrics::ranking_error_half_l1},
    {"regret", "regret/%", "Regret, %", &vdna_ranking_metrics::regret},
    {"kendall_tau", "Kendall tau", "Kendall tau", &vdna_ranking_metrics::kendall_tau},
    {"pearson_within", "Pearson", "Pearson within", &vdna_ranking_metrics::pearson_within},
    {"spearman_within", "Spearman", "Spearman within", &vdna_ranking_metrics::spearman_within},
    {"pearson_pooled", "pooled Pearson", "Pearson pooled", &vdna_ranking_metrics::pearson_pooled},
    {"spearman_pooled", "pooled Spearman", "Spearman pooled",
     &vdna_ranking_metrics::spearman_pooled},
}};

// Metrics with the ends of their 95 % bootstrap intervals over the queries that are judged: NaN of
// fewer than two such queries, or if a metric is undefined in most resamples.
struct JudgedRanking {
    vdna_ranking_metrics metrics{}, low{}, high{};

    Mean of(double vdna_ranking_metrics::*value) const
    {
        return {metrics.*value, low.*value, high.*value};
    }
};

// Resamples queries as mean_with_interval() does values, and judges each resample as a table of its
// own. what: for the error. Throws Error.
JudgedRanking judge_ranking(const vdna_ranking_table &table, const std::string &what);

} // namespace vdna::eval
