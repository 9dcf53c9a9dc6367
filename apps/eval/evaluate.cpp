#include "eval/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include <vdna/cpp/error.hpp>
#include <vdna/emd.h>

#include "eval/localise_query.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"
#include "record/warmup.hpp"

namespace vdna::eval
{

namespace
{

constexpr double no_pair = std::numeric_limits<double>::quiet_NaN();

// Traversals by name in the order of the data set; no name stands for all.
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

uint32_t warmup_frames(const record::Recording &recording, const Warmup &warmup)
{
    if (warmup.frames > 0)
        return std::min(warmup.frames, recording.frames);
    uint32_t frames = 0;
    while (frames < recording.frames && recording.utime[frames] < recording.utime[0] + warmup.us)
        frames++;
    return frames;
}

// One run of evaluate().
class Run
{
  public:
    Run(const Frames &frames, Binning &binning, const EvaluationSettings &settings)
        : frames_(frames), traversals_(frames.traversals()), binning_(binning), settings_(settings),
          unit_(unit_of(traversals_)), references_(named(traversals_, settings.references))
    {
    }

    Evaluation run()
    {
        describe();
        std::vector<QueryResult> queries;
        size_t pairs = 0;
        for (const size_t traversal : named(traversals_, settings_.queries)) {
            queries.push_back(query_of(traversal));
            pairs += references_of(traversal).size();
        }
        program::Progress progress("evaluating", pairs);
        begin_tables(queries.size());
        for (QueryResult &query : queries) {
            localise(query);
            compare(query, progress);
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

    QueryResult query_of(size_t traversal) const
    {
        const Traversal &t = traversals_[traversal];
        QueryResult query{traversal, 0, {}, {}, {}, {}};
        query.warmup_frames = warmup_frames(t.recording, record::warmup_of(settings_.warmup));
        for (uint64_t i = query.warmup_frames; i < t.recording.frames; i += settings_.stride)
            query.live.push_back(static_cast<uint32_t>(i));
        if (query.warmup_frames < 2 || query.live.empty())
            throw Error(t.name + ": of its " + std::to_string(t.recording.frames) + " frames " +
                        std::to_string(query.warmup_frames) + " are the warmup of " +
                        settings_.warmup +
                        ", expected at least 2, and a frame after it; set --warmup");
        if (references_of(traversal).empty())
            throw Error(t.name + ": no other traversal to compare it with; set --references");
        return query;
    }

    // Methods and their tables, without a pair yet.
    void begin_tables(size_t queries)
    {
        const std::vector<double> empty(queries * references_.size(), no_pair);
        result_.recall = empty;
        for (const char *name : {"vdna", "fd", "pixel"})
            result_.methods.push_back({name, empty, {}});
        if (binning_.taps().size() > 1)
            for (const Tap &tap : binning_.taps())
                result_.methods.push_back({"vdna:" + tap.name, empty, {}});
        result_.methods.push_back({"random", {}, {}});
    }

    void localise(QueryResult &query) const
    {
        const QueryTask task{traversals_, query, frames_.backbone().identity.dim,
                             settings_.tolerance, unit_};
        const std::vector<size_t> references = references_of(query.traversal);
        for (const size_t reference : references) {
            program::require_not_interrupted();
            query.pairs.push_back({reference, localise_query(task, {reference}), {}});
        }
        query.all = localise_query(task, references);
    }

    // All distances of the query's warmup to its references.
    void compare(QueryResult &query, program::Progress &progress)
    {
        query.range = binning_.range_of(references_of(query.traversal));
        const Counts live =
            binning_.counts_of(query.traversal, query.warmup_frames, query.range, settings_.bins);
        for (PairResult &pair : query.pairs) {
            program::require_not_interrupted();
            const size_t cell = cell_of(pair.reference);
            result_.recall[cell] = pair.outcome.recall[0];
            compare_vdna(query, live, pair, cell);
            method("fd").distance[cell] = frechet(query, pair.reference);
            method("pixel").distance[cell] = intensity(query, pair.reference);
            progress.advance();
        }
    }

    void compare_vdna(const QueryResult &query, const Counts &live, PairResult &pair, size_t cell)
    {
        const Traversal &reference = traversals_[pair.reference];
        const Counts map = binning_.counts_of(pair.reference, reference.recording.frames,
                                              query.range, settings_.bins);
        const vdna_hist_view p = live.view(query.range), q = map.view(query.range);
        std::vector<int64_t> scratch(vdna_emd_scratch_size(p.neurons) / sizeof(int64_t) + 1);
        const size_t scratch_size = scratch.size() * sizeof(int64_t);
        pair.neuron_emd_bins.resize(p.neurons);
        require(vdna_emd(&p, &q, scratch.data(), scratch_size, pair.neuron_emd_bins.data()),
                reference.name);
        method("vdna").distance[cell] =
            std::accumulate(pair.neuron_emd_bins.begin(), pair.neuron_emd_bins.end(), 0.0) /
            p.neurons;
        const std::vector<double> means = tap_means(pair.neuron_emd_bins, binning_.taps());
        for (size_t i = 0; means.size() > 1 && i < means.size(); i++)
            method("vdna:" + binning_.taps()[i].name).distance[cell] = means[i];
    }

    double frechet(const QueryResult &query, size_t reference) const
    {
        const record::Recording &live = traversals_[query.traversal].recording;
        const record::Recording &map = traversals_[reference].recording;
        double distance = 0;
        require(vdna_frechet(live.embeddings.data(), query.warmup_frames, map.embeddings.data(),
                             map.frames, frames_.backbone().identity.dim, &distance),
                traversals_[reference].name + ": Frechet distance");
        return distance;
    }

    double intensity(const QueryResult &query, size_t reference) const
    {
        const record::Recording &map = traversals_[reference].recording;
        double distance = 0;
        require(vdna_intensity(traversals_[query.traversal].recording.grey.data(),
                               query.warmup_frames, map.grey.data(), map.frames, &distance),
                traversals_[reference].name + ": pixel intensity");
        return distance;
    }

    void judge()
    {
        for (MethodResult &judged : result_.methods) {
            const vdna_ranking_table table = {
                result_.recall.data(), judged.distance.empty() ? nullptr : judged.distance.data(),
                static_cast<uint32_t>(result_.queries.size()),
                static_cast<uint32_t>(references_.size())};
            require(vdna_judge_ranking(&table, &judged.metrics), "ranking by " + judged.name);
        }
    }

    MethodResult &method(const std::string &name)
    {
        return *std::find_if(result_.methods.begin(), result_.methods.end(),
                             [&](const MethodResult &m) { return m.name == name; });
    }

    // Of the query that is being compared, in the tables.
    size_t cell_of(size_t reference) const
    {
        const auto column = std::find(references_.begin(), references_.end(), reference);
        return result_.queries.size() * references_.size() +
               static_cast<size_t>(column - references_.begin());
    }

    const Frames &frames_;
    const std::vector<Traversal> &traversals_;
    Binning &binning_;
    const EvaluationSettings &settings_;
    record::Unit unit_;
    std::vector<size_t> references_;
    Evaluation result_;
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

Evaluation evaluate(const Frames &frames, Binning &binning, const EvaluationSettings &settings)
{
    return Run(frames, binning, settings).run();
}

std::vector<float> difference_matrix(const Evaluation &evaluation, const QueryResult &query,
                                     size_t reference)
{
    const size_t dim = evaluation.backbone.identity.dim;
    const float *live = (*evaluation.traversals)[query.traversal].recording.embeddings.data();
    const float *map = (*evaluation.traversals)[reference].recording.embeddings.data();
    return matrix(evaluation, query, reference, [&](uint32_t i, uint32_t j) {
        return record::embedding_distance(live + dim * i, map + dim * j, dim);
    });
}

std::vector<float> ground_truth_matrix(const Evaluation &evaluation, const QueryResult &query,
                                       size_t reference)
{
    const record::Recording &live = (*evaluation.traversals)[query.traversal].recording;
    const vdna_experience map =
        map_of((*evaluation.traversals)[reference].recording, evaluation.backbone.identity.dim);
    return matrix(evaluation, query, reference, [&](uint32_t i, uint32_t j) {
        return record::frames_apart(evaluation.unit, live, i, map, j);
    });
}

} // namespace vdna::eval
