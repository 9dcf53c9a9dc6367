// From sources of frames to experiences of one map.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/histogram.hpp>
#include <vdna/map.h>

#include "frames/source.hpp"
#include "record/activation_store.hpp"
#include "record/pass.hpp"
#include "record/ranges.hpp"
#include "record/recording.hpp"

namespace vdna::record
{

// One experience: what it is made from, and, once it is made, all that its file holds.
struct Draft {
    std::string source; // as for frames::Source
    std::string name;   // of the experience, passes vdna_name_check()
    Recording recording;
    std::optional<Histogram> histogram; // once the ranges are known
};

class Maker
{
  public:
    // backbone, options: borrowed.
    Maker(Backbone &backbone, const frames::SourceOptions &options, uint32_t bins);

    // Count in these ranges; without them make() calibrates its own. At most once.
    void use(Ranges ranges) { ranges_ = std::move(ranges); }

    // Make all of them. Calibrating, the activations are kept for the counting if they fit into
    // memory, otherwise the network runs twice. range_rule: VDNA_RANGE_ABOUT_... of a calibration.
    // Throws Error, also for a source without a usable frame.
    void make(std::vector<Draft> &drafts, uint32_t range_rule);

    // All but name and frames; the range is borrowed from this maker and NULL before it is known.
    vdna_experience blank() const;
    // As its file will be; borrowed from this maker and the draft.
    vdna_experience experience_of(const Draft &draft) const;

    uint32_t bins() const { return bins_; }
    // "calibration", or where they came from.
    const std::string &ranges_origin() const { return ranges_.origin; }

  private:
    void record_and_count(Draft &draft);
    void calibrate(std::vector<Draft> &drafts, uint32_t range_rule);
    void count_stored(std::vector<Draft> &drafts) const;
    void count_again(Draft &draft);

    Backbone &backbone_;
    const frames::SourceOptions &options_;
    uint32_t bins_;
    Ranges ranges_; // without values until they are known
    ActivationStore store_;
};

} // namespace vdna::record
