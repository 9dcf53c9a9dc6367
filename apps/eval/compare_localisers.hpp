// Localisers side by side on the queries of an evaluation.
#pragma once

#include <string>
#include <vector>

#include "eval/drives.hpp"
#include "eval/evaluation.hpp"
#include "eval/localisers.hpp"

namespace vdna::eval
{

// keys: of the localisers, whose results come in the order of their table, each once. The
// evaluation must have its queries and its methods. Shows progress. Throws Error.
std::vector<LocaliserResult> compare_localisers(const Evaluation &evaluation,
                                                const std::vector<std::string> &keys,
                                                const DriveKind &drive = drive_kinds.front());

// The answers of a drive, judged. Frames without ground truth do not count.
struct Judgement {
    uint32_t on_route = 0, good = 0;                // frames
    uint32_t off_route = 0, off_route_answered = 0; // frames; with usual_min_confidence
    std::vector<JudgedAnswer> confident;            // answers on the route with a confidence
};

// answers: to the frames of driven.live.
Judgement judge(const std::vector<Answer> &answers, const DrivenQuery &driven,
                const vdna_experience &map, const Evaluation &evaluation);

// Recall@1 of a query in percent: the mean over its references, or in the map of all of them.
double mean_over_references(const Evaluation &evaluation, const LocaliserResult &result,
                            size_t query);

} // namespace vdna::eval
