// How far the confidence of a localiser can be trusted.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <vdna/localise.h>

namespace vdna::eval
{

// An answer for a live frame with ground truth.
struct JudgedAnswer {
    double confidence; // 0..1
    bool good;         // within tolerance
};

// One bin of the reliability curve: a calibrated localiser is right as often as it says.
struct ReliabilityBin {
    uint32_t answers;
    double confidence;   // mean, 0..1; NaN without answers
    double good_percent; // share of good answers; NaN without answers
};

// What is left when answers below a confidence are dropped.
struct Threshold {
    double confidence; // answers with at least this one are kept
    double precision;  // percent of the kept answers that are good; NaN if none is kept
    double kept;       // percent of the good answers that are kept; NaN if none is good
    double answered;   // percent of all answers that are kept
};

constexpr double usual_min_confidence = VDNA_LOCALISE_MIN_CONFIDENCE_DEFAULT;

constexpr std::array<double, 8> confidence_thresholds = {
    0.5, 0.6, 0.7, 0.8, 0.9, 0.95, usual_min_confidence, 0.99};

struct ConfidenceMetrics {
    uint32_t answers, good;
    double auroc; // chance that a good answer is more confident than a wrong one, a tie counting
                  // half; NaN unless there are both
    std::array<ReliabilityBin, 10> reliability; // [k/10, (k+1)/10), the last with 1
    std::array<Threshold, confidence_thresholds.size()> thresholds;
};

// What is left at usual_min_confidence.
const Threshold &usual_threshold(const ConfidenceMetrics &metrics);

// answers: at least one. Throws Error if a confidence is not in 0..1.
ConfidenceMetrics judge_confidence(const std::vector<JudgedAnswer> &answers);

} // namespace vdna::eval
