/** @file vdna/cpp/taps.hpp
 *  @brief Which neurons belong to which activation tap.
 */
#ifndef VDNA_CPP_TAPS_HPP
#define VDNA_CPP_TAPS_HPP

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>

namespace vdna
{

/** One tap's place in the order of the neurons. */
struct Tap {
    std::string name;
    size_t begin;     /**< first neuron */
    size_t end;       /**< past the last one */
    std::string text; /**< "NAME:NEURONS:SAMPLES" */
};

/** From "NAME:NEURONS:SAMPLES[,...]", as the backbone writes it. Throws Error. */
inline std::vector<Tap> taps_of(const std::string &text, uint32_t neurons)
{
    std::vector<Tap> taps;
    size_t at = 0, begin = 0;
    while (at < text.size()) {
        const size_t next = std::min(text.find(',', at), text.size());
        const std::string entry = text.substr(at, next - at);
        const size_t samples = entry.rfind(':');
        const size_t count = samples == std::string::npos || samples == 0
                                 ? std::string::npos
                                 : entry.rfind(':', samples - 1);
        size_t size = 0;
        if (count == std::string::npos ||
            std::from_chars(&entry[count + 1], &entry[samples], size).ptr != &entry[samples] ||
            size > neurons - begin)
            throw Error("taps '" + text + "' do not say where each tap's neurons are");
        taps.push_back({entry.substr(0, count), begin, begin + size, entry});
        begin += size;
        at = next + 1;
    }
    return taps;
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
