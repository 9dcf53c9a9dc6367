// Reporting a ranking of experiences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/selector.hpp>
#include <vdna/cpp/taps.hpp>
#include <vdna/cpp/trust.hpp>
#include <vdna/rank.h>

#include "frames/account.hpp"

namespace vdna::tool
{

// What may be expected of the candidates.
struct Expectation {
    vdna_trust_answer answer{};
    vdna_trust_fit fit{};
    std::vector<vdna_trust_prediction> predictions; // [candidates]
    std::string sentence;                           // how sure it is, and what would help
};

// A ranking with the facts to report.
struct Ranking {
    std::string query;
    uint32_t frames = 0;            // of the query
    uint64_t restarts = 0;          // of the warmup
    frames::Account account;        // of a live query
    uint64_t without_truth = 0;     // frames without the ground truth that others have
    std::vector<std::string> names; // [candidates]
    std::vector<vdna_rank_entry> entries;
    uint32_t ranked_by = VDNA_SELECT_BY_EMD;
    std::optional<Expectation> expectation;         // of a live query
    std::vector<Tap> taps;                          // empty unless requested
    std::vector<std::vector<double>> tap_distances; // [candidates][taps], bins
};

// On standard output.
void report(const Ranking &ranking);
void report_json(const Ranking &ranking);

} // namespace vdna::tool
