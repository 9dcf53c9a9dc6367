// The result of an evaluation, from which tables, files and reports are made.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/baseline.h>

#include "eval/bootstrap.hpp"
#include "eval/confidence.hpp"
#include "eval/ranking_metrics.hpp"
#include "eval/trust_evaluation.hpp"
#include "record/localisation.hpp"
#include "record/projection.hpp"
#include "record/recording.hpp"

namespace vdna::eval
{

// One traversal of a data set, with the network outputs of its frames.
struct Traversal {
    std::string name;  // "winter", or "test:2/winter" of a partitioned data set
    std::string group; // traversals are compared only within their group: "test:2", or ""
    record::Recording recording;
    std::vector<std::filesystem::path> files; // [recording.frames], the pictures
};

// Recall@N is computed for these N.
constexpr std::array<uint32_t, 3> recall_depths = {1, 5, 10};

// The nearest map frame of one live frame.
struct FrameMatch {
    uint32_t live;    // frame of the query's traversal
    size_t traversal; // of the map frame
    uint32_t frame;   // of that traversal
    double distance;  // of the embeddings, Euclidean
    bool good;        // taken within tolerance of the live frame
    bool reachable;   // some map frame was taken within tolerance of the live frame
    bool judged;      // the live frame has ground truth; otherwise neither says anything
};

// The live frames of a query, localised in one map.
struct Outcome {
    std::array<double, recall_depths.size()> recall; // percent, Recall@N for recall_depths
    uint32_t judged = 0;                             // live frames with ground truth
    uint32_t good = 0;                               // nearest frames that are good
    uint32_t unreachable = 0; // judged frames without a map frame within tolerance: failures
    std::vector<FrameMatch> matches;
};

// A query against one reference.
struct PairResult {
    size_t reference; // traversal
    Outcome outcome;
    std::vector<double> neuron_emd_bins; // [neurons]; their mean is the distance of method "vdna"
};

// One traversal in the role of the live one.
struct QueryResult {
    size_t traversal;
    uint32_t warmup_begin;      // first frame of the warmup: 0 unless the warmup began anew
    uint32_t warmup_frames;     // frames in the live Visual DNA
    std::vector<uint32_t> live; // frames to localise
    std::vector<float> range;   // [neurons][2], from the references only
    std::vector<PairResult> pairs;
    Outcome all;                     // in all references at once: the composite map
    record::Projection projection{}; // that a map of the references learned; none if the network's
                                     // manifest has no dims
};

// One way to predict which reference is best.
struct MethodResult {
    std::string name;             // key of a method of eval/methods.hpp
    std::vector<double> distance; // [queries][references], NaN without a pair; empty for
                                  // chance, which is judged by exact expectations
    JudgedRanking judged{};       // percentages as percentages
};

// How well frames were localised.
struct LocaliserScore {
    Mean recall{};                               // over queries, percent
    std::optional<ConfidenceMetrics> confidence; // of all answers on the route, if they have one
    std::optional<Mean> off_route; // over queries, percent of the answers off the route that have
                                   // the confidence usual_min_confidence; if there are any
};

// One way to localise, on all queries, in one kind of drive.
struct LocaliserResult {
    std::string name;           // key of a localiser of eval/localisers.hpp
    std::string drive;          // key of a kind of drive of eval/drives.hpp
    bool in_each = true;        // in one reference at a time; otherwise in several at once
    std::vector<double> recall; // percent: [queries][references], NaN without a pair, if in_each,
                                // otherwise [queries]
    LocaliserScore mean;        // over references
    LocaliserScore chosen;      // in the reference that Visual DNA chooses; `mean` if not in_each
};

// A drive through several traversals in turn, localised by place filters in the references that
// are not among them. Percentages are Recall@1 of the frames after the warmup.
struct ReselectionResult {
    std::string drive;             // "summer+dusk+night"
    std::vector<size_t> choices;   // traversals: that of the warmup, then one for each switch
    std::vector<uint32_t> since;   // frames after the warmup: where each choice begins
    std::vector<uint32_t> changes; // likewise, of each traversal, and the end of the drive
    std::vector<uint32_t> delays;  // frames, of switches after a change of traversals: since then
    double again;                  // in the choice, which is reconsidered on every frame
    double never;                  // in the choice of the warmup all the way
    double best;                   // in whatever is best in hindsight between two changes
};

struct Reselection {
    std::vector<ReselectionResult> drives;
    Mean again, never, best, gain; // over the drives; gain: again - never
};

struct Evaluation {
    std::string dataset;         // its path
    vdna_backbone_info backbone; // with the selected taps and their neurons
    uint32_t bins = 0;
    std::string warmup; // "100" frames or "45s"
    double tolerance = 0;
    record::Unit unit = record::Unit::none; // of the tolerance
    bool with_altitude = false;             // distances are not horizontal
    uint32_t stride = 1;                    // every stride-th frame after the warmup is localised
    uint64_t cached = 0;                    // frames with activations from the cache
    uint64_t computed = 0;                  // frames that went through the network

    const std::vector<Traversal> *traversals = nullptr; // borrowed
    std::vector<QueryResult> queries;
    std::vector<size_t> references;          // traversals: the columns of the tables below
    std::vector<double> recall;              // [queries][references], percent; NaN without a pair
    std::vector<MethodResult> methods;       // ours first, chance last
    std::vector<LocaliserResult> localisers; // in the drives as recorded
    std::vector<LocaliserResult> drives;     // in the drives asked for, drive by drive
    std::optional<Reselection> reselection;  // if asked for
    std::optional<TrustEvaluation> trust;    // if asked for
};

// Distances of the embeddings, [live frames][map frames]: the difference matrix.
std::vector<float> difference_matrix(const Evaluation &evaluation, const QueryResult &query,
                                     size_t reference);

// Distances between the places of the frames, in the unit of the tolerance, in the same layout; NaN
// where a frame has no ground truth.
std::vector<float> ground_truth_matrix(const Evaluation &evaluation, const QueryResult &query,
                                       size_t reference);

} // namespace vdna::eval
