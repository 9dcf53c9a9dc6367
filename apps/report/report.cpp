#include "report/report.hpp"

#include <algorithm>

#include <vdna/version.h>

#include "program/print.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

// The main result in one sentence.
std::string result_of(const eval::Evaluation &evaluation)
{
    const vdna_ranking_metrics &ours = evaluation.methods.front().metrics;
    const vdna_ranking_metrics &chance = evaluation.methods.back().metrics;
    if (ours.queries == 0)
        return left_out_text(ours);
    return "Ranking the references by Visual DNA costs " +
           number_text(ours.ranking_error_swap_once, 2) +
           " percentage points of recall on average (the paper's ranking error; by chance " +
           number_text(chance.ranking_error_swap_once, 2) +
           "), and localising in its first choice instead of the best one costs " +
           number_text(ours.regret, 2) + " (by chance " + number_text(chance.regret, 2) + ").";
}

std::string headline(const eval::Evaluation &evaluation)
{
    return text_element("h1", "Experience selection on " + evaluation.dataset) +
           text_element("p class=\"facts\"",
                        evaluation.backbone.identity.backbone + std::string(", ") +
                            warmup_text(evaluation) + ", " + tolerance_text(evaluation) + "; " +
                            std::to_string(evaluation.queries.size()) + " queries, " +
                            std::to_string(evaluation.references.size()) + " references") +
           text_element("p class=\"result\"", result_of(evaluation)) +
           "<p>A robot has driven the same route several times, in different conditions: these "
           "are its <i>references</i>. It drives again: this is the <i>query</i>. Which reference "
           "is the best map for this drive? Each method answers from the first frames of the "
           "query alone, the <i>warmup</i>. Then the remaining frames are localised in every "
           "reference, and <i>Recall@1</i>, the share of frames found at the right place, gives "
           "the best answer.</p>";
}

// Sections with a part for each query show only the first of many queries.
std::string omission(const eval::Evaluation &evaluation)
{
    if (std::max(evaluation.queries.size(), evaluation.references.size()) <= shown_most)
        return "";
    return text_element("p", "Below, the first " + std::to_string(shown_most) +
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
    return table("Frames",
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
    return "<h2>How this was made</h2>" + element("dl", list) + frames_table(evaluation);
}

} // namespace

std::string report_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations, const std::string &command_line)
{
    const std::string body = headline(evaluation) + averages_section(evaluation) +
                             rankings_section(evaluation) + localisers_section(evaluation) +
                             trust_section(evaluation) + reselection_section(evaluation) +
                             omission(evaluation) + matrices_section(evaluation) +
                             correlation_section(evaluation) + matches_section(evaluation) +
                             neurons_section(evaluation) + ablations_section(ablations) +
                             making_section(evaluation, command_line);
    return page("Experience selection on " + evaluation.dataset, body);
}

} // namespace vdna::report
