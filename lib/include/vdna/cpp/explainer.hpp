/** @file vdna/cpp/explainer.hpp
 *  @brief Why one experience and not another: vdna/explain.h with its memory, by name of the tap.
 */
#ifndef VDNA_CPP_EXPLAINER_HPP
#define VDNA_CPP_EXPLAINER_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <vdna/cpp/taps.hpp>
#include <vdna/explain.h>
#include <vdna/map.h>

namespace vdna
{

/** The frames of an experience that have most and least of a neuron; -1 = not known. */
struct ExampleFrames {
    int32_t most = -1;
    int32_t least = -1;
};

/** A neuron that tells two experiences apart. */
struct Reason {
    vdna_reason part{};
    size_t tap = 0;     /**< index into Explainer::taps() */
    uint32_t index = 0; /**< of the neuron in its tap */
    /** Mean bins; NaN = not known. */
    double live_bin = std::nan(""), winner_bin = std::nan(""), against_bin = std::nan("");
    ExampleFrames of_winner, of_against;
};

/** Where example frames come from, in a sentence if there are none. */
constexpr const char *no_example_frames =
    "no example frames: the experience files keep the network's last layer of each frame, and the "
    "Visual DNA counts another";

/** Explains, without allocating after its constructor. */
class Explainer
{
  public:
    /** Throws Error.
     *  @param identity      of the experiences
     *  @param reasons_most  at most so many neurons are named, >= 1 */
    Explainer(const vdna_identity &identity, uint32_t reasons_most)
        : taps_(taps_of(identity.taps, identity.neurons)),
          top_(std::min(reasons_most, identity.neurons)), reasons_(top_.size()),
          scratch_(vdna_emd_scratch_size(identity.neurons) / sizeof(int64_t) + 1),
          winner_emd_(identity.neurons), against_emd_(identity.neurons)
    {
    }

    /** Explain why one and not the other.
     *  @param live  needed for this call only, as are both experiences
     *  @return as vdna_emd(); after an error the explanation means nothing */
    vdna_status explain(const vdna_hist_view &live, const vdna_experience &winner,
                        const vdna_experience &against)
    {
        vdna_hist_view winner_view{}, against_view{};
        vdna_experience_view(&winner, &winner_view);
        vdna_experience_view(&against, &against_view);
        vdna_status status = measure(live, winner_view, winner_emd_);
        if (status == VDNA_OK)
            status = measure(live, against_view, against_emd_);
        if (status == VDNA_OK)
            status = rank();
        if (status != VDNA_OK)
            return status;
        for (Reason &reason : reasons_) {
            const uint32_t neuron = reason.part.neuron;
            reason.live_bin = mean_bin(live, neuron);
            reason.winner_bin = mean_bin(winner_view, neuron);
            reason.against_bin = mean_bin(against_view, neuron);
            reason.of_winner = example_frames(winner, neuron);
            reason.of_against = example_frames(against, neuron);
        }
        return VDNA_OK;
    }

    /** The same by distances alone, without mean bins and example frames.
     *  @param winner_emd, against_emd  [neurons]
     *  @return as vdna_explain_top() */
    vdna_status explain(const std::vector<double> &winner_emd,
                        const std::vector<double> &against_emd)
    {
        winner_emd_ = winner_emd;
        against_emd_ = against_emd;
        return rank();
    }

    const std::vector<Tap> &taps() const { return taps_; }
    /** Of the newest explanation: those that add most to the margin first. */
    const std::vector<Reason> &reasons() const { return reasons_; }
    /** Both distances and the margin. */
    vdna_reason whole() const { return sum(0, winner_emd_.size()); }
    vdna_reason of_tap(const Tap &tap) const { return sum(tap.begin, tap.end); }

    /** Bytes that it holds besides itself, names of taps left out. */
    size_t memory_size() const
    {
        return top_.size() * sizeof top_[0] + reasons_.size() * sizeof reasons_[0] +
               scratch_.size() * sizeof scratch_[0] +
               (winner_emd_.size() + against_emd_.size()) * sizeof winner_emd_[0];
    }

  private:
    vdna_status measure(const vdna_hist_view &live, const vdna_hist_view &candidate,
                        std::vector<double> &out_emd)
    {
        return vdna_emd(&live, &candidate, scratch_.data(), scratch_.size() * sizeof(int64_t),
                        out_emd.data());
    }

    vdna_status rank()
    {
        const vdna_status status = vdna_explain_top(
            winner_emd_.data(), against_emd_.data(), static_cast<uint32_t>(winner_emd_.size()),
            static_cast<uint32_t>(top_.size()), top_.data());
        if (status == VDNA_OK)
            std::transform(top_.begin(), top_.end(), reasons_.begin(),
                           [this](const vdna_reason &part) { return placed(part); });
        return status;
    }

    Reason placed(const vdna_reason &part) const
    {
        Reason reason;
        reason.part = part;
        while (part.neuron >= taps_[reason.tap].end)
            reason.tap++;
        reason.index = part.neuron - static_cast<uint32_t>(taps_[reason.tap].begin);
        return reason;
    }

    static double mean_bin(const vdna_hist_view &view, uint32_t neuron)
    {
        double bin = 0;
        vdna_hist_view_mean(&view, neuron, &bin); // cannot fail: it has just been compared
        return bin;
    }

    static ExampleFrames example_frames(const vdna_experience &experience, uint32_t neuron)
    {
        uint32_t most = 0, least = 0;
        if (!vdna_experience_counts_last_layer(&experience) ||
            vdna_explain_frames(experience.last_layer, experience.last_layer_scale,
                                experience.frames, experience.last_layer_dim, neuron, &most,
                                &least) != VDNA_OK)
            return {};
        return {static_cast<int32_t>(most), static_cast<int32_t>(least)};
    }

    vdna_reason sum(size_t begin, size_t end) const
    {
        vdna_reason sum{};
        vdna_explain_sum(winner_emd_.data(), against_emd_.data(),
                         static_cast<uint32_t>(winner_emd_.size()), static_cast<uint32_t>(begin),
                         static_cast<uint32_t>(end - begin), &sum); // cannot fail: it is a tap
        return sum;
    }

    std::vector<Tap> taps_;
    std::vector<vdna_reason> top_;
    std::vector<Reason> reasons_;
    std::vector<int64_t> scratch_;
    std::vector<double> winner_emd_, against_emd_; // [neurons], bins
};

} // namespace vdna

#endif
