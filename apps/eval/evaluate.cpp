#include "eval/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include <vdna/cpp/error.hpp>
#include <vdna/emd.h>

#include "eval/live_run.hpp"
#include "eval/localise_query.hpp"
#include "eval/methods.hpp"
#include "eval/reference_maps.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"

namespace vdna::eval
{

namespace
{

constexpr double no_pair = std::numeric_limits<double>::quiet_NaN();

// Traversals by name, in the order of the data set; no names = all.
std::vector<size_t> named(const std::vector<Traversal> &traversals,
                          const std::vector<std::string> &names)
{
    std::vector<size_t> picked;
    for (size_t i = 0; i < traversals.size(); i++)
        if (names.empty() ||
            std::find(names.begin(), names.end(), traversals[i].name) != names.end())
            picked.push_back(i);
    return picked;
}

double mean_of(const std::vector<double> &values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// One run of evaluate().
class Run
{
  public:
    Run(Frames &frames, Binning &binning, const EvaluationSettings &settings)
        : frames_(frames), traversals_(frames.traversals()), binning_(binning), settings_(settings),
          unit_(unit_of(traversals_)), references_(named(traversals_, settings.references))
    {
        frames.keep_labels(unit_);
    }

    Evaluation run()
    {
        describe();
        const std::vector<size_t> queries = named(traversals_, settings_.queries);
        size_t pairs = 0;
        for (const size_t query : queries)
            pairs += require_references(query);
        program::Progress progress("evaluating", pairs);
        begin_tables(queries.size());
        for (const size_t traversal : queries) {
            QueryResult query{traversal, 0, 0, {}, {}, {}, {}};
            query.range = binning_.range_of(references_of(traversal));
            query.projection = projection_of(traversal);
            const std::vector<Counts> maps = maps_of(query);
            const LiveRun live = run(query, maps);
            localise(query);
            compare(query, live, maps, progress);
            result_.queries.push_back(std::move(query));
        }
        judge();
        return std::move(result_);
    }

  private:
    void describe()
    {
        result_.backbone = frames_.backbone();
        result_.backbone.identity.neurons = binning_.neurons();
        std::snprintf(result_.backbone.identity.taps, sizeof result_.backbone.identity.taps, "%s",
                      binning_.taps_text().c_str());
        result_.bins = settings_.bins;
        result_.warmup = settings_.warmup;
        result_.tolerance = settings_.tolerance;
        result_.unit = unit_;
        result_.with_altitude = settings_.with_altitude;
        result_.stride = settings_.stride;
        result_.cached = frames_.cached();
        result_.computed = frames_.computed();
        result_.traversals = &traversals_;
        result_.references = references_;
    }

    // The references that a query is compared with: of its group, and not itself.
    std::vector<size_t> references_of(size_t query) const
    {
        std::vector<size_t> picked;
        for (const size_t reference : references_)
            if (reference != query && traversals_[reference].group == traversals_[query].group)
                picked.push_back(reference);
        return picked;
    }

    size_t require_references(size_t query) const
    {
        const size_t count = references_of(query).size();
        if (count == 0)
            throw Error(traversals_[query].name +
                        ": no other traversal to compare it with; set --references");
        return count;
    }

    // What a map of the query's references keeps of embeddings.
    record::Projection projection_of(size_t query) const
    {
        const vdna_backbone_info &network = frames_.backbone();
        if (network.embedding_dims == 0)
            return {};
        std::vector<const record::Recording *> parts;
        for (const size_t reference : references_of(query))
            parts.push_back(&traversals_[reference].recording);
        return record::principal_directions(parts, network.identity.dim, network.embedding_dims,
                                            traversals_[query].name);
    }

    // The Visual DNA of each of the query's references.
    std::vector<Counts> maps_of(const QueryResult &query)
    {
        std::vector<Counts> maps;
        for (const size_t reference : references_of(query.traversal))
            maps.push_back(binning_.counts_of(reference, query.range, settings_.bins));
        return maps;
    }

    // Run a selector on the query, and find its warmup frames and the frames to localise.
    LiveRun run(QueryResult &query, const std::vector<Counts> &maps)
    {
        const Traversal &t = traversals_[query.traversal];
        const std::vector<size_t> references = references_of(query.traversal);
        LiveTask task{query.traversal, settings_.warmup, settings_.warmup_frames_min,
                      query.range,     settings_.bins,   {}};
        for (size_t i = 0; i < references.size(); i++) {
            const record::Recording &map = traversals_[references[i]].recording;
            task.candidates.push_back(
                {maps[i].view(query.range), map.embeddings.data(), map.frames, 0});
        }
        LiveRun live = run_live(frames_, binning_, task);
        query.warmup_begin = live.begin;
        query.warmup_frames = live.frames;
        for (uint64_t i = live.next; i < t.recording.frames; i += settings_.stride)
            query.live.push_back(static_cast<uint32_t>(i));
        if (query.warmup_frames < 2 || query.live.empty())
            throw Error(t.name + ": of its " + std::to_string(t.recording.frames) + " frames " +
                        std::to_string(query.warmup_frames) + " are the warmup of " +
                        settings_.warmup +
                        ", expected at least 2, and a frame after it; set --warmup");
        return live;
    }

    // Methods with empty tables.
    void begin_tables(size_t queries)
    {
        const std::vector<double> empty(queries * references_.size(), no_pair);
        result_.recall = empty;
        for (const Method &method : methods)
            result_.methods.push_back(
                {method.key, method.distance ? empty : std::vector<double>{}, {}});
        if (binning_.taps().size() > 1)
            for (const Tap &tap : binning_.taps())
                result_.methods.insert(result_.methods.end() - 1,
                                       MethodResult{key_of_tap(tap.name), empty, {}});
    }

    void localise(QueryResult &query) const
    {
        const QueryTask task{traversals_, query, frames_.backbone().identity.dim,
                             settings_.tolerance, settings_.with_altitude};
        const std::vector<size_t> references = references_of(query.traversal);
        for (const size_t reference : references) {
            program::require_not_interrupted();
            query.pairs.push_back({reference, localise_query(task, {reference}), {}});
        }
        query.all = localise_query(task, references);
        if (query.all.judged == 0)
            throw Error(traversals_[query.traversal].name + ": none of the " +
                        std::to_string(query.live.size()) +
                        " frames to localise has ground truth; label some, or leave the traversal "
                        "out of --queries");
    }

    // All distances of the query's warmup to its references.
    void compare(QueryResult &query, const LiveRun &live, const std::vector<Counts> &maps,
                 program::Progress &progress)
    {
        for (size_t i = 0; i < query.pairs.size(); i++) {
            program::require_not_interrupted();
            PairResult &pair = query.pairs[i];
            const size_t cell = cell_of(pair.reference);
            result_.recall[cell] = pair.outcome.recall[0];
            compare_neurons(query, live.dna, maps[i], pair);
            const Comparison comparison = {traversals_[query.traversal].recording, live.begin,
                                           live.frames, traversals_[pair.reference].recording,
                                           mean_of(pair.neuron_emd_bins)};
            for (const Method &of : methods)
                if (of.distance)
                    method(of.key).distance[cell] = of.distance(comparison);
            const std::vector<double> means = tap_means(pair.neuron_emd_bins, binning_.taps());
            for (size_t tap = 0; means.size() > 1 && tap < means.size(); tap++)
                method(key_of_tap(binning_.taps()[tap].name)).distance[cell] = means[tap];
            progress.advance();
        }
    }

    void compare_neurons(const QueryResult &query, const Counts &live, const Counts &map,
                         PairResult &pair) const
    {
        const vdna_hist_view p = live.view(query.range), q = map.view(query.range);
        std::vector<int64_t> scratch(vdna_emd_scratch_size(p.neurons) / sizeof(int64_t) + 1);
        pair.neuron_emd_bins.resize(p.neurons);
        require(vdna_emd(&p, &q, scratch.data(), scratch.size() * sizeof(int64_t),
                         pair.neuron_emd_bins.data()),
                traversals_[pair.reference].name);
    }

    void judge()
    {
        for (MethodResult &method : result_.methods) {
            const vdna_ranking_table table = {
                result_.recall.data(), method.distance.empty() ? nullptr : method.distance.data(),
                static_cast<uint32_t>(result_.queries.size()),
                static_cast<uint32_t>(references_.size())};
            method.judged = judge_ranking(table, "ranking by " + method.name);
        }
    }

    MethodResult &method(const std::string &name)
    {
        return *std::find_if(result_.methods.begin(), result_.methods.end(),
                             [&](const MethodResult &m) { return m.name == name; });
    }

    // Index into the tables for the query being compared.
    size_t cell_of(size_t reference) const
    {
        const auto column = std::find(references_.begin(), references_.end(), reference);
        return result_.queries.size() * references_.size() +
               static_cast<size_t>(column - references_.begin());
    }

    Frames &frames_;
    const std::vector<Traversal> &traversals_;
    Binning &binning_;
    const EvaluationSettings &settings_;
    record::Unit unit_;
    std::vector<size_t> references_;
    Evaluation result_{};
};

// A number for each pair of a live frame and a map frame.
template <typename Number>
std::vector<float> matrix(const Evaluation &evaluation, const QueryResult &query, size_t reference,
                          Number number)
{
    const uint32_t frames = (*evaluation.traversals)[reference].recording.frames;
    std::vector<float> values;
    values.reserve(query.live.size() * frames);
    for (const uint32_t i : query.live) {
        program::require_not_interrupted();
        for (uint32_t j = 0; j < frames; j++)
            values.push_back(static_cast<float>(number(i, j)));
    }
    return values;
}

} // namespace

Evaluation evaluate(Frames &frames, Binning &binning, const EvaluationSettings &settings)
{
    return Run(frames, binning, settings).run();
}

std::vector<float> difference_matrix(const Evaluation &evaluation, const QueryResult &query,
                                     size_t reference)
{
    const auto kept = [&](size_t traversal) {
        return record::projected((*evaluation.traversals)[traversal].recording, query.projection);
    };
    const record::Recording live = kept(query.traversal), map = kept(reference);
    const size_t dim = live.embeddings.size() / live.frames;
    return matrix(evaluation, query, reference, [&](uint32_t i, uint32_t j) {
        return record::embedding_distance(&live.embeddings[dim * i], &map.embeddings[dim * j], dim);
    });
}

std::vector<float> ground_truth_matrix(const Evaluation &evaluation, const QueryResult &query,
                                       size_t reference)
{
    const record::Recording &live = (*evaluation.traversals)[query.traversal].recording;
    const vdna_experience map =
        map_of((*evaluation.traversals)[reference].recording, evaluation.backbone.identity.dim);
    const record::Truth truth(live, map, evaluation.with_altitude);
    return matrix(evaluation, query, reference,
                  [&](uint32_t i, uint32_t j) { return truth.apart(i, j); });
}

} // namespace vdna::eval
