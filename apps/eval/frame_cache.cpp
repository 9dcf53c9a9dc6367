#include "eval/frame_cache.hpp"

#include "eval/packing.hpp"

namespace vdna::eval
{

namespace
{

constexpr char frame_kind[] = ".frame", taps_kind[] = ".taps";

std::string packed_frame(const vdna_backbone_frame &frame)
{
    std::string bytes;
    pack(bytes, &frame.grey, 1);
    pack(bytes, &frame.dim, 1);
    pack(bytes, frame.embedding, frame.dim);
    pack(bytes, &frame.last_layer_dim, 1);
    pack(bytes, frame.last_layer, frame.last_layer_dim);
    return bytes;
}

std::string packed_taps(const vdna_backbone_frame &frame)
{
    std::string bytes;
    const auto count = static_cast<uint32_t>(frame.tap_count);
    pack(bytes, &count, 1);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t shape[] = {frame.taps[i].neurons, frame.taps[i].samples,
                                  frame.taps[i].layout};
        pack(bytes, shape, 3);
    }
    for (uint32_t i = 0; i < count; i++)
        pack(bytes, frame.taps[i].values, size_t{frame.taps[i].neurons} * frame.taps[i].samples);
    return bytes;
}

} // namespace

vdna_backbone_frame CachedFrame::view() const
{
    vdna_backbone_frame frame{};
    frame.embedding = embedding.data();
    frame.dim = static_cast<uint32_t>(embedding.size());
    frame.last_layer = last_layer.empty() ? nullptr : last_layer.data();
    frame.last_layer_dim = static_cast<uint32_t>(last_layer.size());
    frame.grey = grey;
    return frame;
}

FrameCache::FrameCache(const Cache &cache, const vdna_backbone_info &backbone)
    : cache_(cache), network_(std::string("frame 4\n") + backbone.identity.model_sha256 + "\n" +
                              backbone.identity.preprocessing + "\n" + backbone.identity.taps +
                              "\n" + backbone.identity.embedding + "\n" + backbone.runtime + "\n")
{
}

std::string FrameCache::key_of(const std::vector<uint8_t> &picture) const
{
    const std::string text = network_ + sha256_of(picture.data(), picture.size());
    return sha256_of(text.data(), text.size());
}

std::optional<CachedFrame> FrameCache::find(const std::string &key) const
{
    const std::optional<std::string> bytes = cache_.find(key + frame_kind);
    if (!bytes)
        return {};
    Unpacker unpacker(*bytes);
    CachedFrame frame;
    uint32_t dim = 0, last_layer_dim = 0;
    if (!unpacker.take(&frame.grey, 1) || !unpacker.take(&dim, 1) ||
        !unpacker.take(frame.embedding, dim) || !unpacker.take(&last_layer_dim, 1) ||
        !unpacker.take(frame.last_layer, last_layer_dim) || !unpacker.at_end())
        return {};
    return frame;
}

std::optional<CachedTaps> FrameCache::find_taps(const std::string &key) const
{
    const std::optional<std::string> bytes = cache_.find(key + taps_kind);
    if (!bytes)
        return {};
    Unpacker unpacker(*bytes);
    CachedTaps found;
    uint32_t count = 0, shape[3];
    if (!unpacker.take(&count, 1))
        return {};
    for (uint32_t i = 0; i < count; i++) {
        if (!unpacker.take(shape, 3))
            return {};
        found.taps.push_back({nullptr, shape[0], shape[1], shape[2]});
    }
    uint64_t values = 0;
    for (const vdna_activations &tap : found.taps)
        values += uint64_t{tap.neurons} * tap.samples;
    if (!unpacker.take(found.values, values) || !unpacker.at_end())
        return {};
    const float *next = found.values.data();
    for (vdna_activations &tap : found.taps) {
        tap.values = next;
        next += size_t{tap.neurons} * tap.samples;
    }
    return found;
}

void FrameCache::store(const std::string &key, const vdna_backbone_frame &frame) const
{
    cache_.store(key + taps_kind, packed_taps(frame));
    cache_.store(key + frame_kind,
                 packed_frame(frame)); // last, so that every frame found has its taps
}

} // namespace vdna::eval
