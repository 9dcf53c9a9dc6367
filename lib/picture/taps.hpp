// The source pixels of each output pixel along one axis, and their weights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdna::picture
{

template <class Weight>
struct Taps {
    struct Span {
        uint32_t first, count; // source pixels
        size_t weights_at;     // of the first one, in `weights`
    };
    std::vector<Span> spans; // [output pixels]
    std::vector<Weight> weights;

    // Allocate for `output_pixels` spans with `weight_count` weights in all.
    void reserve(size_t output_pixels, size_t weight_count)
    {
        spans.reserve(output_pixels);
        weights.reserve(weight_count);
    }
    void clear()
    {
        spans.clear();
        weights.clear();
    }
};

} // namespace vdna::picture
