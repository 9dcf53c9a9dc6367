#include "report/wording.hpp"

#include <cmath>

#include "program/print.hpp"

namespace vdna::report
{

const std::string &name_of(const eval::Evaluation &evaluation, size_t traversal)
{
    return (*evaluation.traversals)[traversal].name;
}

std::string warmup_text(const eval::Evaluation &evaluation)
{
    return "warmup " + evaluation.warmup + (evaluation.warmup.back() == 's' ? "" : " frames");
}

std::string tolerance_text(const eval::Evaluation &evaluation)
{
    const int digits = evaluation.tolerance == std::floor(evaluation.tolerance) ? 0 : 2;
    return "tolerance " + program::fixed(evaluation.tolerance, digits) + " " +
           name_of(evaluation.unit);
}

std::string distance_text(double distance)
{
    return program::fixed(distance, std::abs(distance) < 1 ? 3 : 2);
}

std::string mean_text(const eval::Mean &mean, int digits)
{
    if (std::isnan(mean.value))
        return "-";
    const std::string value = program::fixed(mean.value, digits);
    if (std::isnan(mean.low))
        return value;
    return value + " (" + program::fixed(mean.low, digits) + " to " +
           program::fixed(mean.high, digits) + ")";
}

const char *const ranks_nothing = "ranks nothing: all references have the same recall";

std::string left_out_text(const vdna_ranking_metrics &metrics)
{
    if (metrics.left_out == 0)
        return "";
    if (metrics.queries == 0)
        return "The truth ranks nothing: in every query all references have the same recall, so no "
               "method can be judged.";
    const uint32_t all = metrics.queries + metrics.left_out;
    return std::to_string(metrics.left_out) + " of " + std::to_string(all) +
           " queries rank nothing, because all their references have the same recall; they are "
           "left "
           "out of the averages.";
}

} // namespace vdna::report
