#include "eval/live_frames.hpp"

#include <vdna/cpp/error.hpp>
#include <vdna/int8.h>

#include "eval/reference_maps.hpp"

namespace vdna::eval
{

StoredRun::StoredRun(const Traversal &traversal, const vdna_identity &identity)
    : experience_(map_of(traversal.recording, identity.dim))
{
    const record::Recording &recording = traversal.recording;
    experience_.identity = identity;
    traversal.name.copy(experience_.name, sizeof experience_.name - 1);
    if (recording.last_layer.empty())
        return;
    const size_t dim = recording.last_layer.size() / recording.frames;
    codes_.resize(recording.last_layer.size());
    scales_.resize(recording.frames);
    for (size_t i = 0; i < recording.frames; i++)
        require(
            vdna_int8_encode(&recording.last_layer[dim * i], dim, &codes_[dim * i], &scales_[i]),
            traversal.name);
    experience_.last_layer = codes_.data();
    experience_.last_layer_scale = scales_.data();
    experience_.last_layer_dim = static_cast<uint32_t>(dim);
}

void measure(const float *embedding, const float *last_layer,
             const std::vector<const StoredRun *> &runs, LiveFrames &live)
{
    live.frames++;
    for (const StoredRun *run : runs) {
        const vdna_experience &e = run->experience();
        require(vdna_trust_nearest(embedding, e.embeddings, e.identity.dim, e.frames,
                                   &live.nearest.emplace_back(), nullptr),
                e.name);
        if (!last_layer || !e.last_layer)
            continue;
        std::vector<int8_t> codes(e.last_layer_dim);
        float scale = 0;
        require(vdna_int8_encode(last_layer, codes.size(), codes.data(), &scale), e.name);
        require(vdna_trust_nearest_int8(codes.data(), scale, e.last_layer, e.last_layer_scale,
                                        e.last_layer_dim, e.frames, &live.likeness.emplace_back()),
                e.name);
    }
}

} // namespace vdna::eval
