// The traversals of a data set with everything the network made of their frames.
#pragma once

#include <vector>

#include "activation_store.hpp"
#include "dataset.hpp"
#include "evaluation.hpp"
#include "frame_cache.hpp"
#include "pairing/pairing.hpp"

namespace vdna
{

struct FramesOptions {
    double rate_hz = 10;   // of pictures whose labels carry no time
    bool skip_bad = false; // leave out pictures that cannot be decoded
};

class Frames
{
  public:
    // Sends the pictures that the cache does not hold through the network. Shows progress; what was
    // computed before Ctrl-C or an error stays in the cache. Throws Error.
    Frames(const Dataset &dataset, Backbone &backbone, const FrameCache &cache,
           const FramesOptions &options);

    const std::vector<Traversal> &traversals() const { return traversals_; }
    const vdna_backbone_info &backbone() const { return backbone_; }
    uint64_t cached() const { return cached_; }
    uint64_t computed() const { return computed_; }

    // The activations of one frame; borrowed until the next call.
    const std::vector<vdna_activations> &taps(size_t traversal, uint32_t frame);

  private:
    void record(const DatasetTraversal &from, Traversal &to, Backbone &backbone,
                const FramesOptions &options);
    CachedFrame run(const std::vector<uint8_t> &picture, const std::string &key,
                    const std::string &name, Backbone &backbone);

    const FrameCache &cache_;
    vdna_backbone_info backbone_;
    std::vector<Traversal> traversals_;
    std::vector<std::vector<std::string>> keys_; // [traversals][frames]
    std::vector<size_t> first_;                  // [traversals], index of its first frame in store_
    ActivationStore store_;
    CachedFrame from_disk_; // where the activations are too many to keep in memory
    std::vector<vdna_activations> taps_;
    uint64_t cached_ = 0;
    uint64_t computed_ = 0;
};

} // namespace vdna
