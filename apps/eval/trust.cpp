#include "eval/trust.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include <vdna/cpp/error.hpp>
#include <vdna/emd.h>

#include "eval/compare_localisers.hpp"
#include "eval/conditions.hpp"
#include "eval/disturbance.hpp"
#include "eval/live_frames.hpp"
#include "eval/subsets.hpp"
#include "eval/trust_methods.hpp"
#include "frames/source.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"

namespace vdna::eval
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

using Chosen = std::vector<uint32_t>; // some of a query's references

// A query, ready to be tried in maps of its references.
struct ReadyQuery {
    size_t query;                      // index into the evaluation's
    std::vector<size_t> columns;       // of the evaluation's references: the query's
    record::TrustTables tables;        // of these
    LiveFrames live;                   // its warmup
    std::vector<LiveFrames> disturbed; // [disturbances]
};

class Run
{
  public:
    Run(Frames &frames, Binning &binning, const Evaluation &evaluation)
        : frames_(frames), binning_(binning), evaluation_(evaluation),
          traversals_(*evaluation.traversals),
          localiser_(vdna_identity_is_centred(&evaluation.backbone.identity) != 0
                         ? VDNA_TRUST_CENTRED
                         : VDNA_TRUST_EUCLIDEAN)
    {
    }

    TrustEvaluation run()
    {
        result_.truth = localiser_ == VDNA_TRUST_CENTRED ? "centred" : "nn";
        localised_ = compare_localisers(evaluation_,
                                        {result_.truth, "filter", "fused_filter", "filter_all"});
        for (const Traversal &traversal : traversals_)
            names_.push_back(traversal.name);
        condition_ = conditions_of(names_);
        make_stored_runs();
        program::Progress progress("trying trust", evaluation_.queries.size());
        for (size_t q = 0; q < evaluation_.queries.size(); q++, progress.advance())
            try_query(ready(q));
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

    void make_stored_runs()
    {
        for (const Traversal &traversal : traversals_)
            stored_.emplace_back(traversal, evaluation_.backbone.identity);
        for (size_t t = 0; t < traversals_.size(); t++)
            groups_[traversals_[t].group].push_back(t);
        for (const auto &[group, members] : groups_) {
            record::Members experiences;
            for (const size_t t : members)
                experiences.push_back(&stored_[t].experience());
            tables_[group] = record::make_trust_tables(
                experiences, evaluation_.tolerance,
                [](size_t, uint32_t, uint32_t, size_t) { return unknown; });
        }
    }

    ReadyQuery ready(size_t q)
    {
        const QueryResult &query = evaluation_.queries[q];
        ReadyQuery ready{q, {}, {}, {}, {}};
        const std::string &group = traversals_[query.traversal].group;
        const std::vector<size_t> &members = groups_[group];
        Chosen rows;
        std::vector<const StoredRun *> runs;
        for (const PairResult &pair : query.pairs) {
            rows.push_back(static_cast<uint32_t>(
                std::find(members.begin(), members.end(), pair.reference) - members.begin()));
            ready.columns.push_back(column_of(pair.reference));
            runs.push_back(&stored_[pair.reference]);
        }
        ready.tables = tables_of(tables_[group], rows);
        add_distances(query, ready);
        for (uint32_t i = 0; i < query.warmup_frames; i++)
            measure(query.traversal, query.warmup_begin + i, runs, ready.live);
        for (const Disturbance &disturbance : disturbances)
            ready.disturbed.push_back(disturbed(query, disturbance, runs));
        return ready;
    }

    size_t column_of(size_t reference) const
    {
        const std::vector<size_t> &all = evaluation_.references;
        return static_cast<size_t>(std::find(all.begin(), all.end(), reference) - all.begin());
    }

    void measure(size_t traversal, uint32_t frame, const std::vector<const StoredRun *> &runs,
                 LiveFrames &live) const
    {
        const record::Recording &r = traversals_[traversal].recording;
        const size_t dim = r.last_layer.size() / r.frames;
        eval::measure(r.embedding(frame),
                      r.last_layer.empty() ? nullptr : &r.last_layer[dim * frame], runs, live);
    }

    // Distances of Visual DNAs: of stored windows, and of the first frames of the warmup.
    void add_distances(const QueryResult &query, ReadyQuery &ready)
    {
        const size_t runs = query.pairs.size();
        std::vector<Counts> maps;
        for (const PairResult &pair : query.pairs)
            maps.push_back(binning_.counts_of(pair.reference, query.range, evaluation_.bins));
        const auto distances = [&](size_t traversal, uint32_t first, uint32_t frames) {
            const Counts live =
                binning_.counts_of(traversal, query.range, evaluation_.bins, first, frames);
            std::vector<double> bins;
            for (const Counts &map : maps)
                bins.push_back(distance(live.view(query.range), map.view(query.range)));
            return bins;
        };
        for (size_t a = 0; a < runs; a++) {
            uint32_t first[VDNA_TRUST_WINDOWS], frames = 0;
            const uint32_t windows = vdna_trust_windows(ready.tables.frames[a], first, &frames);
            for (uint32_t i = 0; i < windows; i++) {
                const std::vector<double> bins =
                    distances(query.pairs[a].reference, first[i], frames);
                for (size_t b = 0; b < runs; b++)
                    if (b != a)
                        ready.tables.cells[a * runs + b].distance[i] = bins[b];
            }
        }
        ready.live.bins = of_query(evaluation_.methods.front().distance, ready);
        ready.live.bins_early = distances(query.traversal, query.warmup_begin,
                                          std::min(query.warmup_frames, VDNA_TRUST_SETTLED_FRAMES));
    }

    // Mean EMD, bins.
    static double distance(const vdna_hist_view &p, const vdna_hist_view &q)
    {
        std::vector<int64_t> scratch(vdna_emd_scratch_size(p.neurons) / sizeof(int64_t) + 1);
        double bins = 0;
        require(vdna_emd_mean(&p, &q, scratch.data(), scratch.size() * sizeof(int64_t), &bins),
                "distance of a window");
        return bins;
    }

    // A row of a table [queries][references].
    std::vector<double> of_query(const std::vector<double> &table, const ReadyQuery &ready) const
    {
        std::vector<double> row;
        for (const size_t column : ready.columns)
            row.push_back(table[ready.query * evaluation_.references.size() + column]);
        return row;
    }

    LiveFrames disturbed(const QueryResult &query, const Disturbance &disturbance,
                         const std::vector<const StoredRun *> &runs)
    {
        std::mt19937 random(1);
        const uint32_t count = std::min(disturbance.most, query.warmup_frames);
        LiveFrames live;
        for (uint32_t i = 0; i < count; i++) {
            program::require_not_interrupted();
            const uint32_t frame = query.warmup_begin + i * query.warmup_frames / count;
            const std::string file = traversals_[query.traversal].files[frame].string();
            const cv::Mat picture =
                disturbance.picture(decoded(frames::read_picture(file), file), random);
            const vdna_image image = {picture.data,
                                      picture.total() * picture.elemSize(),
                                      static_cast<uint32_t>(picture.cols),
                                      static_cast<uint32_t>(picture.rows),
                                      0,
                                      VDNA_PIXEL_BGR3};
            const vdna_backbone_frame seen = frames_.output_of(image, file);
            eval::measure(seen.embedding, seen.last_layer, runs, live);
        }
        return repeated(live);
    }

    // As many frames as a verdict needs.
    static LiveFrames repeated(const LiveFrames &live)
    {
        LiveFrames many;
        while (many.frames < VDNA_TRUST_SETTLED_FRAMES) {
            many.frames += live.frames;
            many.nearest.insert(many.nearest.end(), live.nearest.begin(), live.nearest.end());
            many.likeness.insert(many.likeness.end(), live.likeness.begin(), live.likeness.end());
        }
        return many;
    }

    // 0 = all, last.
    std::vector<uint32_t> sizes() const
    {
        std::vector<uint32_t> sizes(std::begin(trust_references), std::end(trust_references));
        sizes.push_back(0);
        return sizes;
    }

    void try_query(const ReadyQuery &ready)
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

    void try_map(const ReadyQuery &ready, uint32_t size, const Chosen &map)
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
                               trial.full.answer.verdict == VDNA_TRUST_UNLIKE, unknown});
        }
        rank(c, tables, live.bins);
        cases_[size].push_back(std::move(c));
    }

    TrustCase case_of(const ReadyQuery &ready, uint32_t size, const Chosen &map) const
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
                           c.trial.full.answer.verdict == VDNA_TRUST_UNLIKE,
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
    void try_without_condition(const ReadyQuery &ready, const Chosen &all)
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
        for (const char *key : {"fused_filter", "filter_all"}) {
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
            const double sine = std::sin(std::clamp(c.trial.full.angle[b], 0.0, std::acos(0.0)));
            result_.pairs.push_back({c.query, evaluation_.references[c.columns[b]], c.achieved[b],
                                     100 * p.recall, 100 * p.low, 100 * p.high,
                                     100 * c.trial.constant[b], 100 * sine * sine, 100 * p.transfer,
                                     p.reason});
        }
    }

    Frames &frames_;
    Binning &binning_;
    const Evaluation &evaluation_;
    const std::vector<Traversal> &traversals_;
    uint32_t localiser_;
    TrustEvaluation result_;
    std::vector<LocaliserResult> localised_;
    std::vector<std::string> names_, condition_; // [traversals]
    std::vector<StoredRun> stored_;              // [traversals]
    std::map<std::string, std::vector<size_t>> groups_;
    std::map<std::string, record::TrustTables> tables_; // of the traversals of a group
    std::map<uint32_t, std::vector<TrustCase>> cases_;  // by number of references
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
