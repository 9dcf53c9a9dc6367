// The paper's ranking tables, in its colours.
#include <algorithm>

#include "eval/methods.hpp"
#include "eval/placing.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

// Not everybody can tell the colours apart, so add the number of ranks.
std::string mark_of(uint32_t off)
{
    return off == 0 ? "" : " " + text_element("b", "\u2195" + std::to_string(off));
}

std::string cell_of(const eval::Evaluation &evaluation, const eval::Place &place,
                    const std::string &value)
{
    const std::string tag = place.off == 0   ? "td"
                            : place.off == 1 ? "td class=\"one\""
                                             : "td class=\"more\"";
    return element(tag, escaped(value + " \u2013 " + name_of(evaluation, place.reference)) +
                            mark_of(place.off));
}

// columns: a ranking for each query.
template <typename Text>
std::string rows_of(const eval::Evaluation &evaluation,
                    const std::vector<std::vector<eval::Place>> &columns, const Text &text)
{
    size_t longest = 0;
    for (const std::vector<eval::Place> &places : columns)
        longest = std::max(longest, places.size());
    std::string rows;
    for (size_t rank = 0; rank < longest; rank++) {
        std::string row = text_element("th scope=\"row\"", std::to_string(rank + 1));
        for (const std::vector<eval::Place> &places : columns)
            row += rank < places.size()
                       ? cell_of(evaluation, places[rank], text(places[rank].value))
                       : "<td></td>";
        rows += element("tr", row);
    }
    return rows;
}

std::string true_table(const eval::Evaluation &evaluation)
{
    std::string head = "<th scope=\"col\">Rank</th>";
    std::vector<std::vector<eval::Place>> columns;
    for (size_t q = 0; q < evaluation.queries.size(); q++) {
        const eval::QueryResult &query = evaluation.queries[q];
        head += text_element("th scope=\"col\"", name_of(evaluation, query.traversal) + " / " +
                                                     program::fixed(query.all.recall[0], 2));
        columns.push_back(eval::true_places(evaluation, q));
    }
    return table(
        "The truth: Recall@1 in %, highest first", element("tr", head),
        rows_of(evaluation, columns, [](double recall) { return program::fixed(recall, 2); }));
}

std::string method_table(const eval::Evaluation &evaluation, const eval::MethodResult &method)
{
    std::string head = "<th scope=\"col\">Rank</th>";
    std::vector<std::vector<eval::Place>> columns;
    for (size_t q = 0; q < evaluation.queries.size(); q++) {
        head +=
            text_element("th scope=\"col\"", name_of(evaluation, evaluation.queries[q].traversal));
        columns.push_back(eval::predicted_places(evaluation, q, method));
    }
    return table(escaped(eval::title_of(method.name) + ": distance in " +
                         eval::unit_of(method.name) + ", lowest first"),
                 element("tr", head), rows_of(evaluation, columns, distance_text));
}

} // namespace

std::string rankings_section(const eval::Evaluation &evaluation)
{
    std::string html =
        "<h2>Rankings</h2>"
        "<p class=\"legend\"><span class=\"one\">orange <b>\u21951</b></span> one rank away from "
        "its true place; <span class=\"more\">red <b>\u21952</b></span> two or more.</p>" +
        true_table(evaluation);
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            html += method_table(evaluation, method);
    return html;
}

} // namespace vdna::report
