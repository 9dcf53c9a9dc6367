// Published tables of recalls and distances, evaluated without pictures.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::eval
{

// json: {"recall": {query: {reference: percent, "all": percent}},
//        "distance": {method: {query: {reference: number}}}}; other members are ignored.
// Pairs may be missing or null; a method is evaluated on the pairs that have both a distance and a
// recall. "random" is always evaluated, on all recalls. where: names the file in complaints.
// Throws Error, naming the member.
std::vector<MethodResult> judge_published(const program::Json &json, const std::string &where);

} // namespace vdna::eval
