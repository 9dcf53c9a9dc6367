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

} // namespace vdna::report
