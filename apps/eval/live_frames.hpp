// Frames of live runs measured in the runs of a map, as vdna/trust.h wants them.
#pragma once

#include <vector>

#include "eval/evaluation.hpp"
#include "eval/trust_trial.hpp"

namespace vdna::eval
{

// A traversal as an experience that was not read from a file.
class StoredRun
{
  public:
    // traversal: borrowed. identity: what its frames compare with. Throws Error.
    StoredRun(const Traversal &traversal, const vdna_identity &identity);

    const vdna_experience &experience() const { return experience_; }

  private:
    std::vector<int8_t> codes_;  // [frames][last_layer_dim]
    std::vector<float> scales_;  // [frames]
    vdna_experience experience_; // points into them
};

// Append a live frame. embedding, last_layer: of the network; last_layer NULL = none. Throws Error.
void measure(const float *embedding, const float *last_layer,
             const std::vector<const StoredRun *> &runs, LiveFrames &live);

} // namespace vdna::eval
