// Localisers side by side on the queries of an evaluation.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "eval/localisers.hpp"

namespace vdna::eval
{

// keys: of the localisers, whose results come in the order of their table, each once. The
// evaluation must have its queries and its methods. Shows progress. Throws Error.
std::vector<LocaliserResult> compare_localisers(const Evaluation &evaluation,
                                                const std::vector<std::string> &keys);

// Recall@1 in percent of the answers for frames with ground truth. Appends those answers that have
// a confidence to `out_judged`.
double recall_of(const std::vector<Answer> &answers, const Drive &drive, const vdna_experience &map,
                 const Evaluation &evaluation, std::vector<JudgedAnswer> &out_judged);

// Recall@1 of a query in percent: the mean over its references, or in the map of all of them.
double mean_over_references(const Evaluation &evaluation, const LocaliserResult &result,
                            size_t query);

} // namespace vdna::eval
