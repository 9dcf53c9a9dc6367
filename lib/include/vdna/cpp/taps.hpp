/** @file vdna/cpp/taps.hpp
 *  @brief The neurons of each activation tap.
 */
#ifndef VDNA_CPP_TAPS_HPP
#define VDNA_CPP_TAPS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/identity.h>

namespace vdna
{

/** One tap's place in the order of the neurons. */
struct Tap {
    std::string name;
    size_t begin;     /**< first neuron */
    size_t end;       /**< past the last one */
    uint32_t samples; /**< per neuron and frame */
};

/** Read the list of an identity. Throws Error. */
inline std::vector<Tap> taps_of(const std::string &text, uint32_t neurons)
{
    std::vector<Tap> taps;
    size_t begin = 0;
    const char *rest = text.c_str();
    vdna_tap tap{};
    while (vdna_taps_next(&rest, &tap) == VDNA_OK && tap.neurons <= neurons - begin) {
        taps.push_back({{tap.name, tap.name_length}, begin, begin + tap.neurons, tap.samples});
        begin += tap.neurons;
    }
    if (*rest != '\0')
        throw Error("taps '" + text + "' do not say where each tap's neurons are");
    return taps;
}

/** Write them as the list of an identity. Throws Error. */
inline std::string text_of(const std::vector<Tap> &taps)
{
    char text[VDNA_TAPS_SIZE] = "";
    for (const Tap &tap : taps) {
        const vdna_tap entry = {tap.name.data(), tap.name.size(),
                                static_cast<uint32_t>(tap.end - tap.begin), tap.samples};
        require(vdna_taps_append(text, sizeof text, &entry), "tap " + tap.name);
    }
    return text;
}

/** The mean over each tap's neurons. */
inline std::vector<double> tap_means(const std::vector<double> &neurons,
                                     const std::vector<Tap> &taps)
{
    std::vector<double> means;
    for (const Tap &tap : taps) {
        const double sum =
            std::accumulate(&neurons[tap.begin], &neurons[tap.begin] + (tap.end - tap.begin), 0.0);
        means.push_back(sum / static_cast<double>(std::max<size_t>(tap.end - tap.begin, 1)));
    }
    return means;
}

} // namespace vdna

#endif
