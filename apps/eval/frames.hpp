// The traversals of a data set with the network outputs of their frames.
#pragma once

#include <vector>

#include <vdna/cpp/backbone.hpp>

#include "eval/evaluation.hpp"
#include "eval/frame_cache.hpp"
#include "frames/camera_image.hpp"
#include "frames/dataset.hpp"

namespace vdna::eval
{

struct FramesOptions {
    double rate_hz = 10;   // of pictures whose labels have no time
    bool skip_bad = false; // leave out undecodable pictures
};

class Frames
{
  public:
    // Runs the network on pictures that are not in the cache. Shows progress; results computed
    // before Ctrl-C or an error stay in the cache. backbone, cache: borrowed. Throws Error.
    Frames(const frames::Dataset &dataset, Backbone &backbone, const Cache &cache,
           const FramesOptions &options);

    const std::vector<Traversal> &traversals() const { return traversals_; }
    const vdna_backbone_info &backbone() const { return backbone_.info(); }
    const Cache &cache() const { return cache_; }
    uint64_t cached() const { return cached_; }
    uint64_t computed() const { return computed_; }

    // Drop the labels of other units, so that every pair is judged in this one.
    void keep_labels(record::Unit unit);

    // SHA-256 of the content of each frame of a traversal and of the network.
    const std::vector<std::string> &keys(size_t traversal) const { return keys_[traversal]; }
    // The activations of one frame; borrowed until the next call. Throws Error.
    const std::vector<vdna_activations> &taps(size_t traversal, uint32_t frame);
    // What the network gives for a picture that is no frame, which is not cached; borrowed until
    // the next call. name: for the error. Throws Error.
    vdna_backbone_frame output_of(const vdna_image &image, const std::string &name);

  private:
    void record(const frames::DatasetTraversal &from, Traversal &to, std::vector<std::string> &keys,
                const FramesOptions &options);
    CachedFrame frame_of(const std::vector<uint8_t> &picture, const std::string &key,
                         const std::string &name);
    void compute(const std::vector<uint8_t> &picture, const std::string &key,
                 const std::string &name);

    Backbone &backbone_;
    const Cache &cache_;
    FrameCache frame_cache_;
    picture::FileConverter converter_;
    std::vector<Traversal> traversals_;
    std::vector<std::vector<std::string>> keys_; // [traversals][frames]
    CachedTaps taps_;
    uint64_t cached_ = 0;
    uint64_t computed_ = 0;
};

} // namespace vdna::eval
