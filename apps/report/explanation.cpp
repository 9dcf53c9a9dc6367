#include "report/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "program/choice_sentence.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/picture.hpp"

namespace vdna::report
{

namespace
{

std::string number_cell(double value, int digits)
{
    return text_element("td class=\"number\"", number_text(value, digits));
}

std::string head_cells(const std::vector<std::string> &texts)
{
    std::string cells;
    for (const std::string &text : texts)
        cells += text_element("th scope=\"col\"", text);
    return element("tr", cells);
}

// A signed number with a bar of proportional length.
std::string bar_cell(double value, double longest)
{
    return element("td class=\"number\"",
                   program::fixed(value, 4) + "<svg class=\"" +
                       (value < 0 ? "bar against" : "bar") +
                       "\" viewBox=\"0 0 100 8\" aria-hidden=\"true\" "
                       "preserveAspectRatio=\"none\"><rect width=\"" +
                       program::fixed(longest > 0 ? 100 * std::fabs(value) / longest : 0, 1) +
                       "\" height=\"8\"/></svg>");
}

// Numbers of the frames with most and least.
std::string text_of(const ExampleFrames &frames)
{
    return frames.most < 0 ? "\u2013"
                           : std::to_string(frames.most) + " | " + std::to_string(frames.least);
}

// Those of one run side by side; "" if there are none.
std::string pictures_html(const ExamplePictures &pictures, const std::string &of,
                          const std::string &which)
{
    const Encoded most = thumbnail_jpeg(pictures.most), least = thumbnail_jpeg(pictures.least);
    if (most.bytes.empty() || least.bytes.empty())
        return "";
    return element("figure",
                   element("div class=\"pair\"",
                           photo_html(most, of + ", most") + photo_html(least, of + ", least")) +
                       element("figcaption", text_element("b", of) + ", " + escaped(which)));
}

std::string name_of(const Explainer &explainer, const Reason &reason)
{
    return explainer.taps()[reason.tap].name + " " + std::to_string(reason.index);
}

bool has_bins(const Explainer &explainer)
{
    return !std::isnan(explainer.reasons().front().live_bin);
}

std::vector<std::string> heads_of(const Explanation &explanation)
{
    const std::string &winner = explanation.winner, &against = explanation.against;
    std::vector<std::string> heads = {"Neuron", "Margin, bins", "Share, %", winner + ", bins",
                                      against + ", bins"};
    if (has_bins(explanation.explainer))
        heads.insert(heads.end(), {"Mean bin, live", "Mean bin, " + winner, "Mean bin, " + against,
                                   "Frames of " + winner + ", most | least",
                                   "Frames of " + against + ", most | least"});
    return heads;
}

std::string row_of(const Explanation &explanation, size_t i)
{
    const Explainer &explainer = explanation.explainer;
    const Reason &reason = explainer.reasons()[i];
    const double longest = std::fabs(explainer.reasons().front().part.margin_bins);
    std::string row = text_element("th scope=\"row\"", name_of(explainer, reason)) +
                      bar_cell(reason.part.margin_bins, longest) +
                      text_element("td class=\"number\"", share_text(explainer, reason.part)) +
                      number_cell(reason.part.winner_bins, 4) +
                      number_cell(reason.part.against_bins, 4);
    if (has_bins(explainer))
        row += number_cell(reason.live_bin, 1) + number_cell(reason.winner_bin, 1) +
               number_cell(reason.against_bin, 1) +
               text_element("td class=\"number\"", text_of(reason.of_winner)) +
               text_element("td class=\"number\"", text_of(reason.of_against));
    return element("tr", row);
}

// What the named neurons see: for each, the frames of all runs with most and least of it.
std::string pictures_section(const Explanation &explanation)
{
    std::string html;
    for (size_t i = 0; i < explanation.pictures.size(); i++) {
        const ReasonPictures &pictures = explanation.pictures[i];
        const Reason &reason = explanation.explainer.reasons()[i];
        const std::string figures = pictures_html(pictures.live, "live", "most | least") +
                                    pictures_html(pictures.winner, explanation.winner,
                                                  "frames " + text_of(reason.of_winner)) +
                                    pictures_html(pictures.against, explanation.against,
                                                  "frames " + text_of(reason.of_against));
        if (!figures.empty())
            html += text_element("h3", name_of(explanation.explainer, reason)) +
                    element("div class=\"examples\"", figures);
    }
    return html.empty()
               ? html
               : "<h2>Frames with most and least of each neuron</h2>" + html + "<h2>Numbers</h2>";
}

} // namespace

std::string sentence_of(const Explanation &explanation)
{
    const std::vector<Reason> &reasons = explanation.explainer.reasons();
    const vdna_reason whole = explanation.explainer.whole();
    const double named =
        std::accumulate(reasons.begin(), reasons.end(), 0.0, [](double sum, const Reason &reason) {
            return sum + reason.part.margin_bins;
        });
    const program::MarginShare share{
        explanation.winner.c_str(),       explanation.against.c_str(),  whole.margin_bins, named,
        static_cast<int>(reasons.size()), static_cast<int>(whole.count)};
    return program::sentence_of(share).data();
}

std::string share_text(const Explainer &explainer, const vdna_reason &part)
{
    const double margin = explainer.whole().margin_bins;
    return number_text(margin == 0 ? std::nan("") : 100 * part.margin_bins / margin, 1);
}

std::string reasons_table(const Explanation &explanation)
{
    std::string rows;
    for (size_t i = 0; i < explanation.explainer.reasons().size(); i++)
        rows += row_of(explanation, i);
    return table("Neurons that tell " + escaped(explanation.winner) + " from " +
                     escaped(explanation.against) + " best",
                 head_cells(heads_of(explanation)), rows);
}

std::string taps_table(const Explanation &explanation)
{
    const Explainer &explainer = explanation.explainer;
    std::string rows;
    for (const Tap &tap : explainer.taps()) {
        const vdna_reason part = explainer.of_tap(tap);
        rows +=
            element("tr", text_element("th scope=\"row\"", tap.name) +
                              text_element("td class=\"number\"", std::to_string(part.count)) +
                              number_cell(part.margin_bins, 4) +
                              text_element("td class=\"number\"", share_text(explainer, part)) +
                              number_cell(part.winner_bins, 4) + number_cell(part.against_bins, 4));
    }
    return table("Taps",
                 head_cells({"Tap", "Neurons", "Margin, bins", "Share, %",
                             explanation.winner + ", bins", explanation.against + ", bins"}),
                 rows);
}

std::string explanation_page(const Explanation &explanation, const std::string &headline,
                             const std::vector<std::string> &facts)
{
    std::string body = text_element("h1", headline);
    for (const std::string &fact : facts)
        body += text_element("p", fact);
    return page(headline, body + pictures_section(explanation) + reasons_table(explanation) +
                              taps_table(explanation));
}

} // namespace vdna::report
