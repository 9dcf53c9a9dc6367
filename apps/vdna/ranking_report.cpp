#include "vdna/ranking_report.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>

#include "program/print.hpp"

namespace vdna::tool
{

namespace
{

double margin_of(const Ranking &ranking)
{
    const std::vector<vdna_rank_entry> &e = ranking.entries;
    return e.size() > 1 ? e[1].distance_bins - e[0].distance_bins : 0;
}

std::string percent(double share)
{
    return std::isnan(share) ? "-" : program::fixed(100 * share, 1);
}

std::string interval(const vdna_trust_prediction &prediction)
{
    return std::isnan(prediction.recall)
               ? "-"
               : percent(prediction.low) + " to " + percent(prediction.high);
}

using Number = double vdna_trust_prediction::*;

// Whether any candidate has this number, and it means something: of a run that is like none of the
// map's, nobody knows what those got.
bool has(const Ranking &ranking, Number number)
{
    if (!ranking.expectation || looks_like_none(ranking.expectation->answer.verdict))
        return false;
    const std::vector<vdna_trust_prediction> &all = ranking.expectation->predictions;
    return std::any_of(all.begin(), all.end(),
                       [&](const vdna_trust_prediction &p) { return !std::isnan(p.*number); });
}

// The heads of the columns after the name, or the cells of a candidate.
std::vector<std::string> cells_of(const Ranking &ranking, const vdna_rank_entry *entry)
{
    std::vector<std::string> cells;
    cells.push_back(entry ? program::fixed(entry->distance_bins, 4) : "distance/bins");
    const auto prediction = [&] { return ranking.expectation->predictions[entry->candidate]; };
    if (has(ranking, &vdna_trust_prediction::transfer))
        cells.push_back(entry ? percent(prediction().transfer) : "transfer/%");
    if (has(ranking, &vdna_trust_prediction::recall)) {
        cells.push_back(entry ? percent(prediction().recall) : "recall/%");
        cells.push_back(entry ? interval(prediction()) : "of 80 %");
    }
    for (size_t t = 0; t < ranking.taps.size(); t++)
        cells.push_back(entry ? program::fixed(ranking.tap_distances[entry->candidate][t], 4)
                              : ranking.taps[t].name);
    return cells;
}

void add_prediction(program::Json &json, const vdna_trust_prediction &prediction)
{
    json.update({{"predicted_recall", program::known(prediction.recall)},
                 {"predicted_low", program::known(prediction.low)},
                 {"predicted_high", program::known(prediction.high)},
                 {"no_prediction", vdna_trust_reason_text(prediction.reason)},
                 {"transfer", program::known(prediction.transfer)},
                 {"nearest", program::known(prediction.nearest)},
                 {"score", program::known(prediction.score)}});
}

program::Json json_of(const Ranking &ranking, const vdna_rank_entry &entry)
{
    program::Json json = {{"experience", ranking.names[entry.candidate]},
                          {"distance_bins", entry.distance_bins},
                          {"tied", entry.tied != 0}};
    if (ranking.expectation)
        add_prediction(json, ranking.expectation->predictions[entry.candidate]);
    for (size_t t = 0; t < ranking.taps.size(); t++)
        json["taps"].push_back({{"tap", ranking.taps[t].name},
                                {"distance_bins", ranking.tap_distances[entry.candidate][t]}});
    return json;
}

void add_expectation(program::Json &json, const Expectation &expectation)
{
    json.update({{"verdict", name_of_verdict(expectation.answer.verdict)},
                 {"unlike", program::known(expectation.answer.unlike)},
                 {"settled_frames", expectation.answer.settled_frames},
                 {"labelled", expectation.fit.labelled},
                 {"skill", program::known(expectation.fit.skill)},
                 {"sentence", expectation.sentence}});
}

} // namespace

void report(const Ranking &ranking)
{
    size_t width = std::string("experience").size();
    for (const std::string &name : ranking.names)
        width = std::max(width, name.size());
    const auto print_row = [&](const std::string &name, const vdna_rank_entry *entry) {
        std::cout << "  " << std::left << std::setw(static_cast<int>(width)) << name << std::right;
        for (const std::string &cell : cells_of(ranking, entry))
            std::cout << "  " << std::setw(14) << cell;
    };

    std::cout << ranking.query << ": " << ranking.frames << " frames";
    if (ranking.without_truth > 0)
        std::cout << ", " << ranking.without_truth << " without ground truth";
    std::cout << ", ranked by " << name_of_order(ranking.ranked_by) << "\nrank";
    print_row("experience", nullptr);
    std::cout << '\n';
    for (size_t i = 0; i < ranking.entries.size(); i++) {
        const vdna_rank_entry &entry = ranking.entries[i];
        std::cout << std::setw(4) << i + 1;
        print_row(ranking.names[entry.candidate], &entry);
        std::cout << (entry.tied ? "  tied\n" : "\n");
    }
    std::cout << "margin of the first choice: " << program::fixed(margin_of(ranking), 4)
              << " bins\n";
    if (ranking.expectation)
        std::cout << ranking.expectation->sentence << '\n';
}

void report_json(const Ranking &ranking)
{
    program::Json entries = program::Json::array();
    for (const vdna_rank_entry &entry : ranking.entries)
        entries.push_back(json_of(ranking, entry));
    program::Json json = {{"query", ranking.query}, {"frames", ranking.frames}};
    json.update(frames::json_of(ranking.account));
    json.update({{"frames_without_truth", ranking.without_truth},
                 {"restarts", ranking.restarts},
                 {"ranked_by", name_of_order(ranking.ranked_by)},
                 {"margin_bins", margin_of(ranking)},
                 {"ranking", entries}});
    if (ranking.expectation)
        add_expectation(json, *ranking.expectation);
    program::print_json(json);
}

} // namespace vdna::tool
