#include "report/result_tables.hpp"

#include <algorithm>
#include <cmath>

#include "eval/methods.hpp"
#include "eval/placing.hpp"
#include "program/print.hpp"
#include "program/text_table.hpp"
#include "report/localisers.hpp"
#include "report/reselection.hpp"
#include "report/trust.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr size_t line_width = 100; // wider tables are split

// Queries of one group that fit on a line, [begin, end).
struct Block {
    size_t begin, end;
};

// The width of a column: "98.98 - summer **".
size_t column_width(const eval::Evaluation &evaluation)
{
    size_t longest = 0;
    for (const eval::Traversal &traversal : *evaluation.traversals)
        longest = std::max(longest, traversal.name.size());
    return longest + 14;
}

std::vector<Block> blocks_of(const eval::Evaluation &evaluation)
{
    const std::vector<eval::Traversal> &traversals = *evaluation.traversals;
    const size_t most = std::max<size_t>(line_width / column_width(evaluation), 1);
    std::vector<Block> blocks;
    for (size_t q = 0; q < evaluation.queries.size(); q++) {
        const std::string &group = traversals[evaluation.queries[q].traversal].group;
        if (blocks.empty() || q - blocks.back().begin == most ||
            traversals[evaluation.queries[blocks.back().begin].traversal].group != group)
            blocks.push_back({q, q});
        blocks.back().end = q + 1;
    }
    return blocks;
}

// The mark of a misplaced reference: an escape sequence, or text after its name.
std::string colour_of(uint32_t off)
{
    return off == 0 ? "" : off == 1 ? "\x1b[38;5;208m" : "\x1b[31m";
}

std::string stars_of(uint32_t off)
{
    return off == 0 ? "" : off == 1 ? " *" : " **";
}

// Rankings as columns. Text: formats the value of a place.
template <typename Text>
void add_places(const eval::Evaluation &evaluation,
                const std::vector<std::vector<eval::Place>> &columns, bool colour, Text text,
                program::TextTable &table)
{
    size_t longest = 0;
    for (const std::vector<eval::Place> &places : columns)
        longest = std::max(longest, places.size());
    for (size_t rank = 0; rank < longest; rank++) {
        table.begin_row();
        for (const std::vector<eval::Place> &places : columns) {
            if (rank >= places.size()) {
                table.add("");
                continue;
            }
            const eval::Place &place = places[rank];
            const std::string name = (*evaluation.traversals)[place.reference].name;
            table.add(text(place.value) + " - " + name + (colour ? "" : stars_of(place.off)),
                      colour ? colour_of(place.off) : "");
        }
    }
}

std::string recall_table(const eval::Evaluation &evaluation, const Block &block)
{
    program::TextTable table;
    std::vector<std::vector<eval::Place>> columns;
    table.begin_row();
    for (size_t q = block.begin; q < block.end; q++) {
        const eval::QueryResult &query = evaluation.queries[q];
        table.add((*evaluation.traversals)[query.traversal].name + " / " +
                  program::fixed(query.all.recall[0], 2));
        columns.push_back(eval::true_places(evaluation, q));
    }
    add_places(
        evaluation, columns, false, [](double value) { return program::fixed(value, 2); }, table);
    return table.text();
}

std::string method_table(const eval::Evaluation &evaluation, const Block &block,
                         const eval::MethodResult &method, bool colour)
{
    program::TextTable table;
    std::vector<std::vector<eval::Place>> columns;
    table.begin_row();
    for (size_t q = block.begin; q < block.end; q++) {
        table.add((*evaluation.traversals)[evaluation.queries[q].traversal].name);
        columns.push_back(eval::predicted_places(evaluation, q, method));
    }
    add_places(evaluation, columns, colour, distance_text, table);
    return table.text();
}

// Unreachable live frames, one line per query.
std::string unreachable_text(const eval::Evaluation &evaluation)
{
    std::string text;
    for (const eval::QueryResult &query : evaluation.queries) {
        std::string line;
        for (const eval::PairResult &pair : query.pairs)
            if (pair.outcome.unreachable > 0)
                line += (line.empty() ? "" : ", ") + (*evaluation.traversals)[pair.reference].name +
                        " " + std::to_string(pair.outcome.unreachable);
        if (!line.empty())
            text += "  " + (*evaluation.traversals)[query.traversal].name + ", of " +
                    std::to_string(query.all.judged) + " in: " + line + "\n";
    }
    return text.empty() ? ""
                        : "\nLive frames without a map frame within tolerance (failures)\n" + text;
}

