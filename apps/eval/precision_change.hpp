// The effect of a network's precision on embeddings, distances and rankings.
#pragma once

#include <array>

#include "eval/evaluation.hpp"

namespace vdna::eval
{

struct Spread {
    double median = 0, max = 0;
};

// Differences between the embeddings of the same pictures.
struct EmbeddingChange {
    uint64_t pictures = 0;
    Spread l2_percent;      // |a - b| / |a|
    Spread cosine_distance; // 1 - cosine of the angle, 0..2
};

// The rankings of one query by both networks.
struct QueryChange {
    size_t traversal;
    std::array<size_t, 2> first;  // choice of each network: a traversal
    std::array<double, 2> recall; // of that choice with that network, percent
    uint32_t swaps;               // pairs of references in another order
};

struct RankingChange {
    Spread emd_percent; // of the distance of a query and a reference, over all pairs
    uint32_t pairs = 0;
    std::vector<QueryChange> queries;
    std::array<double, 2> recall; // percent, mean over all pairs
};

// a, b: the same traversals with either network, with embeddings of `dim` elements. Throws Error if
// only one of them could use a picture.
EmbeddingChange embedding_change(const std::vector<Traversal> &a, const std::vector<Traversal> &b,
                                 uint32_t dim);

// a, b: of the same data set with the same settings.
RankingChange ranking_change(const Evaluation &a, const Evaluation &b);

} // namespace vdna::eval
