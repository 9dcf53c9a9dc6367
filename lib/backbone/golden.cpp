#include "golden.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <vector>

#include "failure.hpp"

namespace vdna::backbone
{

namespace
{

// Enough that a fault in a part of an output shows, few enough to be read.
constexpr size_t usual_parts = 8;

// Processors differ by less than 1e-5, half a percent off in mean or std is more than this.
constexpr const char *usual_tolerance = "0.001";

struct Numbers {
    const float *values;
    size_t size;
};

Numbers numbers_of(const vdna_activations &tap)
{
    return {tap.values, size_t{tap.neurons} * tap.samples};
}

// The means of `parts` equal parts, 1..size of them, in the order of memory.
std::vector<double> part_means(const Numbers &numbers, size_t parts)
{
    std::vector<double> means;
    for (size_t p = 0; p < parts; p++) {
        const size_t begin = p * numbers.size / parts, end = (p + 1) * numbers.size / parts;
        means.push_back(std::accumulate(numbers.values + begin, numbers.values + end, 0.0) /
                        static_cast<double>(end - begin));
    }
    return means;
}

// Six digits, whatever the locale.
std::string shown(double number)
{
    char text[32];
    return std::string(
        text, std::to_chars(text, text + sizeof text, number, std::chars_format::general, 6).ptr);
}

std::string list_of(const Numbers &numbers)
{
    std::string list;
    for (const double mean : part_means(numbers, std::min(usual_parts, numbers.size)))
        list += (list.empty() ? "" : ", ") + shown(mean);
    return "[" + list + "]";
}

[[noreturn]] void refuse(const Manifest &manifest, const std::string &found,
                         const std::string &expected)
{
    throw fail::Failure(VDNA_ERR_MISMATCH,
                        manifest.file.string() + ": for the test picture " + found +
                            ", [golden] expects " + expected +
                            "; correct [input] or the model, or, if the change is meant, replace "
                            "[golden] by what `vdna model golden` prints without it");
}

void require_numbers(const Manifest &manifest, const std::string &what, const Numbers &numbers,
                     const std::vector<double> &expected)
{
    if (expected.size() > numbers.size)
        refuse(manifest, what + " has " + std::to_string(numbers.size) + " numbers",
               std::to_string(expected.size()) + " parts of them");
    const auto less = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const double greatest = std::abs(*std::max_element(expected.begin(), expected.end(), less));
    const double allowed = manifest.golden->tolerance * greatest;
    const std::vector<double> found = part_means(numbers, expected.size());
    for (size_t p = 0; p < expected.size(); p++)
        // A NaN is refused, too.
        if (!(std::abs(found[p] - expected[p]) <= allowed))
            refuse(manifest,
                   what + " gives " + shown(found[p]) + " as number " + std::to_string(p + 1) +
                       " of " + std::to_string(expected.size()),
                   shown(expected[p]) + " within " + shown(allowed));
}

} // namespace

std::string golden_text(const vdna_backbone_frame &frame)
{
    std::string taps;
    for (size_t t = 0; t < frame.tap_count; t++)
        taps += (t == 0 ? "" : ", ") + list_of(numbers_of(frame.taps[t]));
    std::string text =
        "[golden] # for the built-in test picture, by `vdna model golden`\ntolerance = " +
        std::string(usual_tolerance) + "\ntaps = [" + taps +
        "]\nembedding = " + list_of({frame.embedding, frame.dim}) + "\n";
    if (frame.last_layer)
        text += "last_layer = " + list_of({frame.last_layer, frame.last_layer_dim}) + "\n";
    return text;
}

void require_golden(const Manifest &manifest, const vdna_backbone_frame &frame)
{
    if (!manifest.golden)
        return;
    const Golden &golden = *manifest.golden;
    for (size_t t = 0; t < golden.taps.size(); t++)
        require_numbers(manifest, "tap '" + manifest.taps[t].output + "'",
                        numbers_of(frame.taps[t]), golden.taps[t]);
    if (!golden.embedding.empty())
        require_numbers(manifest, "the embedding", {frame.embedding, frame.dim}, golden.embedding);
    if (!golden.last_layer.empty())
        require_numbers(manifest, "the last layer", {frame.last_layer, frame.last_layer_dim},
                        golden.last_layer);
}

} // namespace vdna::backbone
