// The sections of the report, each from its <h2> on, and the figures in them, which have names of
// their own; shown_most limits both.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"
#include "report/figure.hpp"

namespace vdna::report
{

// Maximum number of queries, and of references for each, in sections with a part per query. More
// would be hard to compare and make the page large.
constexpr size_t shown_most = 12;

// Figures side by side, with their captions.
std::string charts(const std::vector<Figure> &figures);

// How well each method ranks, one row per method.
std::string averages_section(const eval::Evaluation &evaluation);

// The true ranking of each query, and the ranking of each method with its mistakes.
std::string rankings_section(const eval::Evaluation &evaluation);

// Difference matrices with the matches, of single references and of all at once.
std::string matrices_section(const eval::Evaluation &evaluation);
std::vector<Figure> matrix_figures(const eval::Evaluation &evaluation);

// Distance against recall, with a chart per method.
std::string correlation_section(const eval::Evaluation &evaluation);
std::vector<Figure> correlation_figures(const eval::Evaluation &evaluation);

// The localisers side by side, with their confidence.
std::string localisers_section(const eval::Evaluation &evaluation);
std::vector<Figure> localiser_figures(const eval::Evaluation &evaluation);

// Trust in the choice; "" if it was not asked for.
std::string trust_section(const eval::Evaluation &evaluation);
std::vector<Figure> trust_figures(const eval::Evaluation &evaluation);

// Choosing again while driving, with a chart per drive; "" if it was not asked for.
std::string reselection_section(const eval::Evaluation &evaluation);
std::vector<Figure> reselection_figures(const eval::Evaluation &evaluation);

// Pictures of right and wrong matches in the first choice. Reads picture files.
std::string matches_section(const eval::Evaluation &evaluation);
std::vector<Figure> match_figures(const eval::Evaluation &evaluation);

// Which neurons tell the first choice from the second.
std::string neurons_section(const eval::Evaluation &evaluation);
std::vector<Figure> neuron_figures(const eval::Evaluation &evaluation);

// "" if there are none.
std::string ablations_section(const std::vector<eval::Ablation> &ablations);

// What the words of the report mean.
std::string words_section(const eval::Evaluation &evaluation);

} // namespace vdna::report
