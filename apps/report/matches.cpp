// Pictures of right and wrong matches.
#include <algorithm>
#include <cmath>

#include "eval/placing.hpp"
#include "eval/reference_maps.hpp"
#include "program/interrupt.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/picture.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr size_t matches_of_a_kind = 3;
constexpr double file_width = 1100;

// A match of a query's frame in the reference that Visual DNA chooses.
struct ChosenMatch {
    const eval::QueryResult *query;
    eval::FrameMatch match;
};

// A match to show.
struct Pair {
    Encoded live, map; // pictures
    bool good;
    std::string names; // "dusk in night"
    std::string facts; // "frame 96 | 103, 4 places apart"
};

const eval::PairResult &first_choice(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<eval::Place> places =
        eval::predicted_places(evaluation, query, evaluation.methods.front());
    return eval::pair_with(evaluation.queries[query], places.front().reference);
}

// The judged matches of queries [begin, end), each in its first choice.
std::vector<ChosenMatch> matches_of(const eval::Evaluation &evaluation, size_t begin, size_t end)
{
    std::vector<ChosenMatch> matches;
    for (size_t q = begin; q < end; q++)
        for (const eval::FrameMatch &match : first_choice(evaluation, q).outcome.matches)
            if (match.judged)
                matches.push_back({&evaluation.queries[q], match});
    return matches;
}

// Right or wrong matches, spread evenly.
std::vector<ChosenMatch> picked(const std::vector<ChosenMatch> &matches, bool good)
{
    std::vector<ChosenMatch> all, few;
    std::copy_if(matches.begin(), matches.end(), std::back_inserter(all),
                 [&](const ChosenMatch &chosen) { return chosen.match.good == good; });
    const size_t count = std::min(all.size(), matches_of_a_kind);
    for (size_t i = 0; i < count; i++)
        few.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
    return few;
}

std::string apart_text(const eval::Evaluation &evaluation, const ChosenMatch &chosen)
{
    const eval::Traversal &live = (*evaluation.traversals)[chosen.query->traversal];
    const eval::Traversal &map = (*evaluation.traversals)[chosen.match.traversal];
    const double apart =
        record::Truth(live.recording, eval::map_of(map.recording, evaluation.backbone.identity.dim),
                      evaluation.with_altitude)
            .apart(chosen.match.live, chosen.match.frame);
    if (std::isnan(apart))
        return "no ground truth of the map frame";
    return program::fixed(apart, evaluation.unit == record::Unit::metres ? 1 : 0) + " " +
           name_of(evaluation.unit) + " apart";
}

Pair pair_of(const eval::Evaluation &evaluation, const ChosenMatch &chosen)
{
    program::require_not_interrupted();
    const eval::Traversal &live = (*evaluation.traversals)[chosen.query->traversal];
    const eval::Traversal &map = (*evaluation.traversals)[chosen.match.traversal];
    return {photo_jpeg(live.files[chosen.match.live]), photo_jpeg(map.files[chosen.match.frame]),
            chosen.match.good, live.name + " in " + map.name,
            "frame " + std::to_string(chosen.match.live) + " | " +
                std::to_string(chosen.match.frame) + ", " + apart_text(evaluation, chosen) +
                (chosen.match.reachable ? "" : "; nothing nearer in the map")};
}

// Right ones, then wrong ones.
std::vector<Pair> pairs_of(const eval::Evaluation &evaluation, size_t begin, size_t end)
{
    std::vector<Pair> pairs;
    const std::vector<ChosenMatch> matches = matches_of(evaluation, begin, end);
    for (const bool good : {true, false})
        for (const ChosenMatch &chosen : picked(matches, good))
            pairs.push_back(pair_of(evaluation, chosen));
    return pairs;
}

