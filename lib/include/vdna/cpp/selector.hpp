/** @file vdna/cpp/selector.hpp
 *  @brief A selector and its memory.
 */
#ifndef VDNA_CPP_SELECTOR_HPP
#define VDNA_CPP_SELECTOR_HPP

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/select.h>

namespace vdna
{

/** Length of a warmup; one of the first two is 0. */
struct Warmup {
    uint32_t frames;                                      /**< number of frames */
    int64_t us;                                           /**< microseconds of camera time */
    uint32_t frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT; /**< fewest, if by time */
};

/** How the stamps of frames are read. */
struct Stamps {
    int64_t late_us = VDNA_TIME_LATE_US_DEFAULT; /**< frames this much older than the newest are
                                                      late */
    uint32_t unit = VDNA_TIME_UNIT_AUTO;         /**< VDNA_TIME_UNIT_... */
};

/** How frames are localised after the choice. */
struct Localising {
    std::vector<vdna_localise *> by; /**< one for each candidate, borrowed as long as the selector
                                        is in use; empty: by the nearest frame */
    uint32_t top = 1;                /**< first of the ranking to localise in at once */
};

/** What is known about the choice, and what follows from that. */
struct Trusting {
    vdna_trust *trust = nullptr; /**< in these candidates, borrowed as long as the selector is in
                                    use; nullptr: none */
    const vdna_trust_run *runs = nullptr; /**< one for each candidate, borrowed likewise; needed
                                             with trust */
    uint32_t rank = VDNA_SELECT_BY_EMD;   /**< VDNA_SELECT_BY_EMD or _BY_TRANSFER */
    bool stop_early = false;              /**< choose when that has settled */
    bool reselect = false; /**< reconsider while driving; needs trust and localisers */
};

/** Limits of a warmup by time, for those that people ask for. */
constexpr double warmup_seconds_min = 0.001, warmup_seconds_max = 1e6;

/** The word that ranking_t has for what orders a ranking, VDNA_SELECT_BY_... */
inline const char *name_of_order(uint32_t ranked_by)
{
    return ranked_by == VDNA_SELECT_BY_TRANSFER   ? "transfer"
           : ranked_by == VDNA_SELECT_BY_RELATIVE ? "relative"
                                                  : "emd";
}

class Selector
{
  public:
    /** Throws Error.
     *  @param candidates  their pointers are borrowed as long as the selector is in use
     *  @param dim  numbers in an embedding
     *  @param where  names the map in the error
     *  @param stamps  of the frames
     *  @param localising  in the experiences
     *  @param trusting  in the choice among them
     *  @param exact  places of a ranking that have the distance; 0 = all */
    Selector(std::vector<vdna_select_candidate> candidates, uint32_t dim, const Warmup &warmup,
             const std::string &where, const Stamps &stamps = {}, Localising localising = {},
             const Trusting &trusting = {}, uint32_t exact = 0)
        : candidates_(std::move(candidates)), localisers_(std::move(localising.by))
    {
        vdna_select_config config;
        vdna_select_config_init(&config);
        config.candidates = candidates_.data();
        config.candidate_count = static_cast<uint32_t>(candidates_.size());
        config.dim = dim;
        config.warmup_frames = warmup.frames;
        config.warmup_us = warmup.us;
        config.warmup_frames_min = warmup.frames_min;
        config.late_us = stamps.late_us;
        config.time_unit = stamps.unit;
        config.localisers = localisers_.empty() ? nullptr : localisers_.data();
        config.top = localising.top;
        config.trust = trusting.trust;
        config.runs = trusting.runs;
        config.rank = trusting.rank;
        config.stop_early = trusting.stop_early ? 1 : 0;
        config.reselect = trusting.reselect ? 1 : 0;
        config.exact = exact;
        const size_t size = vdna_select_mem_size(&config);
        memory_.resize(size / sizeof(int64_t) + 1);
        const vdna_status status = vdna_select_init(&config, memory_.data(), size, &select_);
        if (status != VDNA_OK)
            throw Error(where + ": cannot select among " + std::to_string(candidates_.size()) +
                        " experiences: " + vdna_status_text(status) +
                        "; rebuild the map with `vdna build`");
    }
    Selector(const Selector &) = delete;
    Selector &operator=(const Selector &) = delete;

    /** The C object, for every call that this class does not wrap. */
    vdna_select *get() { return select_; }
    const vdna_select *get() const { return select_; }
    const std::vector<vdna_select_candidate> &candidates() const { return candidates_; }

    /** Bytes that the selector holds. */
    size_t memory_size() const
    {
        return memory_.size() * sizeof memory_[0] + candidates_.size() * sizeof candidates_[0] +
               localisers_.size() * sizeof(vdna_localise *);
    }

  private:
    std::vector<vdna_select_candidate> candidates_;
    std::vector<vdna_localise *> localisers_;
    std::vector<int64_t> memory_;   // int64_t for its alignment
    vdna_select *select_ = nullptr; // in memory_
};

} // namespace vdna

#endif
