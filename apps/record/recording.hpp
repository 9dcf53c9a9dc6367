// The frames of one source: everything in an experience except the histogram.
#pragma once

#include <cstdint>
#include <vector>

#include "record/pass.hpp"

namespace vdna::record
{

// Per-frame tables, laid out as in an experience file. `place` and `position` stay empty if the
// frames carry no such labels.
struct Recording {
    uint32_t frames = 0;
    frames::Account account;       // how they were ordered and timed, and what was left out
    std::vector<uint64_t> index;   // [frames], in the source
    std::vector<int64_t> utime;    // [frames], microseconds
    std::vector<int64_t> place;    // [frames]
    std::vector<double> position;  // [frames][3], metres
    std::vector<float> grey;       // [frames], 0..255
    std::vector<float> embeddings; // [frames][dim]

    // Append the current frame of `pass`.
    void add(const Pass &pass);
    // Throw Error if no frame of the source could be used.
    void require_frames(const std::string &source) const;
    // Append a frame and its network output.
    void add(const frames::Frame &frame, const vdna_backbone_frame &output);
};

} // namespace vdna::record
