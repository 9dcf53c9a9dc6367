#include "eval/confidence.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

using Answers = std::vector<JudgedAnswer>;

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

double share(double part, double whole)
{
    return whole > 0 ? part / whole : undefined;
}

uint32_t good_of(const Answers &answers)
{
    return static_cast<uint32_t>(std::count_if(answers.begin(), answers.end(),
                                               [](const JudgedAnswer &a) { return a.good; }));
}

// Mann-Whitney: count, for each good answer, the wrong ones that are less confident.
double auroc_of(Answers answers)
{
    std::sort(answers.begin(), answers.end(), [](const JudgedAnswer &a, const JudgedAnswer &b) {
        return a.confidence < b.confidence;
    });
    double in_order = 0, good = 0, wrong = 0;
    for (size_t begin = 0, end = 0; begin < answers.size(); begin = end) {
        double good_here = 0, wrong_here = 0; // of equal confidence
        for (; end < answers.size() && answers[end].confidence == answers[begin].confidence; end++)
            (answers[end].good ? good_here : wrong_here)++;
        in_order += good_here * (wrong + wrong_here / 2);
        good += good_here;
        wrong += wrong_here;
    }
    return share(in_order, good * wrong);
}

ReliabilityBin bin_of(const Answers &answers, size_t bin, size_t bins)
{
    uint32_t count = 0;
    double sum = 0, good = 0;
    for (const JudgedAnswer &answer : answers) {
        const auto at = static_cast<size_t>(answer.confidence * static_cast<double>(bins));
        if (std::min(at, bins - 1) != bin)
            continue;
        count++;
        sum += answer.confidence;
        good += answer.good;
    }
    return {count, share(sum, count), 100 * share(good, count)};
}

Threshold threshold_of(const Answers &answers, double confidence)
{
    Answers kept;
    std::copy_if(answers.begin(), answers.end(), std::back_inserter(kept),
                 [&](const JudgedAnswer &answer) { return answer.confidence >= confidence; });
    const double good = good_of(kept), count = static_cast<double>(kept.size());
    return {confidence, 100 * share(good, count), 100 * share(good, good_of(answers)),
            100 * share(count, static_cast<double>(answers.size()))};
}

} // namespace

const Threshold &usual_threshold(const ConfidenceMetrics &metrics)
{
    return *std::find_if(
        metrics.thresholds.begin(), metrics.thresholds.end(),
        [](const Threshold &threshold) { return threshold.confidence == usual_min_confidence; });
}

ConfidenceMetrics judge_confidence(const std::vector<JudgedAnswer> &answers)
{
    for (const JudgedAnswer &answer : answers)
        if (!(answer.confidence >= 0 && answer.confidence <= 1))
            throw Error("a confidence is " + std::to_string(answer.confidence) +
                        ", expected 0 to 1");
    ConfidenceMetrics metrics{
        static_cast<uint32_t>(answers.size()), good_of(answers), auroc_of(answers), {}, {}};
    for (size_t i = 0; i < metrics.reliability.size(); i++)
        metrics.reliability[i] = bin_of(answers, i, metrics.reliability.size());
    for (size_t i = 0; i < confidence_thresholds.size(); i++)
        metrics.thresholds[i] = threshold_of(answers, confidence_thresholds[i]);
    return metrics;
}

} // namespace vdna::eval
