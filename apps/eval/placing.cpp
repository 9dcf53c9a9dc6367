#include "eval/placing.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/rank.h>

namespace vdna::eval
{

namespace
{

// The references that the query was compared with, by ascending key.
std::vector<Place> sorted(const Evaluation &evaluation, size_t query,
                          const std::vector<double> &table, double sign)
{
    std::vector<double> keys;
    std::vector<size_t> references;
    for (size_t r = 0; r < evaluation.references.size(); r++) {
        const size_t cell = query * evaluation.references.size() + r;
        if (std::isnan(evaluation.recall[cell]))
            continue;
        keys.push_back(sign * table[cell]);
        references.push_back(evaluation.references[r]);
    }
    std::vector<vdna_rank_entry> entries(keys.size());
    require(vdna_rank_sort(keys.data(), static_cast<uint32_t>(keys.size()), entries.data()),
            "ranking");
    std::vector<Place> places;
    for (const vdna_rank_entry &entry : entries)
        places.push_back({references[entry.candidate], sign * entry.distance_bins, 0});
    return places;
}

} // namespace

bool truth_ranks(const Evaluation &evaluation, size_t query)
{
    const auto references = static_cast<uint32_t>(evaluation.references.size());
    const vdna_ranking_table table = {&evaluation.recall[query * references], nullptr, 1,
                                      references};
    vdna_ranking_metrics metrics;
    require(vdna_judge_ranking(&table, &metrics), "ranking");
    return metrics.left_out == 0;
}

std::vector<Place> true_places(const Evaluation &evaluation, size_t query)
{
    return sorted(evaluation, query, evaluation.recall, -1);
}

std::vector<Place> predicted_places(const Evaluation &evaluation, size_t query,
                                    const MethodResult &method)
{
    const std::vector<Place> truth = true_places(evaluation, query);
    std::vector<Place> places = sorted(evaluation, query, method.distance, 1);
    if (!truth_ranks(evaluation, query))
        return places;
    for (size_t rank = 0; rank < places.size(); rank++) {
        size_t true_rank = 0;
        while (truth[true_rank].reference != places[rank].reference)
            true_rank++;
        places[rank].off =
            static_cast<uint32_t>(std::max(rank, true_rank) - std::min(rank, true_rank));
    }
    return places;
}

const PairResult &pair_with(const QueryResult &query, size_t reference)
{
    return *std::find_if(query.pairs.begin(), query.pairs.end(),
                         [&](const PairResult &pair) { return pair.reference == reference; });
}

} // namespace vdna::eval
