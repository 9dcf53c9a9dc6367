#include "binning.hpp"

#include <algorithm>

#include "check.hpp"

namespace vdna
{

namespace
{

void require_known(const std::vector<std::string> &names, const std::vector<Tap> &known,
                   const char *backbone)
{
    std::string list;
    for (const Tap &tap : known)
        list += " " + tap.name;
    for (const std::string &name : names)
        if (std::none_of(known.begin(), known.end(), [&](const Tap &t) { return t.name == name; }))
            throw Error("--taps: backbone " + std::string(backbone) + " has no tap '" + name +
                            "', expected some of:" + list,
                        exit_usage);
}

} // namespace

Binning::Binning(Frames &frames, const std::vector<std::string> &taps, uint32_t range_rule)
    : frames_(frames), range_rule_(range_rule), observed_(frames.traversals().size())
{
    const vdna_backbone_info &backbone = frames.backbone();
    const std::vector<Tap> all = taps_of(backbone.taps, backbone.neurons);
    require_known(taps, all, backbone.name);
    for (size_t i = 0; i < all.size(); i++) {
        if (!taps.empty() && std::find(taps.begin(), taps.end(), all[i].name) == taps.end())
            continue;
        const uint32_t size = static_cast<uint32_t>(all[i].end - all[i].begin);
        indices_.push_back(i);
        taps_.push_back({all[i].name, neurons_, neurons_ + size, all[i].text});
        neurons_ += size;
    }
}

std::string Binning::taps_text() const
{
    std::string text;
    for (const Tap &tap : taps_)
        text += (text.empty() ? "" : ",") + tap.text;
    return text;
}

const std::vector<vdna_activations> &Binning::picked(size_t traversal, uint32_t frame)
{
    const std::vector<vdna_activations> &all = frames_.taps(traversal, frame);
    picked_.clear();
    for (const size_t i : indices_)
        picked_.push_back(all.at(i));
    return picked_;
}

const std::vector<float> &Binning::observed(size_t traversal)
{
    std::vector<float> &range = observed_[traversal];
    if (!range.empty())
        return range;
    const Traversal &t = frames_.traversals()[traversal];
    range.resize(size_t{2} * neurons_);
    require_ok(vdna_range_clear(range.data(), neurons_), t.name);
    for (uint32_t i = 0; i < t.recording.frames; i++) {
        const std::vector<vdna_activations> &taps = picked(traversal, i);
        require_ok(vdna_range_observe(range.data(), neurons_, taps.data(), taps.size()),
                   t.files[i].string());
    }
    return range;
}

std::vector<float> Binning::range_of(const std::vector<size_t> &traversals)
{
    std::vector<float> range(size_t{2} * neurons_);
    require_ok(vdna_range_clear(range.data(), neurons_), "ranges");
    for (const size_t traversal : traversals) {
        // What was observed of a traversal is observed again, as two samples per neuron.
        const vdna_activations extremes = {observed(traversal).data(), neurons_, 2,
                                           VDNA_LAYOUT_NEURONS_SAMPLES};
        require_ok(vdna_range_observe(range.data(), neurons_, &extremes, 1), "ranges");
    }
    require_ok(vdna_range_expand(range.data(), neurons_, VDNA_RANGE_FACTOR, range_rule_), "ranges");
    return range;
}

Histogram Binning::histogram_of(size_t traversal, uint32_t frames, const std::vector<float> &range,
                                uint32_t bins)
{
    Histogram histogram(range, bins);
    for (uint32_t i = 0; i < frames; i++) {
        const std::vector<vdna_activations> &taps = picked(traversal, i);
        histogram.add(taps.data(), taps.size(), frames_.traversals()[traversal].name);
    }
    return histogram;
}

} // namespace vdna
