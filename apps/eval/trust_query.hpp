// Queries made ready for trials of trust: what a map of their references knows about itself, and
// their warmups, undisturbed and disturbed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "eval/binning.hpp"
#include "eval/disturbance.hpp"
#include "eval/live_frames.hpp"

namespace vdna::eval
{

struct TrustQuery {
    size_t query;                      // index into the evaluation's
    std::vector<size_t> columns;       // of the evaluation's references: the query's
    record::TrustTables tables;        // of these
    LiveFrames live;                   // its warmup
    std::vector<LiveFrames> disturbed; // [disturbances], without distances of Visual DNAs
};

class TrustQueries
{
  public:
    // Plays the traversals against one another. All are borrowed; evaluation: of these frames and
    // in these bins. Throws Error.
    TrustQueries(Frames &frames, Binning &binning, const Evaluation &evaluation);

    // query: index into the evaluation's. Throws Error.
    TrustQuery make(size_t query);

  private:
    using Runs = std::vector<const StoredRun *>;

    size_t column_of(size_t reference) const;
    void measure(size_t traversal, uint32_t frame, const Runs &runs, LiveFrames &live) const;
    void add_distances(const QueryResult &query, TrustQuery &ready);
    std::vector<double> distances(const QueryResult &query, const std::vector<Counts> &maps,
                                  size_t traversal, uint32_t first, uint32_t frames);
    LiveFrames disturbed(const QueryResult &query, const Disturbance &disturbance,
                         const Runs &runs);

    Frames &frames_;
    Binning &binning_;
    const Evaluation &evaluation_;
    const std::vector<Traversal> &traversals_;
    std::vector<StoredRun> stored_;                     // [traversals]
    std::map<std::string, std::vector<size_t>> groups_; // traversals
    std::map<std::string, record::TrustTables> tables_; // of a group
};

} // namespace vdna::eval
