// Trials of trust made into scores.
#pragma once

#include <string>
#include <vector>

#include "eval/trust_evaluation.hpp"
#include "eval/trust_trial.hpp"

namespace vdna::eval
{

// A query in a map of some of its references.
struct TrustCase {
    size_t query;                 // index into the evaluation's
    uint32_t references;          // how many were asked for; 0 = all
    std::vector<size_t> columns;  // of the evaluation's references: those of the map
    std::vector<double> achieved; // [columns], recall of the truth, percent
    Trial trial;
};

// Whether a live run was said to be unlike all of a map.
struct UnlikeCase {
    std::string live; // what it is
    uint32_t references;
    size_t query;
    bool unlike;
    double best; // recall of the best reference; NaN = does not matter
};

// A query's references ranked in one map.
struct RankedCase {
    size_t query;
    std::vector<double> recall;   // percent
    std::vector<double> distance; // lower is better; empty: at random, and all is expected
};

// Of an angle of vdna/trust.h, which may be beyond its limits.
double recall_percent(double angle);

// The mean over queries of means over their maps; NaNs are left out.
class QueryMeans
{
  public:
    void add(size_t query, double value);
    Mean mean() const;

  private:
    std::vector<double> sum_, count_; // [queries]
};

// early: after VDNA_TRUST_SETTLED_FRAMES, of those warmups that have them; otherwise after all.
// cases: of one number of references.
PredictionScore score_predictions(const std::vector<TrustCase> &cases, bool early);
SettledScore score_settled(const std::vector<TrustCase> &cases);

// A score for each kind of live run and number of references, in the order of the cases.
std::vector<UnlikeScore> score_unlike(const std::vector<UnlikeCase> &cases);

// All but the names. Throws Error.
TrustRanking score_ranking(const std::vector<RankedCase> &cases);

} // namespace vdna::eval
