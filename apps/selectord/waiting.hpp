// Why no answers come, or why those that come deserve a doubt: the judgement and its sentence. The
// transport and the selector give the facts; the clock is an argument.
#pragma once

#include <array>
#include <cstdint>

#include <vdna/transport.h>

#include "selectord/config.hpp"

namespace vdna::selectord
{

// The state of the daemon at one moment; counters are since its start.
struct Facts {
    int64_t now_us = 0; // monotonic
    vdna_transport_counters camera{};
    const vdna_transport_overheard *overheard = nullptr; // [overheard_count], other channels
    uint32_t overheard_count = 0;
    bool selected = false;
    double progress = 0;             // of the warmup, 0..1
    uint64_t accepted = 0;           // frames used
    uint64_t parked = 0;             // of these, frames that showed nothing new
    uint64_t refused = 0;            // frames that could not be used, late ones left out
    uint64_t late = 0;               // frames left out because newer ones had come before them
    uint64_t still = 0;              // the newest used frames that did not move camera time
    uint64_t restarts = 0;           // warmups begun anew
    const char *refusal = "";        // why the newest refused frame was refused
    const char *restart_reason = ""; // "because ...": the newest of these warmups
};

enum class Cause {
    none,
    silence,
    other_type,
    corrupted,
    unprotected,
    repeated,
    oversized,
    refused,
    restarts,
    parked,
    still,
    late
};

// What is wrong, if anything is.
struct Verdict {
    Cause cause = Cause::none;
    uint64_t detail = 0;  // differs where the same cause wants another remedy
    bool is_news = false; // to be printed: another cause or detail, or one that has come back
    std::array<char, 480> text{}; // a sentence; "" for none
};

// Judges the daemon once a second. Allocates nothing.
class Waiting
{
  public:
    // `replay`: the frames come from a log, as fast as they are taken. Borrows from `config`.
    Waiting(const Config &config, bool replay);

    // Nothing is wrong before three seconds without progress: of the warmup or, after it, of
    // answers.
    Verdict judge(const Facts &now);

    // Whether it helps to know which other channels carry messages.
    bool wants_to_overhear() const;

    // Why a log that has ended left the warmup incomplete.
    Verdict judge_end(const Facts &end) const;

  private:
    const Facts &last() const { return recent_[(judged_ - 1) % recent_.size()]; }
    void note_progress(const Facts &now);
    Cause find_cause(const Facts &now) const;
    Verdict describe(Cause cause, const Facts &now) const;
    bool is_news(const Verdict &verdict, int64_t now_us);

    const Config &config_;
    const bool replay_;
    uint64_t judged_ = 0;           // times
    std::array<Facts, 4> recent_{}; // of the last judgements, in turn
    Facts progress_;                // when there was progress last
    int64_t message_us_ = 0;        // when the camera channel last had a message ...
    int64_t picture_us_ = 0;        // ... and one of its type
    Verdict printed_;               // the newest that was news
    int64_t printed_us_ = 0;
    bool was_well_ = true; // at the last judgement
};

} // namespace vdna::selectord