// Live frames without ground truth, one line per query.
std::string without_truth_text(const eval::Evaluation &evaluation)
{
    std::string text;
    for (const eval::QueryResult &query : evaluation.queries)
        if (query.all.judged < query.live.size())
            text += "  " + (*evaluation.traversals)[query.traversal].name + ": " +
                    std::to_string(query.live.size() - query.all.judged) + " of " +
                    std::to_string(query.live.size()) + "\n";
    return text.empty() ? ""
                        : "\nLive frames without ground truth, left out of the recall\n" + text;
}

// Without trailing zeros.
std::string shortest(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

std::string number(double value, int digits)
{
    return std::isnan(value) ? "-" : program::fixed(value, digits);
}

bool has_interval(const eval::JudgedRanking &judged)
{
    return std::any_of(
        eval::ranking_metrics.begin(), eval::ranking_metrics.end(),
        [&](const eval::RankingMetric &metric) { return !std::isnan(judged.low.*metric.value); });
}

std::string summary_of(const eval::Evaluation &evaluation)
{
    return evaluation.dataset + ": " + std::to_string(evaluation.queries.size()) + " queries, " +
           std::to_string(evaluation.references.size()) + " references; " +
           evaluation.backbone.identity.backbone + ", " +
           std::to_string(evaluation.backbone.identity.neurons) + " neurons, " +
           std::to_string(evaluation.bins) + " bins; warmup " + evaluation.warmup +
           (evaluation.warmup.back() == 's' ? "" : " frames") + ", tolerance " +
           shortest(evaluation.tolerance) + " " + name_of(evaluation.unit) + ", stride " +
           std::to_string(evaluation.stride) + "\n";
}

} // namespace

std::string tables_of(const eval::Evaluation &evaluation, bool colour)
{
    std::string text = summary_of(evaluation);
    const std::vector<Block> blocks = blocks_of(evaluation);
    text += "\nRecall@1 in percent; query / in all references at once\n";
    for (const Block &block : blocks)
        text += (block.begin > 0 ? "\n" : "") + recall_table(evaluation, block);
    for (const eval::MethodResult &method : evaluation.methods) {
        if (method.distance.empty())
            continue;
        text += "\n" + eval::title_of(method.name) + ", " + eval::unit_of(method.name) + "\n";
        for (const Block &block : blocks)
            text += (block.begin > 0 ? "\n" : "") + method_table(evaluation, block, method, colour);
    }
    return text + unreachable_text(evaluation) + without_truth_text(evaluation) + "\n" +
           error_table(evaluation.methods) + "\n" + localiser_tables(evaluation) +
           (evaluation.reselection ? reselection_table(evaluation) : "") +
           (evaluation.trust ? trust_text(*evaluation.trust) : "");
}

std::string error_table(const std::vector<eval::MethodResult> &methods)
{
    program::TextTable table;
    table.begin_row();
    table.add("method");
    for (const eval::RankingMetric &metric : eval::ranking_metrics)
        table.add(metric.short_title);
    for (const eval::MethodResult &method : methods) {
        table.begin_row();
        table.add(method.name);
        for (const eval::RankingMetric &metric : eval::ranking_metrics)
            table.add(number(method.judged.metrics.*metric.value, 3));
        if (!has_interval(method.judged))
            continue;
        table.begin_row();
        table.add("  95 %");
        for (const eval::RankingMetric &metric : eval::ranking_metrics) {
            const eval::Mean mean = method.judged.of(metric.value);
            table.add(number(mean.low, 2) + " to " + number(mean.high, 2));
        }
    }
    const std::string left_out =
        methods.empty() ? "" : left_out_text(methods.front().judged.metrics);
    return table.text() + left_out + (left_out.empty() ? "" : "\n");
}

std::string table_of(const eval::Ablation &ablation)
{
    program::TextTable table;
    table.begin_row();
    table.add(ablation.kind);
    for (const eval::MethodResult &method : ablation.rows.front().methods) {
        if (eval::is_of_tap(method.name))
            continue; // one tap among several
        table.add(method.name + " error/%");
        table.add("regret/%");
    }
    for (const eval::AblationRow &row : ablation.rows) {
        table.begin_row();
        table.add(row.value);
        for (const eval::MethodResult &method : row.methods) {
            if (eval::is_of_tap(method.name))
                continue;
            table.add(
                mean_text(method.judged.of(&vdna_ranking_metrics::ranking_error_swap_once), 3));
            table.add(mean_text(method.judged.of(&vdna_ranking_metrics::regret), 3));
        }
    }
    return table.text();
}

} // namespace vdna::report
