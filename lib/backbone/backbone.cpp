#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <growth.h>

#include <vdna/backbone.h>

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
using namespace vdna::backbone;

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

constexpr size_t oldest_config = sizeof(vdna_backbone_config); // in version 0.1

vdna_backbone_config default_config()
{
    vdna_backbone_config config{};
    config.threads = VDNA_BACKBONE_THREADS_DEFAULT;
    config.max_pixels = VDNA_IMAGE_PIXELS_MAX;
    return config;
}

// The output as activations: one axis is the neurons, all others together are the samples.
vdna_activations as_activations(const Output &output, uint32_t layout)
{
    const int64_t neurons =
        layout == VDNA_LAYOUT_SAMPLES_NEURONS ? output.shape.back() : output.shape.front();
    const auto size = static_cast<int64_t>(output.size);
    return {output.values, static_cast<uint32_t>(neurons), static_cast<uint32_t>(size / neurons),
            layout};
}

void write_taps(const Manifest &manifest, const std::vector<vdna_activations> &taps,
                char (&out)[VDNA_TAPS_SIZE])
{
    for (size_t t = 0; t < taps.size(); t++) {
        const std::string &name = manifest.taps[t].output;
        const vdna_tap tap = {name.data(), name.size(), taps[t].neurons, taps[t].samples};
        const vdna_status status = vdna_taps_append(out, sizeof out, &tap);
        if (status == VDNA_ERR_NOMEM)
            throw fail::Failure(VDNA_ERR_FORMAT,
                                "the list of taps has " + std::to_string(sizeof out) +
                                    " characters or more; at most " +
                                    std::to_string(sizeof out - 1) + " are expected");
        if (status != VDNA_OK)
            throw fail::Failure(VDNA_ERR_FORMAT,
                                "backbone " + manifest.name + ": the name of tap " +
                                    std::to_string(t + 1) +
                                    " has a character that is not printable ASCII");
    }
}

// Copied in full or refused: a text cut short would make different backbones look alike.
template <size_t Room>
void copy_text(char (&out)[Room], const std::string &text, const char *what)
{
    if (text.size() >= Room)
        throw fail::Failure(VDNA_ERR_FORMAT, std::string(what) + " has " +
                                                 std::to_string(text.size()) +
                                                 " characters; at most " +
                                                 std::to_string(Room - 1) + " are expected");
    std::memcpy(out, text.c_str(), text.size() + 1);
}

void require_processor(const Manifest &manifest)
{
    const char *const lacks = lacks_for_int8_products();
    if (manifest.precision == "int8" && lacks)
        throw fail::Failure(
            VDNA_ERR_UNSUPPORTED,
            "backbone " + manifest.name + ": is int8, and this processor lacks " + lacks +
                ": it may give other numbers than processors that have it; use the fp32 "
                "network and a map made with it");
}

void fill_info(vdna_backbone &backbone, const Manifest &manifest, uint32_t max_pixels)
{
    vdna_backbone_info &info = backbone.info;
    vdna_identity &identity = info.identity;
    copy_text(identity.backbone, manifest.name, "the backbone's name");
    copy_text(identity.model_sha256, manifest.sha256, "the SHA-256");
    copy_text(identity.preprocessing, preprocessing_text(manifest), "the preprocessing");
    copy_text(identity.precision, manifest.precision, "the precision");
    write_taps(manifest, backbone.taps, identity.taps);
    identity.neurons = backbone.neurons;
    identity.dim = static_cast<uint32_t>(backbone.embedding.size());
    copy_text(info.quantised_from, manifest.quantised_from, "the SHA-256 of the original");
    copy_text(info.runtime, "onnxruntime " + backbone.runtime.version(), "the runtime's version");
    info.tap_count = static_cast<uint32_t>(backbone.taps.size());
    info.input_width = manifest.input.width;
    info.input_height = manifest.input.height;
    info.decode_bytes = vdna_decoder_bytes_max(max_pixels);
}

// Hashing the model takes about as long as ONNX Runtime needs to start, and a robot waits for both.
std::future<Model> check_meanwhile(const Manifest &manifest)
{
    return std::async(std::launch::async,
                      [&manifest] { return Model(manifest.model, manifest.sha256); });
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
        throw fail::Failure(VDNA_ERR_RUNTIME, "the backbone was cancelled; open it again");
}

void infer(vdna_backbone &backbone)
{
    try {
        backbone.session.run();
    } catch (const fail::Failure &) {
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
    const vdna_activations embedding = {backbone.embedding.data(), backbone.info.identity.dim, 1,
                                        VDNA_LAYOUT_SAMPLES_NEURONS};
    if (vdna_activations_check(backbone.taps.data(), backbone.taps.size(), backbone.neurons) ||
        vdna_activations_check(&embedding, 1, embedding.neurons))
        throw fail::Failure(VDNA_ERR_NONFINITE, std::string("backbone ") +
                                                    backbone.info.identity.backbone +
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
      session(runtime, manifest, check_meanwhile(manifest), config.threads),
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
    const vdna_backbone_config defaults = default_config();
    vdna_config_write(config, oldest_config, &defaults, sizeof defaults);
}

/* see vdna/backbone.h */
vdna_status vdna_backbone_open(const vdna_backbone_config *config, vdna_error *error,
                               vdna_backbone **out_backbone)
{
    vdna_backbone_config known = default_config();
    if (!vdna_config_read(config, oldest_config, &known, sizeof known) || !known.manifest ||
        known.threads < 1 || known.threads > VDNA_BACKBONE_THREADS_MAX || known.max_pixels < 1 ||
        known.max_pixels > VDNA_IMAGE_PIXELS_MAX || !out_backbone)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "vdna_backbone_open: a manifest, 1 to %u threads and pictures of 1 to %u "
                         "pixels are expected",
                         VDNA_BACKBONE_THREADS_MAX, VDNA_IMAGE_PIXELS_MAX);
    return fail::guarded(error, [&] {
        const Manifest manifest = read_manifest(find_manifest(known.manifest));
        require_processor(manifest);
        *out_backbone = new vdna_backbone(manifest, known);
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
    return fail::guarded(error, [&] {
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
                      backbone->info.identity.dim,  grey,
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
