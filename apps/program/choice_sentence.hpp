// How sure the choice of an experience is, and what would help: one sentence for people.
#pragma once

#include <array>

namespace vdna::program
{

// What is known about a choice. Borrows its texts.
struct Choice {
    const char *experience; // the chosen one
    const char *previous;   // the one that it replaces while driving; "" = none
    int count;              // experiences
    int frames;             // of the warmup, until the choice
    int warmup_frames;      // that it may take; 0 = not known
    const char *verdict;    // as in ranking_t: "", "unlike" or "poor"
    double unlike;          // as in ranking_t; NaN = not known
    // Of the chosen one, as in ranking_t; NaN = not predicted.
    double predicted_recall, predicted_low, predicted_high;
    const char *no_prediction; // why not; "" if it is
    double skill;              // as in ranking_t; NaN = not known
};

// Ends with a NUL; cut if longer.
using Sentence = std::array<char, 1024>;

// Without a full stop. Allocates nothing.
Sentence sentence_of(const Choice &choice);

} // namespace vdna::program
