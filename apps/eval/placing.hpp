// References ranked by recall or by a method's distance, and the difference between both ranks.
#pragma once

#include <vector>

#include "eval/evaluation.hpp"

namespace vdna::eval
{

// One place of a ranking.
struct Place {
    size_t reference; // traversal
    double value;     // recall in percent, or distance
    uint32_t off; // ranks from the true place: the paper's colours; 0 if the truth ranks nothing
};

// False if all references of a query have the same recall, so that every order is true.
bool truth_ranks(const Evaluation &evaluation, size_t query);

// The query against a reference that it was compared with.
const PairResult &pair_with(const QueryResult &query, size_t reference);

// query: index into the evaluation's queries. Ties keep the order of the references.
std::vector<Place> true_places(const Evaluation &evaluation, size_t query);
// method: any but "random".
std::vector<Place> predicted_places(const Evaluation &evaluation, size_t query,
                                    const MethodResult &method);

} // namespace vdna::eval
