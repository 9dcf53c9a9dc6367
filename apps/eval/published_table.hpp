// Tables of recalls and distances that were published as numbers, judged without pictures.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::eval
{

// json: {"recall": {query: {reference: percent, "all": percent}},
//        "distance": {method: {query: {reference: number}}}}; more members are passed over. Pairs
// may be missing or null; a method is judged by the pairs that it and the recalls both have.
// "random" is always judged, by all recalls. where: names the file in complaints. Throws Error,
// naming the member.
std::vector<MethodResult> judge_published(const program::Json &json, const std::string &where);

} // namespace vdna::eval
