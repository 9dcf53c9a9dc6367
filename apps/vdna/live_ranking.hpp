// Ranking a map by the first frames of a source, as the daemon would.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/cpp/trust.hpp>

#include "record/pass.hpp"
#include "vdna/options.hpp"
#include "vdna/ranking_report.hpp"

namespace vdna::tool
{

// A live run, and the map to choose from.
struct LiveOptions {
    std::string path, map;
    NetworkOptions network;
    frames::SourceOptions source;
    std::string warmup = std::to_string(VDNA_WARMUP_FRAMES_DEFAULT);
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT;
    std::vector<std::string> exclude;
    std::string by = "transfer";
    double min_recall = 0;
};

// --warmup, --warmup-min, --exclude, --rank, --min-recall.
// when: goes before the text of each, for --help
void add_live_options(CLI::App &command, LiveOptions &options, const std::string &when);

class LiveRanking
{
  public:
    // Sees each frame that was fed.
    using Watcher = std::function<void(const record::Pass &)>;

    // Feeds a warmup, and tells on standard error what is to be known about the source. Throws
    // Error, also if the source ends before.
    explicit LiveRanking(const LiveOptions &options, const Watcher &watch = {});

    const Ranking &ranking() const { return ranking_; }
    const vdna_identity &identity() const { return map_.experiences().front().identity; }
    // Of the map, in the order of the ranking's names; borrowed.
    const std::vector<vdna_experience> &candidates() const { return candidates_; }
    const vdna_select &select() const { return *selector_->get(); }
    // The Visual DNA of the warmup; borrowed.
    vdna_hist_view live() const;

  private:
    Map map_;
    std::vector<vdna_experience> candidates_; // borrowed from it
    Trust trust_;
    std::unique_ptr<Selector> selector_;
    Ranking ranking_;
};

} // namespace vdna::tool
