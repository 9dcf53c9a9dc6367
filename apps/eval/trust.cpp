#include "eval/trust.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/trust.hpp>

#include "eval/compare_localisers.hpp"
#include "eval/conditions.hpp"
#include "eval/subsets.hpp"
#include "eval/trust_methods.hpp"
#include "eval/trust_query.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"

namespace vdna::eval
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

using Chosen = std::vector<uint32_t>; // some of a query's references

class Run
{
  public:
    Run(Frames &frames, Binning &binning, const Evaluation &evaluation)
        : evaluation_(evaluation), queries_(frames, binning, evaluation),
          localiser_(vdna_identity_is_centred(&evaluation.backbone.identity) != 0
                         ? VDNA_TRUST_CENTRED
                         : VDNA_TRUST_EUCLIDEAN)
    {
    }

    TrustEvaluation run()
    {
        result_.truth = localiser_ == VDNA_TRUST_CENTRED ? "centred" : "nn";
        localised_ = compare_localisers(
            evaluation_, {result_.truth, "filter", "fused_filter", "filter_all", "bayesian"});
        for (const Traversal &traversal : *evaluation_.traversals)
            names_.push_back(traversal.name);
        condition_ = conditions_of(names_);
        program::Progress progress("trying trust", evaluation_.queries.size());
        for (size_t q = 0; q < evaluation_.queries.size(); q++, progress.advance())
            try_query(queries_.make(q));
        for (const uint32_t references : sizes())
            score(references);
        result_.unlike = score_unlike(unlike_);
        return std::move(result_);
    }

  private:
    const LocaliserResult &localised(const std::string &key) const
    {
        return *std::find_if(localised_.begin(), localised_.end(),
                             [&](const LocaliserResult &l) { return l.name == key; });
    }

    double recall(const std::string &truth, size_t query, size_t column) const
    {
        return localised(truth).recall[query * evaluation_.references.size() + column];
    }

    // 0 = all, last.
    std::vector<uint32_t> sizes() const
    {
        std::vector<uint32_t> sizes(std::begin(trust_references), std::end(trust_references));
        sizes.push_back(0);
        return sizes;
    }

    void try_query(const TrustQuery &ready)
    {
        const auto count = static_cast<uint32_t>(ready.columns.size());
        std::mt19937 random(1);
        Chosen all(count);
        std::iota(all.begin(), all.end(), 0);
        for (const uint32_t size : sizes()) {
            if (size >= count)
                continue;
            const std::vector<Chosen> maps = size == 0
                                                 ? std::vector<Chosen>{all}
                                                 : subsets_of(count, size, trust_maps_most, random);
            for (const Chosen &map : maps)
                try_map(ready, size, map);
        }
        try_without_condition(ready, all);
    }

    void try_map(const TrustQuery &ready, uint32_t size, const Chosen &map)
    {
        program::require_not_interrupted();
        const record::TrustTables tables = tables_of(ready.tables, map);
        const LiveFrames live = frames_in(ready.live, ready.columns.size(), map);
        TrustCase c = case_of(ready, size, map);
        c.trial = try_trust(tables, localiser_, live);
        add_unlike("as recorded", c);
        if (repeats_conditions())
            add_unlike(has_condition_of(c) ? "its condition is in the map"
                                           : "its condition is not in the map",
                       c);
        for (size_t d = 0; d < disturbances.size(); d++) {
            const Trial trial = try_trust(tables, localiser_,
                                          frames_in(ready.disturbed[d], ready.columns.size(), map));
            unlike_.push_back({disturbances[d].key, size, c.query,
                               looks_like_none(trial.full.answer.verdict), unknown});
        }
        rank(c, tables, live.bins);
        cases_[size].push_back(std::move(c));
    }

    TrustCase case_of(const TrustQuery &ready, uint32_t size, const Chosen &map) const
    {
        TrustCase c{ready.query, size, {}, {}, {}};
        for (const uint32_t run : map) {
            c.columns.push_back(ready.columns[run]);
            c.achieved.push_back(recall(result_.truth, ready.query, ready.columns[run]));
        }
        return c;
    }

    void add_unlike(const std::string &live, const TrustCase &c)
    {
        unlike_.push_back({live, c.references, c.query,
                           looks_like_none(c.trial.full.answer.verdict),
                           *std::max_element(c.achieved.begin(), c.achieved.end())});
    }

    const std::string &condition_of_query(size_t query) const
    {
        return condition_[evaluation_.queries[query].traversal];
    }

    const std::string &condition_of_column(size_t column) const
    {
        return condition_[evaluation_.references[column]];
    }

    bool has_condition_of(const TrustCase &c) const
    {
        return std::any_of(c.columns.begin(), c.columns.end(), [&](size_t column) {
            return condition_of_column(column) == condition_of_query(c.query);
        });
    }

