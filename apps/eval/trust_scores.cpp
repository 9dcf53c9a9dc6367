#include "eval/trust_scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <vdna/baseline.h>
#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double mean_of(const std::vector<double> &values)
{
    return values.empty() ? unknown
                          : std::accumulate(values.begin(), values.end(), 0.0) /
                                static_cast<double>(values.size());
}

// Predictions, as they come in.
class Predicting
{
  public:
    Predicting() { score_.withheld.resize(VDNA_TRUST_REASON_NO_DISTANCE + 1); }

    void add(const TrustCase &c, const Forecast &forecast)
    {
        score_.maps++;
        skill_.add(c.query, c.trial.fit.skill);
        for (size_t b = 0; b < c.columns.size(); b++) {
            const vdna_trust_prediction &p = forecast.predictions[b];
            if (p.reason == VDNA_TRUST_REASON_NONE)
                add(c, b, p, recall_percent(forecast.angle[b]));
            else
                score_.withheld.at(p.reason)++;
        }
    }

    PredictionScore score()
    {
        score_.error = error_.mean();
        score_.error_constant = constant_.mean();
        score_.error_nearest = nearest_.mean();
        score_.error_transfer = transfer_.mean();
        score_.coverage = covered_.mean();
        score_.width = width_.mean();
        score_.skill = skill_.mean();
        for (size_t i = 0; i < score_.reliability.size(); i++)
            score_.reliability[i] = {static_cast<uint32_t>(predicted_[i].size()),
                                     mean_of(predicted_[i]), achieved_[i].mean()};
        return std::move(score_);
    }

  private:
    void add(const TrustCase &c, size_t b, const vdna_trust_prediction &p, double by_nearest)
    {
        const double achieved = c.achieved[b], predicted = 100 * p.recall;
        const auto error = [&](double percent) { return std::abs(percent - achieved); };
        score_.predictions++;
        error_.add(c.query, error(predicted));
        constant_.add(c.query, error(100 * c.trial.constant[b]));
        nearest_.add(c.query, error(by_nearest));
        transfer_.add(c.query, error(100 * p.transfer));
        covered_.add(c.query, achieved >= 100 * p.low && achieved <= 100 * p.high ? 100 : 0);
        width_.add(c.query, 100 * (p.high - p.low));
        const size_t bin = std::min(static_cast<size_t>(10 * p.recall), predicted_.size() - 1);
        predicted_[bin].push_back(predicted);
        achieved_[bin].add(c.query, achieved);
    }

    PredictionScore score_{};
    QueryMeans error_, constant_, nearest_, transfer_, covered_, width_, skill_;
    std::array<std::vector<double>, 10> predicted_;
    std::array<QueryMeans, 10> achieved_;
};

// Index of the lowest, of equals the first.
size_t first_choice(const std::vector<double> &distance)
{
    return static_cast<size_t>(std::min_element(distance.begin(), distance.end()) -
                               distance.begin());
}

UnlikeScore score_of_kind(const std::vector<UnlikeCase> &cases, const std::string &live,
                          uint32_t references)
{
    uint32_t maps = 0;
    QueryMeans unlike, best_where_unlike, best_where_like;
    for (const UnlikeCase &c : cases) {
        if (c.live != live || c.references != references)
            continue;
        maps++;
        unlike.add(c.query, c.unlike ? 100 : 0);
        (c.unlike ? best_where_unlike : best_where_like).add(c.query, c.best);
    }
    return {
        live, references, maps, unlike.mean(), best_where_unlike.mean(), best_where_like.mean()};
}

} // namespace

double recall_percent(double angle)
{
    const double sine = std::sin(std::clamp(angle, 0.0, std::acos(0.0)));
    return 100 * sine * sine;
}

void QueryMeans::add(size_t query, double value)
{
    if (std::isnan(value))
        return;
    if (query >= sum_.size()) {
        sum_.resize(query + 1);
        count_.resize(query + 1);
    }
    sum_[query] += value;
    count_[query]++;
}

Mean QueryMeans::mean() const
{
    std::vector<double> means;
    for (size_t q = 0; q < sum_.size(); q++)
        if (count_[q] > 0)
            means.push_back(sum_[q] / count_[q]);
    return mean_with_interval(means);
}

PredictionScore score_predictions(const std::vector<TrustCase> &cases, bool early)
{
    Predicting predicting;
    for (const TrustCase &c : cases)
        if (!early || c.trial.early)
            predicting.add(c, early ? *c.trial.early : c.trial.full);
    PredictionScore score = predicting.score();
    score.references = cases.empty() ? 0 : cases.front().references;
    score.frames = early ? VDNA_TRUST_SETTLED_FRAMES : 0;
    return score;
}

SettledScore score_settled(const std::vector<TrustCase> &cases)
{
    SettledScore score{};
    QueryMeans settled, same, frames, loss;
    for (const TrustCase &c : cases) {
        const Trial &trial = c.trial;
        const uint32_t full = trial.full.answer.frames;
        const uint32_t used = trial.settled_frames > 0 ? trial.settled_frames : full;
        const double lost = c.achieved[trial.full.answer.choice] - c.achieved[trial.settled_choice];
        settled.add(c.query, used < full ? 100 : 0);
        same.add(c.query, trial.settled_choice == trial.full.answer.choice ? 100 : 0);
        frames.add(c.query, 100.0 * used / full);
        loss.add(c.query, lost);
        score.worst_loss = std::max(score.worst_loss, lost);
        score.references = c.references;
        score.maps++;
    }
    score.settled = settled.mean();
    score.same = same.mean();
    score.frames = frames.mean();
    score.loss = loss.mean();
    return score;
}

std::vector<UnlikeScore> score_unlike(const std::vector<UnlikeCase> &cases)
{
    std::vector<std::pair<std::string, uint32_t>> kinds;
    for (const UnlikeCase &c : cases) {
        const auto same = std::find(kinds.begin(), kinds.end(), std::pair(c.live, c.references));
        const auto last = std::find_if(kinds.rbegin(), kinds.rend(),
                                       [&](const auto &kind) { return kind.first == c.live; });
        if (same == kinds.end()) // beside those of the same live runs
            kinds.insert(last == kinds.rend() ? kinds.end() : last.base(), {c.live, c.references});
    }
    std::vector<UnlikeScore> scores;
    for (const auto &[live, references] : kinds)
        scores.push_back(score_of_kind(cases, live, references));
    return scores;
}

TrustRanking score_ranking(const std::vector<RankedCase> &cases)
{
    QueryMeans error, regret, recall;
    for (const RankedCase &c : cases) {
        const vdna_ranking_table table = {c.recall.data(),
                                          c.distance.empty() ? nullptr : c.distance.data(), 1,
                                          static_cast<uint32_t>(c.recall.size())};
        vdna_ranking_metrics metrics;
        require(vdna_judge_ranking(&table, &metrics), "ranking");
        const double chosen =
            c.distance.empty() ? mean_of(c.recall) : c.recall[first_choice(c.distance)];
        error.add(c.query, metrics.ranking_error_swap_once); // NaN if the truth ranks nothing
        regret.add(c.query, *std::max_element(c.recall.begin(), c.recall.end()) - chosen);
        recall.add(c.query, chosen);
    }
    return {"", 0, "", error.mean(), regret.mean(), recall.mean()};
}

} // namespace vdna::eval
