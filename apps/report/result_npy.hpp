// Matrices and descriptors of an evaluation as .npy files.
#pragma once

#include <string>

#include "eval/evaluation.hpp"

namespace vdna::report
{

// Files in a directory, created if missing. Names of traversals are made portable in file names:
// letters, digits, '-' and '_', all others being '_', with "-2" and so on if two would be the same.
//   index.json                         names of the queries and references: rows and columns; and
//                                      "files": the name of each traversal in file names
//   recall.npy, distance_METHOD.npy    [queries][references], NaN without a pair
//   embeddings_TRAVERSAL.npy           [frames][dim], what frames are localised by
//   last_layer_TRAVERSAL.npy           [frames][dim of it], what the Frechet distance compares
//   grey_, place_ or position_TRAVERSAL.npy  [frames] or [frames][3]
//   difference_QUERY_REFERENCE.npy     [live frames][map frames]
//   ground_truth_QUERY_REFERENCE.npy   the same, in the unit of the tolerance
//   range_QUERY.npy                    [neurons][2]
//   emd_QUERY.npy                      [references of the query][neurons], bins
// Throws Error.
void write_npy_files(const eval::Evaluation &evaluation, const std::string &directory);

} // namespace vdna::report
