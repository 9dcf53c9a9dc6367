// The frames of one source: everything in an experience except the histogram.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "record/pass.hpp"

namespace vdna::record
{

// Per-frame tables, laid out as in an experience file. `place` and `position` stay empty if the
// frames carry no such labels; a frame without the label that others have gets VDNA_PLACE_NONE or
// NaNs.
struct Recording {
    uint32_t frames = 0;
    frames::Account account;       // how they were ordered and timed, and what was left out
    uint32_t without_truth = 0;    // frames without the ground truth that others have
    std::string position_frame;    // of the positions; "" without
    std::vector<uint64_t> index;   // [frames], in the source
    std::vector<int64_t> utime;    // [frames], microseconds
    std::vector<int64_t> place;    // [frames]
    std::vector<double> position;  // [frames][3], metres
    std::vector<float> grey;       // [frames], 0..255
    std::vector<float> embeddings; // [frames][dim]
    std::vector<float> last_layer; // [frames][its own size]; [0] if there is no second embedding
    std::string thumbnails;        // JPEGs, one after the other
    std::vector<uint32_t> thumbnail_end; // [frames], in `thumbnails`; [0] if there are none

    // The embeddings of the last layer: the second ones, or if there are none, the only ones.
    const std::vector<float> &last_layer_or_only() const
    {
        return last_layer.empty() ? embeddings : last_layer;
    }

    const float *embedding(size_t frame) const
    {
        return embeddings.data() + embeddings.size() / frames * frame;
    }

    // Append the current frame of `pass`.
    void add(const Pass &pass);
    // Append the thumbnail of the frame added last; "" = it has none. Nor does one for which an
    // experience has no room.
    void add_thumbnail(const std::string &jpeg);
    // Throw Error if no frame of the source could be used.
    void require_frames(const std::string &source) const;
    // Append a frame and its network output. Throws Error if its position is in another frame.
    void add(const frames::Frame &frame, const vdna_backbone_frame &output);

  private:
    // name: of the frame, for the error.
    void add(const frames::Label &label, const std::string &name);
};

} // namespace vdna::record
