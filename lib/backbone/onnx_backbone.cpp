#include "onnx_backbone.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vdna/picture.h>

#include "failure.hpp"
#include "golden.hpp"
#include "grid_means.hpp"
#include "manifest.hpp"
#include "manifest_path.hpp"
#include "model.hpp"
#include "picture/decode.hpp"
#include "picture/mean_grey.hpp"
#include "preprocess.hpp"
#include "processor.hpp"
#include "runtime.hpp"
#include "session.hpp"
#include "test_picture.hpp"

namespace vdna::backbone
{

namespace
{

using Clock = std::chrono::steady_clock;

struct OnnxBackbone {
    OnnxBackbone(const Manifest &manifest, const vdna_backbone_config &config);

    Runtime runtime;
    Session session;
    picture::Decoder decoder;
    Preprocessor preprocessor;
    std::vector<vdna_activations> taps;
    uint32_t neurons = 0;
    std::optional<GridMeans> grid;
    bool l2_normalise;
    std::vector<float> embedding;
    vdna_backbone_info info{};
};

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

void fill_info(OnnxBackbone &backbone, const Manifest &manifest, uint32_t max_pixels)
{
    vdna_backbone_info &info = backbone.info;
    vdna_identity &identity = info.identity;
    copy_text(identity.backbone, manifest.name, "the backbone's name");
    copy_text(identity.model_sha256, manifest.sha256, "the SHA-256");
    copy_text(identity.preprocessing, preprocessing_text(manifest), "the preprocessing");
    copy_text(identity.precision, manifest.precision, "the precision");
    write_taps(manifest, backbone.taps, identity.taps);
    copy_text(identity.embedding, embedding_text(manifest.embedding),
              "the definition of the embedding");
    identity.neurons = backbone.neurons;
    identity.dim = static_cast<uint32_t>(backbone.embedding.size());
    copy_text(info.quantised_from, manifest.quantised_from, "the SHA-256 of the original");
    copy_text(info.runtime, "onnxruntime " + backbone.runtime.version(), "the runtime's version");
    info.tap_count = static_cast<uint32_t>(backbone.taps.size());
    info.last_layer_dim = static_cast<uint32_t>(backbone.session.last_layer().size);
    info.embedding_int8 = manifest.embedding.int8;
    info.embedding_dims = manifest.embedding.dims;
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

void infer(OnnxBackbone &backbone)
{
    backbone.session.run();
    const Output &output = backbone.session.embedding();
    if (backbone.grid)
        backbone.grid->run(output.values, backbone.embedding.data());
    else
        std::copy_n(output.values, output.size, backbone.embedding.begin());
    if (backbone.l2_normalise)
        l2_normalise(backbone.embedding);
}

uint32_t elapsed_us(Clock::time_point begin, Clock::time_point end)
{
    return static_cast<uint32_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(end - begin).count());
}

std::optional<GridMeans> grid_of(const Manifest &manifest, const Output &output)
{
    const Embedding &embedding = manifest.embedding;
    if (!embedding.grid)
        return {};
    return GridMeans(output, *embedding.grid,
                     manifest.model.string() + ": output '" + embedding.output + "'");
}

// A second embedding tells what the whole picture is like, so it has one sample of each neuron.
void require_vector(const Manifest &manifest, const Output &last_layer)
{
    if (last_layer.shape.size() > 1)
        throw fail::Failure(VDNA_ERR_MISMATCH,
                            manifest.model.string() + ": output '" + manifest.embedding.last_layer +
                                "' has " + std::to_string(last_layer.shape.size()) +
                                " dimensions besides the batch; expected one, 1xN, for "
                                "'last_layer'");
}

void require_dims(const Manifest &manifest, size_t given)
{
    if (manifest.embedding.dims > given)
        throw fail::Failure(VDNA_ERR_MISMATCH,
                            manifest.model.string() + ": output '" + manifest.embedding.output +
                                "' gives embeddings of " + std::to_string(given) +
                                " numbers; expected at least 'dims', " +
                                std::to_string(manifest.embedding.dims));
}

OnnxBackbone::OnnxBackbone(const Manifest &manifest, const vdna_backbone_config &config)
    : runtime(config.runtime),
      session(runtime, manifest, check_meanwhile(manifest), config.threads),
      decoder(config.max_pixels), preprocessor(manifest.input),
      grid(grid_of(manifest, session.embedding())), l2_normalise(manifest.embedding.l2_normalise),
      embedding(grid ? grid->size() : session.embedding().size)
{
    require_vector(manifest, session.last_layer());
    require_dims(manifest, embedding.size());
    for (size_t t = 0; t < manifest.taps.size(); t++) {
        taps.push_back(as_activations(session.taps()[t], manifest.taps[t].layout));
        neurons += taps[t].neurons;
    }
    fill_info(*this, manifest, config.max_pixels);
}

OnnxBackbone &of(void *state)
{
    return *static_cast<OnnxBackbone *>(state);
}

vdna_backbone_frame run(OnnxBackbone &backbone, picture::Decoder &decoder, const vdna_image &image)
{
    const auto begin = Clock::now();
    const vdna_pixels pixels = decoder.decode(image, backbone.preprocessor.least());
    const float grey = picture::mean_grey(pixels);
    vdna_health_picture health{};
    vdna_health_measure(&pixels, &health); // cannot fail: a decoded picture has pixels
    const auto decoded = Clock::now();
    backbone.preprocessor.run(pixels, backbone.session.input());
    const auto resized = Clock::now();
    infer(backbone);
    const auto inferred = Clock::now();

    return {backbone.taps.data(),
            backbone.embedding.data(),
            backbone.session.input(),
            backbone.taps.size(),
            backbone.info.identity.dim,
            grey,
            elapsed_us(begin, decoded),
            elapsed_us(decoded, resized),
            elapsed_us(resized, inferred),
            backbone.info.last_layer_dim,
            backbone.session.last_layer().values,
            health};
}

// With a decoder of its own: pictures of cameras may be limited to less.
void require_golden(OnnxBackbone &backbone, const Manifest &manifest)
{
    const vdna_image image = test_picture();
    picture::Decoder decoder(image.width * image.height);
    require_golden(manifest, run(backbone, decoder, image));
}

vdna_status open_onnx(const vdna_backbone_config *config, vdna_error *error, void **out_state)
{
    return fail::guarded(error, [&] {
        const Manifest manifest = read_manifest(find_manifest(config->manifest));
        require_processor(manifest);
        auto backbone = std::make_unique<OnnxBackbone>(manifest, *config);
        require_golden(*backbone, manifest);
        *out_state = backbone.release();
    });
}

void close_onnx(void *state)
{
    delete &of(state);
}

void describe_onnx(const void *state, vdna_backbone_info *out_info)
{
    *out_info = static_cast<const OnnxBackbone *>(state)->info;
}

vdna_status run_onnx(void *state, const vdna_image *image, vdna_error *error,
                     vdna_backbone_frame *out_frame)
{
    OnnxBackbone &backbone = of(state);
    return fail::guarded(error, [&] { *out_frame = run(backbone, backbone.decoder, *image); });
}

void cancel_onnx(void *state)
{
    of(state).session.terminate();
}

} // namespace

const vdna_backbone_operations onnx_operations = {sizeof(vdna_backbone_operations),
                                                  VDNA_BACKBONE_OPERATIONS,
                                                  open_onnx,
                                                  close_onnx,
                                                  describe_onnx,
                                                  run_onnx,
                                                  cancel_onnx};

} // namespace vdna::backbone
