#include "eval/binning.hpp"

#include <algorithm>
#include <numeric>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/histogram.hpp>

#include "eval/packing.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"

namespace vdna::eval
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
            throw program::UsageError("--taps: backbone " + std::string(backbone) +
                                      " has no tap '" + name + "', expected some of:" + list);
}

} // namespace

Binning::Binning(Frames &frames, const std::vector<std::string> &taps, uint32_t range_rule)
    : frames_(frames), range_rule_(range_rule), observed_(frames.traversals().size())
{
    const vdna_identity &identity = frames.backbone().identity;
    const std::vector<Tap> all = taps_of(identity.taps, identity.neurons);
    require_known(taps, all, identity.backbone);
    for (size_t i = 0; i < all.size(); i++) {
        if (!taps.empty() && std::find(taps.begin(), taps.end(), all[i].name) == taps.end())
            continue;
        const uint32_t size = static_cast<uint32_t>(all[i].end - all[i].begin);
        indices_.push_back(i);
        taps_.push_back({all[i].name, neurons_, neurons_ + size, all[i].samples});
        neurons_ += size;
    }
}

std::string Binning::taps_text() const
{
    return text_of(taps_);
}

const std::vector<vdna_activations> &Binning::activations_of(size_t traversal, uint32_t frame)
{
    const std::vector<vdna_activations> &all = frames_.taps(traversal, frame);
    picked_.clear();
    for (const size_t i : indices_)
        picked_.push_back(all.at(i));
    return picked_;
}

std::string Binning::key_of(const std::string &how, size_t traversal, uint32_t frames) const
{
    std::string text = how + "\n" + taps_text() + "\n";
    for (uint32_t i = 0; i < frames; i++)
        text += frames_.keys(traversal)[i];
    return sha256_of(text.data(), text.size());
}

const std::vector<float> &Binning::observed(size_t traversal)
{
    std::vector<float> &range = observed_[traversal];
    if (!range.empty())
        return range;
    const uint32_t frames = frames_.traversals()[traversal].recording.frames;
    const std::string key = key_of("observed 1", traversal, frames) + ".observed";
    const std::optional<std::string> bytes = frames_.cache().find(key);
    if (bytes && bytes->size() == size_t{2} * neurons_ * sizeof(float) &&
        Unpacker(*bytes).take(range, size_t{2} * neurons_))
        return range;
    range = observe(traversal);
    std::string packed;
    pack(packed, range.data(), range.size());
    frames_.cache().store(key, packed);
    return range;
}

std::vector<float> Binning::observe(size_t traversal)
{
    const Traversal &t = frames_.traversals()[traversal];
    std::vector<float> range(size_t{2} * neurons_);
    require(vdna_range_clear(range.data(), neurons_), t.name);
    for (uint32_t i = 0; i < t.recording.frames; i++) {
        program::require_not_interrupted();
        const std::vector<vdna_activations> &taps = activations_of(traversal, i);
        require(vdna_range_observe(range.data(), neurons_, taps.data(), taps.size()),
                t.files[i].string());
    }
    return range;
}

std::vector<float> Binning::range_of(const std::vector<size_t> &traversals)
{
    std::vector<float> range(size_t{2} * neurons_);
    require(vdna_range_clear(range.data(), neurons_), "ranges");
    for (const size_t traversal : traversals) {
        // Observe the extremes of each traversal, as two samples per neuron.
        const vdna_activations extremes = {observed(traversal).data(), neurons_, 2,
                                           VDNA_LAYOUT_NEURONS_SAMPLES};
        require(vdna_range_observe(range.data(), neurons_, &extremes, 1), "ranges");
    }
    require(vdna_range_expand(range.data(), neurons_, VDNA_RANGE_FACTOR, range_rule_), "ranges");
    return range;
}

Counts Binning::counts_of(size_t traversal, const std::vector<float> &range, uint32_t bins)
{
    const std::string how = "counts 1 " + std::to_string(bins) + " " +
                            sha256_of(range.data(), range.size() * sizeof(float));
    const uint32_t frames = frames_.traversals()[traversal].recording.frames;
    const std::string key = key_of(how, traversal, frames) + ".counts";
    if (std::optional<Counts> found = find_counts(key, bins))
        return std::move(*found);
    Counts counted = counts_of(traversal, range, bins, 0, frames);
    if (counted.is_worth_keeping()) {
        std::string bytes;
        pack_counts(bytes, counted);
        frames_.cache().store(key, bytes);
    }
    return counted;
}

std::optional<Counts> Binning::find_counts(const std::string &key, uint32_t bins) const
{
    const std::optional<std::string> bytes = frames_.cache().find(key);
    if (!bytes)
        return {};
    Unpacker unpacker(*bytes);
    Counts found;
    if (!unpacker.take_counts(found, neurons_, bins) || !unpacker.at_end())
        return {};
    return found;
}

Counts Binning::counts_of(size_t traversal, const std::vector<float> &range, uint32_t bins,
                          uint32_t first, uint32_t frames)
{
    const Traversal &t = frames_.traversals()[traversal];
    Histogram histogram(range, bins);
    for (uint32_t i = first; i < first + frames; i++) {
        program::require_not_interrupted();
        const std::vector<vdna_activations> &taps = activations_of(traversal, i);
        histogram.add(taps.data(), taps.size(), t.name);
    }
    return eval::counts_of(histogram.view());
}

} // namespace vdna::eval
