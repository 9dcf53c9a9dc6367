// Trust in the choice, as text, as JSON and in a table of pairs.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::report
{

struct TrustTable {
    std::string title;
    std::vector<std::string> heads;
    std::vector<std::vector<std::string>> rows; // the first `names` cells are text, all others
                                                // numbers
    size_t names;
};

// Rankings by the recall of each localiser, predictions, their reliability, live runs that are
// unlike, warmups that end early.
std::vector<TrustTable> trust_tables(const eval::TrustEvaluation &trust);

// What predictions were worth, in a sentence.
std::string trust_summary(const eval::TrustEvaluation &trust);

// How the tables are to be read, in a few sentences.
extern const char *const trust_explanation;

// The tables, below one another.
std::string trust_text(const eval::TrustEvaluation &trust);

program::Json trust_json(const eval::Evaluation &evaluation);

// What is predicted of one query in one reference: for heads, and for each pair, in their order.
extern const std::vector<std::string> prediction_heads;
std::vector<double> prediction_cells(const eval::TrustPair &pair);

} // namespace vdna::report