    bool repeats_conditions() const { return condition_ != names_; }

    // In a map of all references but those of the query's condition.
    void try_without_condition(const TrustQuery &ready, const Chosen &all)
    {
        Chosen map;
        std::copy_if(all.begin(), all.end(), std::back_inserter(map), [&](uint32_t run) {
            return condition_of_column(ready.columns[run]) != condition_of_query(ready.query);
        });
        if (map.empty())
            return;
        TrustCase c = case_of(ready, 0, map);
        c.trial = try_trust(tables_of(ready.tables, map), localiser_,
                            frames_in(ready.live, ready.columns.size(), map));
        add_unlike("condition left out", c);
        add_unlike("condition left out: " + condition_of_query(c.query), c);
    }

    // By each method.
    void rank(const TrustCase &c, const record::TrustTables &tables,
              const std::vector<double> &bins)
    {
        for (const MethodResult &method : evaluation_.methods) {
            std::vector<double> distance;
            for (size_t b = 0; !method.distance.empty() && b < c.columns.size(); b++)
                distance.push_back(
                    method.distance[c.query * evaluation_.references.size() + c.columns[b]]);
            rank_by(method.name, c, distance);
        }
        for (const TrustMethod &method : trust_methods)
            rank_by(method.key, c, method.distance(c, tables.own_scale, bins));
    }

    void rank_by(const std::string &method, const TrustCase &c, const std::vector<double> &distance)
    {
        for (const std::string &truth : {result_.truth, std::string("filter")}) {
            RankedCase ranked{c.query, {}, distance};
            for (const size_t column : c.columns)
                ranked.recall.push_back(recall(truth, c.query, column));
            ranked_[{c.references, truth, method}].push_back(ranked);
        }
    }

    std::vector<std::string> methods() const
    {
        std::vector<std::string> keys;
        for (const MethodResult &method : evaluation_.methods)
            keys.push_back(method.name);
        for (const TrustMethod &method : trust_methods)
            keys.emplace_back(method.key);
        return keys;
    }

    void score(uint32_t references)
    {
        const std::vector<TrustCase> &cases = cases_[references];
        if (cases.empty())
            return;
        result_.predictions.push_back(score_predictions(cases, false));
        result_.predictions.push_back(score_predictions(cases, true));
        result_.settled.push_back(score_settled(cases));
        for (const std::string &truth : {result_.truth, std::string("filter")}) {
            for (const std::string &method : methods()) {
                TrustRanking ranking = score_ranking(ranked_[{references, truth, method}]);
                ranking.method = method;
                ranking.references = references;
                ranking.truth = truth;
                result_.rankings.push_back(ranking);
            }
        }
        if (references == 0) {
            add_fused();
            for (const TrustCase &c : cases)
                add_pairs(c);
        }
    }

    // What a user might pick instead of a choice: all references at once.
    void add_fused()
    {
        for (const char *key : {"fused_filter", "filter_all", "bayesian"}) {
            QueryMeans regret;
            for (const TrustCase &c : cases_[0]) {
                double best = 0;
                for (const size_t column : c.columns)
                    best = std::max(best, recall("filter", c.query, column));
                regret.add(c.query, best - localised(key).recall[c.query]);
            }
            result_.rankings.push_back({key,
                                        0,
                                        "filter",
                                        {unknown, unknown, unknown},
                                        regret.mean(),
                                        localised(key).mean.recall});
        }
    }

    void add_pairs(const TrustCase &c)
    {
        for (size_t b = 0; b < c.columns.size(); b++) {
            const vdna_trust_prediction &p = c.trial.full.predictions[b];
            result_.pairs.push_back(
                {c.query, evaluation_.references[c.columns[b]], c.achieved[b], 100 * p.recall,
                 100 * p.low, 100 * p.high, 100 * c.trial.constant[b],
                 recall_percent(c.trial.full.angle[b]), 100 * p.transfer, p.reason});
        }
    }

    const Evaluation &evaluation_;
    TrustQueries queries_;
    uint32_t localiser_;
    TrustEvaluation result_;
    std::vector<LocaliserResult> localised_;
    std::vector<std::string> names_, condition_;       // [traversals]
    std::map<uint32_t, std::vector<TrustCase>> cases_; // by number of references
    std::map<std::tuple<uint32_t, std::string, std::string>, std::vector<RankedCase>>
        ranked_; // by number of references, truth and method
    std::vector<UnlikeCase> unlike_;
};

} // namespace

TrustEvaluation evaluate_trust(Frames &frames, Binning &binning, const Evaluation &evaluation)
{
    return Run(frames, binning, evaluation).run();
}

} // namespace vdna::eval
