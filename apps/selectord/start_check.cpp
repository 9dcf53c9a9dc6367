#include "selectord/start_check.hpp"

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>

#include "backbone/test_picture.hpp"

namespace vdna::selectord
{

namespace
{

// All numbers of a run, embedding first; none if the picture could not be run.
std::optional<std::vector<float>> run(const Backbone &backbone)
{
    const vdna_image image = backbone::test_picture();
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
