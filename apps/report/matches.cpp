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

// Right or wrong matches, spread evenly over the drive.
std::vector<eval::FrameMatch> picked(const std::vector<eval::FrameMatch> &matches, bool good)
{
    std::vector<eval::FrameMatch> all, few;
    std::copy_if(matches.begin(), matches.end(), std::back_inserter(all),
                 [&](const eval::FrameMatch &match) { return match.judged && match.good == good; });
    const size_t count = std::min(all.size(), matches_of_a_kind);
    for (size_t i = 0; i < count; i++)
        few.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
    return few;
}

std::string figure(const eval::Evaluation &evaluation, const eval::QueryResult &query,
                   const eval::FrameMatch &match)
{
    const eval::Traversal &live = (*evaluation.traversals)[query.traversal];
    const eval::Traversal &map = (*evaluation.traversals)[match.traversal];
    const double apart =
        record::Truth(live.recording, eval::map_of(map.recording, evaluation.backbone.identity.dim),
                      evaluation.with_altitude)
            .apart(match.live, match.frame);
    const std::string frames =
        "frame " + std::to_string(match.live) + " | " + std::to_string(match.frame);
    const std::string distance =
        std::isnan(apart) ? "no ground truth of the map frame"
                          : program::fixed(apart, evaluation.unit == record::Unit::metres ? 1 : 0) +
                                " " + name_of(evaluation.unit) + " apart";
    return element(
        match.good ? "figure class=\"right\"" : "figure class=\"wrong\"",
        element("div class=\"pair\"", photo(live.files[match.live], live.name + ", live") +
                                          photo(map.files[match.frame], map.name + ", map")) +
            element("figcaption", (match.good ? "\u2713 right: " : "\u2717 wrong: ") +
                                      escaped(frames + ", " + distance) +
                                      (match.reachable ? "" : "; nothing nearer in the map")));
}

std::string matches_of(const eval::Evaluation &evaluation, const eval::QueryResult &query,
                       const eval::PairResult &pair)
{
    std::string html;
    for (const bool good : {true, false}) {
        const std::vector<eval::FrameMatch> matches = picked(pair.outcome.matches, good);
        std::string figures;
        for (const eval::FrameMatch &match : matches)
            figures += figure(evaluation, query, match);
        html += matches.empty() ? element("p", good ? "No match is right." : "No match is wrong.")
                                : element("div class=\"matches\"", figures);
    }
    return html;
}

// The reference that Visual DNA chooses for this query.
const eval::PairResult &first_choice(const eval::Evaluation &evaluation, size_t query)
{
    const size_t reference =
        eval::predicted_places(evaluation, query, evaluation.methods.front()).front().reference;
    const std::vector<eval::PairResult> &pairs = evaluation.queries[query].pairs;
    return *std::find_if(pairs.begin(), pairs.end(),
                         [&](const eval::PairResult &pair) { return pair.reference == reference; });
}

} // namespace

std::string matches_section(const eval::Evaluation &evaluation)
{
    std::string html = "<h2>Right and wrong matches</h2><p>Live frames (left) and the nearest "
                       "frames (right) of the reference that Visual DNA chooses first. A match is "
                       "right if it is within the " +
                       escaped(tolerance_text(evaluation)) + ".</p>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    for (size_t q = 0; q < shown; q++) {
        program::require_not_interrupted();
        const eval::QueryResult &query = evaluation.queries[q];
        const eval::PairResult &pair = first_choice(evaluation, q);
        html += foldable("Query " + text_element("b", name_of(evaluation, query.traversal)) +
                             " in " + text_element("b", name_of(evaluation, pair.reference)) +
                             ": " + std::to_string(pair.outcome.good) + " of " +
                             std::to_string(pair.outcome.judged) + " right",
                         q == 0, matches_of(evaluation, query, pair));
    }
    return html;
}

} // namespace vdna::report
