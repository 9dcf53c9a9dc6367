#include "report/report.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/version.h>

#include "program/print.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

// " (95 % interval over 8 queries: 0.40 to 2.10)", or "" if there is none.
std::string interval_text(const eval::Mean &mean, const std::string &words)
{
    if (std::isnan(mean.low))
        return "";
    return " (" + words + number_text(mean.low, 2) + " to " + number_text(mean.high, 2) + ")";
}

// The main result in one sentence.
std::string result_of(const eval::Evaluation &evaluation)
{
    const eval::JudgedRanking &judged = evaluation.methods.front().judged;
    if (judged.metrics.queries == 0)
        return left_out_text(judged.metrics);
    const eval::Mean ours = judged.of(&vdna_ranking_metrics::regret);
    const eval::Mean chance = evaluation.methods.back().judged.of(&vdna_ranking_metrics::regret);
    return "Localising in the reference that Visual DNA chooses, instead of the best one, costs " +
           number_text(ours.value, 2) + " percentage points of Recall@1" +
           interval_text(ours, "95 % interval over " + std::to_string(judged.metrics.queries) +
                                   " queries: ") +
           "; choosing by chance costs " + number_text(chance.value, 2) +
           interval_text(chance, "") + ".";
}

std::string headline(const eval::Evaluation &evaluation)
{
    return text_element("h1", "Experience selection on " + evaluation.dataset) +
           text_element("p class=\"result\"", result_of(evaluation)) +
           text_element("p class=\"facts\"",
                        evaluation.backbone.identity.backbone + std::string(", ") +
                            warmup_text(evaluation) + ", " + tolerance_text(evaluation) + "; " +
                            std::to_string(evaluation.queries.size()) + " queries, " +
                            std::to_string(evaluation.references.size()) + " references");
}

// Sections with a part for each query show only the first of many queries.
std::string omission(const eval::Evaluation &evaluation)
{
    if (std::max(evaluation.queries.size(), evaluation.references.size()) <= shown_most)
        return "";
    return text_element("p", "In parts for each query, the first " + std::to_string(shown_most) +
                                 " queries and references are shown.");
}

std::string frames_table(const eval::Evaluation &evaluation)
{
    std::string rows;
    for (const eval::QueryResult &query : evaluation.queries) {
        const record::Recording &recording = (*evaluation.traversals)[query.traversal].recording;
        rows += element(
            "tr", text_element("th scope=\"row\"", name_of(evaluation, query.traversal)) +
                      text_element("td class=\"number\"", std::to_string(recording.frames)) +
                      text_element("td class=\"number\"", std::to_string(query.warmup_frames)) +
                      text_element("td class=\"number\"", std::to_string(query.live.size())) +
                      text_element("td class=\"number\"",
                                   std::to_string(query.live.size() - query.all.judged)) +
                      text_element("td class=\"number\"", std::to_string(recording.account.bad)));
    }
    return "<h2>Frames</h2>" +
           table("Frames of each query",
                 "<tr><th scope=\"col\">Query</th><th scope=\"col\">All</th><th scope=\"col\">"
                 "Warmup</th><th scope=\"col\">Localised</th><th scope=\"col\">Without truth</th>"
                 "<th scope=\"col\">Unusable</th></tr>",
                 rows);
}

std::string making_section(const eval::Evaluation &evaluation, const std::string &command_line)
{
    const vdna_backbone_info &backbone = evaluation.backbone;
    std::string list;
    const auto add = [&](const std::string &term, const std::string &text) {
        list += text_element("dt", term) + text_element("dd", text);
    };
    list += "<dt>Command</dt><dd>" + text_element("code", command_line) + "</dd>";
    add("Program", std::string("vdna ") + vdna_version() + ", " + backbone.runtime);
    add("Network",
        backbone.identity.backbone + std::string(", SHA-256 ") + backbone.identity.model_sha256);
    add("Taps", backbone.identity.taps);
    add("Histograms", std::to_string(backbone.identity.neurons) + " neurons of " +
                          std::to_string(evaluation.bins) + " bins");
    add("Localised", evaluation.stride == 1 ? "every frame after the warmup"
                                            : "one in " + std::to_string(evaluation.stride) +
                                                  " frames after the warmup");
    add("Frames", std::to_string(evaluation.computed) + " computed, " +
                      std::to_string(evaluation.cached) + " from the cache");
    return "<h2>How this was made</h2>" + element("dl", list);
}

} // namespace

std::string report_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations, const std::string &command_line)
{
    // The answer, then pictures, then tables, then words.
    const std::string body = headline(evaluation) + omission(evaluation) +
                             matches_section(evaluation) + matrices_section(evaluation) +
                             correlation_section(evaluation) + averages_section(evaluation) +
                             rankings_section(evaluation) + localisers_section(evaluation) +
                             trust_section(evaluation) + reselection_section(evaluation) +
                             neurons_section(evaluation) + ablations_section(ablations) +
                             frames_table(evaluation) + words_section(evaluation) +
                             making_section(evaluation, command_line);
    return page("Experience selection on " + evaluation.dataset, body);
}

} // namespace vdna::report
