// The C ABI: one network behind its table of operations. What a table gives is checked here, once
// for all tables.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <growth.h>

#include <vdna/backbone.h>

#include "failure.hpp"
#include "onnx_backbone.hpp"
#include "plugin.hpp"

using namespace vdna;
using namespace vdna::backbone;

struct vdna_backbone {
    vdna_backbone(const vdna_backbone_operations &table, void *opened)
        : operations(table), state(opened)
    {
    }
    ~vdna_backbone() { operations.close(state); }

    vdna_backbone_operations operations;
    void *state;
    vdna_backbone_info info{};
    std::vector<vdna_tap> taps; // of `info`
    std::atomic<bool> cancelled{false};
};

namespace
{

constexpr size_t oldest_config = sizeof(vdna_backbone_config); // in version 0.1

vdna_backbone_config default_config()
{
    vdna_backbone_config config{};
    config.threads = VDNA_BACKBONE_THREADS_DEFAULT;
    config.max_pixels = VDNA_IMAGE_PIXELS_MAX;
    return config;
}

vdna_backbone_config read_config(const vdna_backbone_config *config)
{
    vdna_backbone_config known = default_config();
    if (!vdna_config_read(config, oldest_config, &known, sizeof known) || known.threads < 1 ||
        known.threads > VDNA_BACKBONE_THREADS_MAX || known.max_pixels < 1 ||
        known.max_pixels > VDNA_IMAGE_PIXELS_MAX)
        throw fail::Failure(VDNA_ERR_ARG, "vdna_backbone_open: a configuration with 1 to " +
                                              std::to_string(VDNA_BACKBONE_THREADS_MAX) +
                                              " threads and pictures of 1 to " +
                                              std::to_string(VDNA_IMAGE_PIXELS_MAX) +
                                              " pixels is expected");
    known.struct_size = sizeof known;
    return known;
}

// Others' code may give any number, and say nothing.
void require(vdna_status status, const vdna_error &error, const char *whose, const char *operation)
{
    if (status == VDNA_OK)
        return;
    const bool known = status > 0 && status < VDNA_STATUS_COUNT;
    const std::string sentence(error.text, strnlen(error.text, sizeof error.text));
    throw fail::Failure(known ? status : VDNA_ERR_RUNTIME,
                        !sentence.empty() ? sentence
                                          : std::string(whose) + ": " + operation +
                                                " failed: " + vdna_status_text(status));
}

[[noreturn]] void refuse_description(const std::string &whose, const std::string &why)
{
    throw fail::Failure(VDNA_ERR_FORMAT,
                        whose + ": describes itself wrongly: " + why + "; correct the plug-in");
}

// All that is said of a frame is compared with this description, and maps are made by it.
void describe(vdna_backbone &backbone, const std::string &whose)
{
    vdna_backbone_info &info = backbone.info;
    backbone.operations.describe(backbone.state, &info);
    info.runtime[sizeof info.runtime - 1] = '\0';
    info.quantised_from[sizeof info.quantised_from - 1] = '\0';
    info.identity.bins = 0;
    info.identity.range = nullptr;
    info.identity.projection = nullptr;
    info.identity.raw_dim = 0;

    vdna_error why{};
    if (vdna_identity_check(&info.identity, &why) != VDNA_OK)
        refuse_description(whose, why.text);
    if (info.identity.dim < 1)
        refuse_description(whose, "dim is 0, expected the numbers in an embedding");
    if (info.embedding_dims > info.identity.dim)
        refuse_description(whose, "embedding_dims is " + std::to_string(info.embedding_dims) +
                                      ", expected at most dim, " +
                                      std::to_string(info.identity.dim));
    if ((info.input_width == 0) != (info.input_height == 0))
        refuse_description(whose,
                           "one of input_width and input_height is 0, expected both or none");

    const char *rest = info.identity.taps;
    for (vdna_tap tap; vdna_taps_next(&rest, &tap) == VDNA_OK;)
        backbone.taps.push_back(tap);
    if (backbone.taps.size() != info.tap_count)
        refuse_description(whose, "tap_count is " + std::to_string(info.tap_count) +
                                      ", expected as many as in taps, \"" + info.identity.taps +
                                      "\"");
}

std::unique_ptr<vdna_backbone> open(const vdna_backbone_operations &operations,
                                    const vdna_backbone_config &config, const std::string &whose)
{
    vdna_error error{};
    void *state = nullptr;
    require(operations.open(&config, &error, &state), error, whose.c_str(), "open");
    auto backbone = std::make_unique<vdna_backbone>(operations, state);
    describe(*backbone, whose);
    return backbone;
}

void require_not_cancelled(const vdna_backbone &backbone)
{
    if (backbone.cancelled)
        throw fail::Failure(VDNA_ERR_RUNTIME, "the backbone was cancelled; open it again");
}

[[noreturn]] void refuse_frame(const vdna_backbone &backbone, const std::string &found,
                               const std::string &expected)
{
    throw fail::Failure(VDNA_ERR_MISMATCH, std::string("backbone ") +
                                               backbone.info.identity.backbone + ": gave " + found +
                                               ", expected " + expected +
                                               " as it says of itself; correct the plug-in");
}

void require_taps(const vdna_backbone &backbone, const vdna_backbone_frame &frame)
{
    const auto texts = [](uint32_t neurons, uint32_t samples) {
        return std::to_string(neurons) + " neurons with " + std::to_string(samples) + " samples";
    };
    if (!frame.taps || frame.tap_count != backbone.taps.size())
        refuse_frame(backbone, std::to_string(frame.taps ? frame.tap_count : 0) + " taps",
                     std::to_string(backbone.taps.size()));
    for (size_t t = 0; t < frame.tap_count; t++) {
        const vdna_activations &found = frame.taps[t];
        const vdna_tap &stated = backbone.taps[t];
        if (found.neurons != stated.neurons || found.samples != stated.samples)
            refuse_frame(backbone,
                         "for tap " + std::to_string(t + 1) + " " +
                             texts(found.neurons, found.samples),
                         texts(stated.neurons, stated.samples));
    }
}

void require_fitting(const vdna_backbone &backbone, const vdna_backbone_frame &frame)
{
    const vdna_backbone_info &info = backbone.info;
    require_taps(backbone, frame);
    if (!frame.embedding || frame.dim != info.identity.dim)
        refuse_frame(backbone,
                     "an embedding of " + std::to_string(frame.embedding ? frame.dim : 0) +
                         " numbers",
                     std::to_string(info.identity.dim));
    if ((frame.last_layer ? frame.last_layer_dim : 0) != info.last_layer_dim)
        refuse_frame(backbone,
                     "a last layer of " +
                         std::to_string(frame.last_layer ? frame.last_layer_dim : 0) + " numbers",
                     std::to_string(info.last_layer_dim));
    if ((frame.input != nullptr) != (info.input_width > 0))
        refuse_frame(backbone, frame.input ? "an input" : "no input", frame.input ? "none" : "one");
    if (!(frame.grey >= 0.0f && frame.grey <= 255.0f))
        refuse_frame(backbone, "the grey level " + std::to_string(frame.grey), "0 to 255");
}

bool all_finite(const float *values, uint32_t count)
{
    return std::all_of(values, values + count, [](float value) { return std::isfinite(value); });
}

void require_finite(const vdna_backbone &backbone, const vdna_backbone_frame &frame)
{
    const vdna_identity &identity = backbone.info.identity;
    const vdna_status taps = vdna_activations_check(frame.taps, frame.tap_count, identity.neurons);
    if (taps == VDNA_ERR_NONFINITE || !all_finite(frame.embedding, frame.dim) ||
        !all_finite(frame.last_layer, frame.last_layer_dim))
        throw fail::Failure(VDNA_ERR_NONFINITE, std::string("backbone ") + identity.backbone +
                                                    ": gave a NaN or an infinity for this picture; "
                                                    "expected numbers; leave the picture out");
    if (taps != VDNA_OK)
        refuse_frame(backbone, "a tap without values or of no layout", "activations");
}

} // namespace

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
    return fail::guarded(error, [&] {
        const vdna_backbone_config known = read_config(config);
        if (!known.manifest || !out_backbone)
            throw fail::Failure(VDNA_ERR_ARG,
                                "vdna_backbone_open: a manifest and out_backbone are expected");
        const std::string manifest = known.manifest;
        *out_backbone = is_plugin(manifest) ? open(load_plugin(manifest), known, manifest).release()
                                            : open(onnx_operations, known, manifest).release();
    });
}

/* see vdna/backbone.h */
vdna_status vdna_backbone_open_with(const vdna_backbone_operations *operations,
                                    const vdna_backbone_config *config, vdna_error *error,
                                    vdna_backbone **out_backbone)
{
    static const char *const name = "vdna_backbone_open_with";
    return fail::guarded(error, [&] {
        const vdna_backbone_config known = read_config(config);
        if (!operations || !out_backbone)
            throw fail::Failure(VDNA_ERR_ARG,
                                std::string(name) + ": operations and out_backbone are expected");
        *out_backbone = open(checked(operations, name), known, name).release();
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
        vdna_error why{};
        vdna_backbone_frame frame{};
        const vdna_status status = backbone->operations.run(backbone->state, image, &why, &frame);
        if (status != VDNA_OK)
            require_not_cancelled(*backbone);
        require(status, why, backbone->info.identity.backbone, "run");
        require_fitting(*backbone, frame);
        require_finite(*backbone, frame);
        *out_frame = frame;
    });
}

/* see vdna/backbone.h */
void vdna_backbone_cancel(vdna_backbone *backbone)
{
    if (!backbone)
        return;
    backbone->cancelled = true;
    backbone->operations.cancel(backbone->state);
}
