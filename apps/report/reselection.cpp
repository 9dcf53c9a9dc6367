#include "report/reselection.hpp"

#include <algorithm>

#include "program/text_table.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

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

std::vector<Stretch> stretches_of(const eval::ReselectionResult &drive, std::vector<size_t> &lanes)
{
    std::vector<Stretch> stretches;
    for (size_t i = 0; i < drive.choices.size(); i++) {
        const bool is_last = i + 1 == drive.choices.size();
        auto lane = std::find(lanes.begin(), lanes.end(), drive.choices[i]);
        if (lane == lanes.end())
            lane = lanes.insert(lane, drive.choices[i]);
        stretches.push_back(
            {static_cast<size_t>(lane - lanes.begin()), static_cast<double>(drive.since[i]),
             static_cast<double>(is_last ? drive.changes.back() : drive.since[i + 1])});
    }
    return stretches;
}

// The traversals of a drive, where they begin.
std::vector<Mark> marks_of(const eval::ReselectionResult &drive)
{
    std::vector<Mark> marks;
    std::string rest = drive.drive;
    for (size_t part = 0; part + 1 < drive.changes.size(); part++) {
        marks.push_back({static_cast<double>(drive.changes[part]), rest.substr(0, rest.find('+'))});
        rest.erase(0, marks.back().name.size() + 1);
    }
    return marks;
}

// The choice over time.
Figure figure_of(const eval::Evaluation &evaluation, const eval::ReselectionResult &drive)
{
    std::vector<size_t> lanes;
    const std::vector<Stretch> stretches = stretches_of(drive, lanes);
    Figure chart = lane_chart("frames after the warmup", drive.changes.back(),
                              names_of(evaluation, lanes), stretches, marks_of(drive));
    chart.name = "reselection-" + drive.drive;
    chart.caption = drive.drive + ": Recall@1 choosing again " + program::fixed(drive.again, 2) +
                    " %, never " + program::fixed(drive.never, 2) +
                    " %, in the best in hindsight " + program::fixed(drive.best, 2) + " %";
    return chart;
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
        json["drives"][drive.drive] = {
            {"again_percent", drive.again}, {"never_percent", drive.never},
            {"best_percent", drive.best},   {"choices", names_of(evaluation, drive.choices)},
            {"since", drive.since},         {"changes", drive.changes},
            {"delays", drive.delays}};
    return json;
}

std::vector<Figure> reselection_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    if (evaluation.reselection)
        for (const eval::ReselectionResult &drive : evaluation.reselection->drives)
            figures.push_back(figure_of(evaluation, drive));
    return figures;
}

std::string reselection_section(const eval::Evaluation &evaluation)
{
    if (!evaluation.reselection)
        return "";
    return "<h2>Choosing again while driving</h2><p>The choice over time. Dashed lines: the drive "
           "goes on in another traversal. Choosing again gains " +
           escaped(mean_text(evaluation.reselection->gain)) + " points of Recall@1.</p>" +
           charts(reselection_figures(evaluation));
}

} // namespace vdna::report
