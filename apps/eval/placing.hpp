// References in the order of their recall, or of their distance by a method; and how far a place of
// the one is from that of the other.
#pragma once

#include <vector>

#include "eval/evaluation.hpp"

namespace vdna::eval
{

// One place of a ranking.
struct Place {
    size_t reference; // traversal
    double value;     // recall in percent, or distance
    uint32_t off;     // ranks between this place and the true one: the paper's colours
};

// query: index into the evaluation's queries. Ties keep the order of the references.
std::vector<Place> true_places(const Evaluation &evaluation, size_t query);
// method: any but "random".
std::vector<Place> predicted_places(const Evaluation &evaluation, size_t query,
                                    const MethodResult &method);

} // namespace vdna::eval
