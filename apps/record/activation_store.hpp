// Activations of many frames, kept in memory so that the network need not run again.
#pragma once

#include <cstddef>
#include <vector>

#include <vdna/backbone.h>

namespace vdna::record
{

// Keeps the activations of every frame, or of none once they would exceed the limit.
class ActivationStore
{
  public:
    explicit ActivationStore(size_t limit_bytes) : limit_(limit_bytes) {}

    void add(const vdna_backbone_frame &frame);
    // True as long as no frame is missing.
    bool complete() const { return complete_; }
    // The taps of the i-th frame added; borrowed from this store.
    std::vector<vdna_activations> taps(size_t i) const;

  private:
    struct Tap {
        vdna_activations shape; // its `values` is unused
        std::vector<float> values;
    };
    size_t limit_;
    size_t used_ = 0; // bytes
    bool complete_ = true;
    std::vector<std::vector<Tap>> frames_;
};

} // namespace vdna::record
