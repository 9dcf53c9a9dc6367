// What an evaluation says about trust in the choice (vdna/trust.h): a part of its result.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "eval/bootstrap.hpp"

namespace vdna::eval
{

// Means are over queries: within a query over its maps, which are all of its references, or draws
// of some of them. Recalls, and differences of them, are in percent.

// Ways to rank the references of a map, judged by the recall of one localiser.
struct TrustRanking {
    std::string method;
    uint32_t references; // of each map; 0 = all
    std::string truth;   // key of the localiser
    Mean error;          // swap-once; NaN if the method does not rank
    Mean regret;         // best recall of a reference less `recall`
    Mean recall;         // in the first choice, or of the method itself if it does not rank
};

// One bin of the reliability curve of predictions.
struct PredictedBin {
    uint32_t predictions;
    double predicted; // mean; NaN without predictions
    Mean achieved;
};

// How well recalls are predicted from the frames of a warmup.
struct PredictionScore {
    uint32_t references; // of each map; 0 = all
    uint32_t frames;     // of the warmup; 0 = all
    uint32_t maps;
    uint32_t predictions;           // one for each reference of a map
    std::vector<uint32_t> withheld; // [VDNA_TRUST_REASON_...]: how many there were for none
    Mean error, error_constant;     // mean |predicted - achieved|, ours and that of the mean
                                    // recall that other stored runs had in the reference
    Mean error_nearest;             // that of the relative nearest distance alone
    Mean error_transfer;            // that of transfer alone
    Mean coverage, width;           // of the 80 % intervals
    Mean skill;                     // 1 - error over that of the means, from the map alone
    std::array<PredictedBin, 10> reliability; // [k/10, (k+1)/10), the last with 1
};

// How often a live run was said to be unlike all of the map.
struct UnlikeScore {
    std::string live;    // what it is
    uint32_t references; // of each map; 0 = all
    uint32_t maps;
    Mean unlike;            // percent of the maps
    Mean best_where_unlike; // recall of the best reference of a map, where it was said
    Mean best_where_like;   // and where not
};

// A warmup that ends when the choice has settled, against the full one.
struct SettledScore {
    uint32_t references; // of each map; 0 = all
    uint32_t maps;
    Mean settled;      // percent of the maps in which the warmup ended early
    Mean same;         // percent with the same choice
    Mean frames;       // used, percent of the full warmup
    Mean loss;         // recall in the choice of the full warmup less that in the early one
    double worst_loss; // the largest of any map
};

// A query in a reference, in the map of all of its references.
struct TrustPair {
    size_t query;                       // index into the evaluation's
    size_t reference;                   // traversal
    double achieved;                    // recall of the truth
    double predicted, low, high;        // NaN = `reason`
    double constant, nearest, transfer; // the other predictors
    uint32_t reason;                    // VDNA_TRUST_REASON_...
};

struct TrustEvaluation {
    std::string truth; // key of the localiser whose recall is predicted
    std::vector<TrustRanking> rankings;
    std::vector<PredictionScore> predictions;
    std::vector<UnlikeScore> unlike;
    std::vector<SettledScore> settled;
    std::vector<TrustPair> pairs;
};

} // namespace vdna::eval
