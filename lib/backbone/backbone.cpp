#include <vdna/backbone.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "failure.hpp"
#include "manifest.hpp"
#include "manifest_path.hpp"
#include "model.hpp"
#include "picture/decode.hpp"
#include "picture/mean_grey.hpp"
#include "preprocess.hpp"
#include "processor.hpp"
#include "runtime.hpp"
#include "session.hpp"

using namespace vdna;

struct vdna_backbone {
    vdna_backbone(const Manifest &manifest, const vdna_backbone_config &config);

    Runtime runtime;
    Session session;
    picture::Decoder decoder;
    Preprocessor preprocessor;
    std::vector<vdna_activations> taps;
    uint32_t neurons = 0;
    bool l2_normalise;
    std::vector<float> embedding;
    vdna_backbone_info info{};
    std::atomic<bool> cancelled{false};
};

namespace
{

using Clock = std::chrono::steady_clock;

constexpr uint32_t threads_default = 2;
constexpr uint32_t threads_max = 256;

// The output as activations: one axis is the neurons, all others together are the samples.
vdna_activations as_activations(const Output &output, uint32_t layout)
{
    const int64_t neurons =
        layout == VDNA_LAYOUT_SAMPLES_NEURONS ? output.shape.back() : output.shape.front();
    const auto size = static_cast<int64_t>(output.size);
    return {output.values, static_cast<uint32_t>(neurons), static_cast<uint32_t>(size / neurons),
            layout};
}

std::string taps_text(const Manifest &manifest, const std::vector<vdna_activations> &taps)
{
    std::string text;
    for (size_t t = 0; t < taps.size(); t++)
        text += (text.empty() ? "" : ",") + manifest.taps[t].output + ":" +
                std::to_string(taps[t].neurons) + ":" + std::to_string(taps[t].samples);
    return text;
}

// Copied in full or refused: a text cut short would make different backbones look alike.
template <size_t Room>
void copy_text(char (&out)[Room], const std::string &text, const char *what)
{
    if (text.size() >= Room)
        throw Failure(VDNA_ERR_FORMAT, std::string(what) + " has " + std::to_string(text.size()) +
                                           " characters; at most " + std::to_string(Room - 1) +
                                           " are expected");
    std::memcpy(out, text.c_str(), text.size() + 1);
}

void require_processor(const Manifest &manifest)
{
    const char *const lacks = lacks_for_int8_products();
    if (manifest.precision == "int8" && lacks)
        throw Failure(VDNA_ERR_UNSUPPORTED,
                      "backbone " + manifest.name + ": is int8, and this processor lacks " + lacks +
                          ": it may give other numbers than processors that have it; use the fp32 "
                          "network and a map made with it");
}

void fill_info(vdna_backbone &backbone, const Manifest &manifest, uint32_t max_pixels)
{
    vdna_backbone_info &info = backbone.info;
    copy_text(info.name, manifest.name, "the backbone's name");
    copy_text(info.model_sha256, manifest.sha256, "the SHA-256");
    copy_text(info.preprocessing, preprocessing_text(manifest), "the preprocessing");
    copy_text(info.taps, taps_text(manifest, backbone.taps), "the list of taps");
    copy_text(info.precision, manifest.precision, "the precision");
    copy_text(info.quantised_from, manifest.quantised_from, "the SHA-256 of the original");
    copy_text(info.runtime, "onnxruntime " + backbone.runtime.version(), "the runtime's version");
    info.tap_count = static_cast<uint32_t>(backbone.taps.size());
    info.neurons = backbone.neurons;
    info.dim = static_cast<uint32_t>(backbone.embedding.size());
    info.input_width = manifest.input.width;
    info.input_height = manifest.input.height;
    info.decode_bytes = vdna_decoder_bytes_max(max_pixels);
}

void l2_normalise(std::vector<float> &values)
{
    double square = 0.0;
    for (const float value : values)
        square += static_cast<double>(value) * static_cast<double>(value);
    // Zero over zero is a NaN, which is then refused as one.
    for (float &value : values)
        value = static_cast<float>(static_cast<double>(value) / std::sqrt(square));
}

void require_not_cancelled(const vdna_backbone &backbone)
{
    if (backbone.cancelled)
        throw Failure(VDNA_ERR_RUNTIME, "the backbone was cancelled; open it again");
}

void infer(vdna_backbone &backbone)
{
    try {
        backbone.session.run();
    } catch (const Failure &) {
        require_not_cancelled(backbone);
        throw;
    }
    const Output &output = backbone.session.embedding();
    backbone.embedding.assign(output.values, output.values + output.size);
    if (backbone.l2_normalise)
        l2_normalise(backbone.embedding);
}

void require_finite(const vdna_backbone &backbone)
{
    const vdna_activations embedding = {backbone.embedding.data(), backbone.info.dim, 1,
                                        VDNA_LAYOUT_SAMPLES_NEURONS};
    if (vdna_activations_check(backbone.taps.data(), backbone.taps.size(), backbone.neurons) ||
        vdna_activations_check(&embedding, 1, embedding.neurons))
        throw Failure(VDNA_ERR_NONFINITE, std::string("backbone ") + backbone.info.name +
                                              ": gave a NaN or an infinity for this picture; "
                                              "expected numbers; leave the picture out");
}

uint32_t elapsed_us(Clock::time_point begin, Clock::time_point end)
{
    return static_cast<uint32_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(end - begin).count());
}

} // namespace

