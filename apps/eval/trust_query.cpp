#include "eval/trust_query.hpp"

#include <algorithm>
#include <limits>

#include <vdna/cpp/error.hpp>
#include <vdna/emd.h>

#include "frames/source.hpp"
#include "program/interrupt.hpp"

namespace vdna::eval
{

namespace
{

// Distances depend on the query, whose references give the ranges.
double not_yet(size_t, uint32_t, uint32_t, size_t)
{
    return std::numeric_limits<double>::quiet_NaN();
}

// Mean EMD, bins.
double distance(const vdna_hist_view &p, const vdna_hist_view &q)
{
    std::vector<int64_t> scratch(vdna_emd_scratch_size(p.neurons) / sizeof(int64_t) + 1);
    double bins = 0;
    require(vdna_emd_mean(&p, &q, scratch.data(), scratch.size() * sizeof(int64_t), &bins),
            "distance of a window");
    return bins;
}

// As many frames as a verdict needs.
LiveFrames repeated(const LiveFrames &live)
{
    LiveFrames many;
    while (many.frames < VDNA_TRUST_SETTLED_FRAMES) {
        many.frames += live.frames;
        many.nearest.insert(many.nearest.end(), live.nearest.begin(), live.nearest.end());
        many.likeness.insert(many.likeness.end(), live.likeness.begin(), live.likeness.end());
    }
    return many;
}

vdna_image image_of(const cv::Mat &bgr)
{
    return {bgr.data,
            bgr.total() * bgr.elemSize(),
            static_cast<uint32_t>(bgr.cols),
            static_cast<uint32_t>(bgr.rows),
            0,
            VDNA_PIXEL_BGR3};
}

} // namespace

TrustQueries::TrustQueries(Frames &frames, Binning &binning, const Evaluation &evaluation)
    : frames_(frames), binning_(binning), evaluation_(evaluation),
      traversals_(*evaluation.traversals)
{
    for (const Traversal &traversal : traversals_)
        stored_.emplace_back(traversal, evaluation.backbone.identity);
    for (size_t t = 0; t < traversals_.size(); t++)
        groups_[traversals_[t].group].push_back(t);
    for (const auto &[group, members] : groups_) {
        record::Members experiences;
        for (const size_t t : members)
            experiences.push_back(&stored_[t].experience());
        tables_[group] = record::make_trust_tables(experiences, evaluation.tolerance, not_yet);
    }
}

TrustQuery TrustQueries::make(size_t q)
{
    const QueryResult &query = evaluation_.queries[q];
    const std::string &group = traversals_[query.traversal].group;
    const std::vector<size_t> &members = groups_[group];
    TrustQuery ready{q, {}, {}, {}, {}};
    std::vector<uint32_t> rows;
    Runs runs;
    for (const PairResult &pair : query.pairs) {
        const auto row = std::find(members.begin(), members.end(), pair.reference);
        rows.push_back(static_cast<uint32_t>(row - members.begin()));
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

size_t TrustQueries::column_of(size_t reference) const
{
    const std::vector<size_t> &all = evaluation_.references;
    return static_cast<size_t>(std::find(all.begin(), all.end(), reference) - all.begin());
}

void TrustQueries::measure(size_t traversal, uint32_t frame, const Runs &runs,
                           LiveFrames &live) const
{
    const record::Recording &r = traversals_[traversal].recording;
    const size_t dim = r.last_layer.size() / r.frames;
    eval::measure(r.embedding(frame), dim == 0 ? nullptr : &r.last_layer[dim * frame], runs, live);
}

// Of windows of the stored runs, of the warmup, and of its first frames.
void TrustQueries::add_distances(const QueryResult &query, TrustQuery &ready)
{
    const size_t runs = query.pairs.size();
    std::vector<Counts> maps;
    for (const PairResult &pair : query.pairs)
        maps.push_back(binning_.counts_of(pair.reference, query.range, evaluation_.bins));
    for (size_t a = 0; a < runs; a++) {
        uint32_t first[VDNA_TRUST_WINDOWS], frames = 0;
        const uint32_t windows = vdna_trust_windows(ready.tables.frames[a], first, &frames);
        for (uint32_t i = 0; i < windows; i++) {
            const std::vector<double> bins =
                distances(query, maps, query.pairs[a].reference, first[i], frames);
            for (size_t b = 0; b < runs; b++)
                if (b != a)
                    ready.tables.cells[a * runs + b].distance[i] = bins[b];
        }
    }
    const std::vector<double> &by_dna = evaluation_.methods.front().distance;
    for (const size_t column : ready.columns)
        ready.live.bins.push_back(by_dna[ready.query * evaluation_.references.size() + column]);
    ready.live.bins_early = distances(query, maps, query.traversal, query.warmup_begin,
                                      std::min(query.warmup_frames, VDNA_TRUST_SETTLED_FRAMES));
}

// Of some frames to each map.
std::vector<double> TrustQueries::distances(const QueryResult &query,
                                            const std::vector<Counts> &maps, size_t traversal,
                                            uint32_t first, uint32_t frames)
{
    const Counts live = binning_.counts_of(traversal, query.range, evaluation_.bins, first, frames);
    std::vector<double> bins;
    for (const Counts &map : maps)
        bins.push_back(distance(live.view(query.range), map.view(query.range)));
    return bins;
}

LiveFrames TrustQueries::disturbed(const QueryResult &query, const Disturbance &disturbance,
                                   const Runs &runs)
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
        const vdna_backbone_frame seen = frames_.output_of(image_of(picture), file);
        eval::measure(seen.embedding, seen.last_layer, runs, live);
    }
    return repeated(live);
}

} // namespace vdna::eval
