// Which neurons belong to which activation tap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vdna
{

// One tap's place in the order of the neurons.
struct Tap {
    std::string name;
    size_t begin;     // first neuron
    size_t end;       // past the last one
    std::string text; // "NAME:NEURONS:SAMPLES"
};

// From "NAME:NEURONS:SAMPLES[,...]", as the backbone writes it. Throws Error.
std::vector<Tap> taps_of(const std::string &text, uint32_t neurons);

// The mean over each tap's neurons.
std::vector<double> tap_means(const std::vector<double> &neurons, const std::vector<Tap> &taps);

} // namespace vdna