vdna_backbone::vdna_backbone(const Manifest &manifest, const vdna_backbone_config &config)
    : runtime(config.runtime),
      session(runtime, manifest, Model(manifest.model, manifest.sha256), config.threads),
      decoder(config.max_pixels), preprocessor(manifest.input), l2_normalise(manifest.l2_normalise),
      embedding(session.embedding().size)
{
    for (size_t t = 0; t < manifest.taps.size(); t++) {
        taps.push_back(as_activations(session.taps()[t], manifest.taps[t].layout));
        neurons += taps[t].neurons;
    }
    fill_info(*this, manifest, config.max_pixels);
}

/* see vdna/backbone.h */
void vdna_backbone_config_init(vdna_backbone_config *config)
{
    if (!config)
        return;
    *config = {};
    config->struct_size = sizeof *config;
    config->threads = threads_default;
    config->max_pixels = VDNA_IMAGE_PIXELS_MAX;
}

/* see vdna/backbone.h */
vdna_status vdna_backbone_open(const vdna_backbone_config *config, vdna_error *error,
                               vdna_backbone **out_backbone)
{
    if (!config || config->struct_size != sizeof *config || !config->manifest ||
        config->threads < 1 || config->threads > threads_max || config->max_pixels < 1 ||
        config->max_pixels > VDNA_IMAGE_PIXELS_MAX || !out_backbone)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "vdna_backbone_open: a manifest, 1 to %u threads and pictures of 1 to %u "
                         "pixels are expected",
                         threads_max, VDNA_IMAGE_PIXELS_MAX);
    return guarded(error, [&] {
        const Manifest manifest = read_manifest(find_manifest(config->manifest));
        require_processor(manifest);
        *out_backbone = new vdna_backbone(manifest, *config);
    });
}

/* see vdna/backbone.h */
void vdna_backbone_close(vdna_backbone *backbone)
{
    delete backbone;
}

/* see vdna/backbone.h */
void vdna_backbone_describe(const vdna_backbone *backbone, vdna_backbone_info *out_info)
{
    if (backbone && out_info)
        *out_info = backbone->info;
}

/* see vdna/backbone.h */
vdna_status vdna_backbone_run(vdna_backbone *backbone, const vdna_image *image, vdna_error *error,
                              vdna_backbone_frame *out_frame)
{
    if (!backbone || !image || !out_frame)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "vdna_backbone_run: a backbone, an image and a frame are expected");
    return guarded(error, [&] {
        require_not_cancelled(*backbone);
        const auto begin = Clock::now();
        const vdna_pixels pixels = backbone->decoder.decode(*image);
        const float grey = picture::mean_grey(pixels);
        const auto decoded = Clock::now();
        backbone->preprocessor.run(pixels, backbone->session.input());
        const auto resized = Clock::now();
        infer(*backbone);
        const auto inferred = Clock::now();
        require_finite(*backbone);

        *out_frame = {backbone->taps.data(),        backbone->embedding.data(),
                      backbone->session.input(),    backbone->taps.size(),
                      backbone->info.dim,           grey,
                      elapsed_us(begin, decoded),   elapsed_us(decoded, resized),
                      elapsed_us(resized, inferred)};
    });
}

/* see vdna/backbone.h */
void vdna_backbone_cancel(vdna_backbone *backbone)
{
    if (!backbone)
        return;
    backbone->cancelled = true;
    backbone->session.terminate();
}
