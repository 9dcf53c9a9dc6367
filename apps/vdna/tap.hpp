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
    uint32_t samples; // per neuron and frame
};

// From the list of an identity. Throws Error.
std::vector<Tap> taps_of(const std::string &text, uint32_t neurons);

// The list that an identity has of them.
std::string text_of(const std::vector<Tap> &taps);

// The mean over each tap's neurons.
std::vector<double> tap_means(const std::vector<double> &neurons, const std::vector<Tap> &taps);

} // namespace vdna