std::string html_of(const Pair &pair)
{
    return element(pair.good ? "figure class=\"right\"" : "figure class=\"wrong\"",
                   element("div class=\"pair\"", photo_html(pair.live, "live frame") +
                                                     photo_html(pair.map, "map frame")) +
                       element("figcaption",
                               text_element("b", (pair.good ? "\u2713 right: " : "\u2717 wrong: ") +
                                                     pair.names) +
                                   "<br>" + escaped(pair.facts)));
}

std::string html_of(const std::vector<Pair> &pairs)
{
    std::string html;
    for (const bool good : {true, false}) {
        std::string figures;
        for (const Pair &pair : pairs)
            if (pair.good == good)
                figures += html_of(pair);
        html += figures.empty() ? element("p", good ? "No match is right." : "No match is wrong.")
                                : element("div class=\"matches\"", figures);
    }
    return html;
}

void add_photo(const Encoded &photo, double x, double width, double height, Figure &figure)
{
    if (photo.bytes.empty())
        figure.items.push_back(Box{x, 0, width, height, faint, false});
    else
        figure.items.push_back(
            Raster{x, 0, width, height, photo.bytes, true, photo.columns, photo.rows});
}

// The pictures side by side, and below them what they are.
Figure figure_of(const Pair &pair)
{
    constexpr double width = 130, between = 3;
    const auto height_of = [](const Encoded &photo) {
        return photo.columns > 0 ? width * photo.rows / photo.columns : 0.75 * width;
    };
    const double live = height_of(pair.live), map = height_of(pair.map);
    const double below = std::max(live, map);
    Figure figure{"", "", 2 * width + between, below + 34};
    add_photo(pair.live, 0, width, live, figure);
    add_photo(pair.map, width + between, width, map, figure);
    figure.items.push_back(pair.good ? Marks{Shape::dot, 4, right_colour, {{6, below + 11}}}
                                     : Marks{Shape::cross, 4, wrong_colour, {{6, below + 11}}});
    figure.items.push_back(Text{16, below + 15,
                                (pair.good ? "right: " : "wrong: ") + shortened(pair.names, 36),
                                Anchor::start, ink, true});
    figure.items.push_back(Text{16, below + 29, pair.facts});
    return figure;
}

Figure figure_of(const std::string &name, const std::string &title, const std::vector<Pair> &pairs)
{
    std::vector<Figure> parts;
    for (const Pair &pair : pairs)
        parts.push_back(figure_of(pair));
    return arranged(name, title, parts, file_width);
}

} // namespace

std::vector<Figure> match_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures = {figure_of("pairs", "Right and wrong matches",
                                             pairs_of(evaluation, 0, evaluation.queries.size()))};
    for (size_t q = 0; q < std::min(evaluation.queries.size(), shown_most); q++) {
        const std::string &name = name_of(evaluation, evaluation.queries[q].traversal);
        figures.push_back(figure_of("pairs-" + name, "Right and wrong matches of the query " + name,
                                    pairs_of(evaluation, q, q + 1)));
    }
    return figures;
}

std::string matches_section(const eval::Evaluation &evaluation)
{
    std::string each;
    for (size_t q = 0; q < std::min(evaluation.queries.size(), shown_most); q++) {
        const eval::QueryResult &query = evaluation.queries[q];
        const eval::PairResult &pair = first_choice(evaluation, q);
        each += element("h3", text_element("b", name_of(evaluation, query.traversal)) + " in " +
                                  text_element("b", name_of(evaluation, pair.reference)) + ": " +
                                  std::to_string(pair.outcome.good) + " of " +
                                  std::to_string(pair.outcome.judged) + " right") +
                html_of(pairs_of(evaluation, q, q + 1));
    }
    return "<h2>Right and wrong matches</h2><p>Live frame | nearest frame of the reference that "
           "Visual DNA chooses. Right is within the " +
           escaped(tolerance_text(evaluation)) + ".</p>" +
           html_of(pairs_of(evaluation, 0, evaluation.queries.size())) +
           foldable("Matches of each query", false, each);
}

} // namespace vdna::report
