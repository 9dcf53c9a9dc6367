#include "selectord/start_check.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>

namespace vdna::selectord
{

namespace
{

// Small enough for any limit of pixels that is of use.
constexpr uint32_t side = 16;
using Pixels = std::array<uint8_t, size_t{side} * side>;

// A dark slope with a step: what frames look like to a network, but no picture of its own.
Pixels picture()
{
    Pixels pixels{};
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++)
            pixels[y * side + x] = static_cast<uint8_t>(4 * x + y + (x > y ? 20 : 0));
    return pixels;
}

// All numbers of a run, embedding first; none if the picture could not be run.
std::optional<std::vector<float>> run(const Backbone &backbone)
{
    const auto pixels = picture();
    const vdna_image image{pixels.data(), pixels.size(), side, side, 0, VDNA_PIXEL_GREY};
    vdna_backbone_frame frame;
    vdna_error error{};
    const vdna_status status = vdna_backbone_run(backbone.get(), &image, &error, &frame);
    if (status == VDNA_ERR_NONFINITE)
        throw Error(std::string("the network gives no finite numbers for a test picture: ") +
                    error.text + "; take another network, or rebuild this one");
    if (status != VDNA_OK)
        return {};
    std::vector<float> numbers(frame.embedding, frame.embedding + frame.dim);
    for (size_t i = 0; i < frame.tap_count; i++) {
        const vdna_activations &tap = frame.taps[i];
        numbers.insert(numbers.end(), tap.values, tap.values + size_t{tap.neurons} * tap.samples);
    }
    return numbers;
}

} // namespace

void require_repeatable(const Backbone &backbone)
{
    const auto first = run(backbone), second = run(backbone);
    if (!first || !second)
        return;
    if (first->size() != second->size() ||
        std::memcmp(first->data(), second->data(), first->size() * sizeof(float)) != 0)
        throw Error(std::string("the network ") + backbone.info().identity.backbone +
                    " gives other numbers for the same picture the second time; expected the same "
                    "bits: see to the machine's memory, or take another network");
}

} // namespace vdna::selectord
