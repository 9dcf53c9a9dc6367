// The live frames of a query, localised in recorded traversals.
#pragma once

#include "eval/evaluation.hpp"

namespace vdna::eval
{

// The settings of a localisation.
struct QueryTask {
    const std::vector<Traversal> &traversals;
    const QueryResult &query; // its traversal and live frames
    uint32_t dim;             // of the embeddings, before the query's projection
    double tolerance;         // inclusive
    bool with_altitude;       // as for record::Truth
};

// In one traversal, or in several as if they were one. Throws Error.
Outcome localise_query(const QueryTask &task, const std::vector<size_t> &references);

// The kind of label that all traversals have: positions in one frame, or place numbers. Throws
// Error if there is none.
record::Unit unit_of(const std::vector<Traversal> &traversals);

} // namespace vdna::eval
