// Makes experiences of one map from sources of frames.
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
#include "record/projection.hpp"
#include "record/ranges.hpp"
#include "record/recording.hpp"
#include "record/thumbnails.hpp"

namespace vdna::record
{

// Rows of numbers as codes of vdna/int8.h.
struct Codes {
    std::vector<int8_t> codes; // [frames][dim]; empty = none
    std::vector<float> scales; // [frames]
};

// One experience: its source, and once it is made, the contents of its file.
struct Draft {
    std::string source; // path, as for frames::Source
    std::string name;   // of the experience, passes vdna_name_check()
    Recording recording;
    std::optional<Histogram> histogram; // once the ranges are known
    Codes embedding;                    // none if the file is to have floats
    Codes last_layer;                   // none if the network gives no second embedding
};

class Maker
{
  public:
    // backbone, options: borrowed.
    Maker(Backbone &backbone, const frames::SourceOptions &options, uint32_t bins);

    // Use these ranges; without them make() calibrates its own. Call at most once.
    void use(Ranges ranges) { ranges_ = std::move(ranges); }

    // Keep of embeddings what this experience keeps; without it make() keeps what the network's
    // manifest asks for. Call at most once. Throws Error if that asks for another number of them.
    void keep_as(const vdna_experience &there);

    // Give the experiences a thumbnail of each frame. Call before make().
    void add_thumbnails() { thumbnails_.emplace(); }

    // Make all drafts. A calibration keeps the activations for counting if they fit into memory;
    // otherwise the network runs twice. range_rule: VDNA_RANGE_ABOUT_... of a calibration. Throws
    // Error, also for a source without a usable frame.
    void make(std::vector<Draft> &drafts, uint32_t range_rule);

    // Everything except name and frames; range and projection are borrowed, and NULL until they are
    // known.
    vdna_experience blank() const;
    // The contents of the file to write; borrowed from this maker and the draft.
    vdna_experience experience_of(const Draft &draft) const;

    uint32_t bins() const { return bins_; }
    // "calibration", or the file of the ranges.
    const std::string &ranges_origin() const { return ranges_.origin; }

  private:
    void record(Draft &draft, const Pass &pass);
    void record_and_count(Draft &draft);
    void calibrate(std::vector<Draft> &drafts, uint32_t range_rule);
    void count_stored(std::vector<Draft> &drafts) const;
    void count_again(Draft &draft);
    void project(std::vector<Draft> &drafts);
    void encode(Draft &draft) const;

    Backbone &backbone_;
    const frames::SourceOptions &options_;
    uint32_t bins_;
    Ranges ranges_;                        // without values until they are known
    std::optional<Projection> projection_; // once it is known
    ActivationStore store_;
    std::optional<Thumbnails> thumbnails_; // if they are wanted
};

} // namespace vdna::record
