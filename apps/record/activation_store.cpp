#include "record/activation_store.hpp"

namespace vdna::record
{

void ActivationStore::add(const vdna_backbone_frame &frame)
{
    if (!complete_)
        return;
    std::vector<Tap> taps;
    for (size_t i = 0; i < frame.tap_count; i++) {
        const vdna_activations &tap = frame.taps[i];
        const size_t count = size_t{tap.neurons} * tap.samples;
        used_ += count * sizeof(float);
        if (used_ > limit_) {
            complete_ = false;
            frames_ = {};
            return;
        }
        taps.push_back({tap, {tap.values, tap.values + count}});
    }
    frames_.push_back(std::move(taps));
}

std::vector<vdna_activations> ActivationStore::taps(size_t i) const
{
    std::vector<vdna_activations> taps;
    for (const Tap &tap : frames_.at(i)) {
        taps.push_back(tap.shape);
        taps.back().values = tap.values.data();
    }
    return taps;
}

} // namespace vdna::record
