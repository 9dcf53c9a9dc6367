#include "report/reselection.hpp"

#include "program/text_table.hpp"
#include "report/localisers.hpp"

namespace vdna::report
{

namespace
{

std::vector<std::string> names_of(const eval::Evaluation &evaluation,
                                  const std::vector<size_t> &traversals)
{
    std::vector<std::string> names;
    for (const size_t traversal : traversals)
        names.push_back((*evaluation.traversals)[traversal].name);
    return names;
}

template <typename Value>
std::string joined(const std::vector<Value> &values, const char *between)
{
    std::string text;
    for (const Value &value : values) {
        if (!text.empty())
            text += between;
        if constexpr (std::is_same_v<Value, std::string>)
            text += value;
        else
            text += std::to_string(value);
    }
    return text;
}

program::Json json_of(const eval::Mean &mean)
{
    return {{"percent", mean.value}, {"low", mean.low}, {"high", mean.high}};
}

} // namespace

std::string reselection_table(const eval::Evaluation &evaluation)
{
    const eval::Reselection &reselection = *evaluation.reselection;
    program::TextTable table;
    table.add_row(
        {"drive", "choosing again/%", "never/%", "best in hindsight/%", "choices", "frames late"});
    for (const eval::ReselectionResult &drive : reselection.drives)
        table.add_row({drive.drive, program::fixed(drive.again, 2), program::fixed(drive.never, 2),
                       program::fixed(drive.best, 2),
                       joined(names_of(evaluation, drive.choices), " > "),
                       joined(drive.delays, ", ")});
    table.add_row({"mean", mean_text(reselection.again), mean_text(reselection.never),
                   mean_text(reselection.best)});
    return "\nChoosing again while driving, Recall@1 of the place filter in the choice; it gains " +
           mean_text(reselection.gain) + " points\n" + table.text();
}

program::Json reselection_json(const eval::Evaluation &evaluation)
{
    const eval::Reselection &reselection = *evaluation.reselection;
    program::Json json = {{"mean",
                           {{"again", json_of(reselection.again)},
                            {"never", json_of(reselection.never)},
                            {"best", json_of(reselection.best)},
                            {"gain", json_of(reselection.gain)}}}};
    for (const eval::ReselectionResult &drive : reselection.drives)
        json["drives"][drive.drive] = {{"again_percent", drive.again},
                                       {"never_percent", drive.never},
                                       {"best_percent", drive.best},
                                       {"choices", names_of(evaluation, drive.choices)},
                                       {"delays", drive.delays}};
    return json;
}

} // namespace vdna::report
