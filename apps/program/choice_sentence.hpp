// How sure the choice of an experience is, what would help, and why it is this one: sentences for
// people.
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
    const char *verdict;    // as in ranking_t: "", "unlike", "poor" or "blank"
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

// What the neurons that weigh most make of the margin between two experiences.
struct MarginShare {
    const char *winner, *against; // names; borrowed
    double margin_bins;           // by which the winner is nearer
    double named_bins;            // of that, of these neurons
    int named, neurons;           // these, of so many
};

// "winter is 1.83 bins nearer than night: 10 of 1280 neurons make 31 % of it", likewise.
Sentence sentence_of(const MarginShare &share);

} // namespace vdna::program
