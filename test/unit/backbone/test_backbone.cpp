// The C ABI of lib/backbone, with a network that can be checked by hand and with a real one.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include <cmocka.hpp>
#include <folder.hpp>
#include <sha2.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vdna/backbone.h>

#include "backbone/golden.hpp"
#include "backbone/test_picture.hpp"
#include "picture/small_jpeg.hpp"

using Bytes = std::vector<uint8_t>;

// The recipe of a manifest of the tiny network (test/support/make_tiny_network.py).
struct Recipe {
    std::string taps = "[[taps]]\noutput = \"map\"\nlayout = \"neurons_samples\"\n";
    std::string colour = "RGB";
    std::string mean = "[0, 0, 0]";
    std::string std = "[1, 1, 1]";
    std::string embedding = "mean";
    std::string how; // further lines of [embedding]
    std::string l2_normalise = "false";
    std::string golden; // section at the end
    std::string width = "2";
    std::string decode = "full";
    std::string model = file_bytes(VDNA_TINY_NETWORK);
    std::string sha256 = ""; // of `model` if empty
};

// A folder with the manifest and the model of a recipe.
class TinyNetwork
{
  public:
    explicit TinyNetwork(const Recipe &recipe = {})
    {
        folder_.write("tiny.onnx", recipe.model);
        char sha256[SHA256_DIGEST_STRING_LENGTH];
        SHA256Data(reinterpret_cast<const uint8_t *>(recipe.model.data()), recipe.model.size(),
                   sha256);
        manifest_ = folder_.write(
            "tiny.toml", "name = \"tiny\"\nmodel = \"tiny.onnx\"\nsha256 = \"" +
                             (recipe.sha256.empty() ? sha256 : recipe.sha256) +
                             "\"\nsource = \"made\"\nlicence = \"MIT\"\n[input]\nname = \"image\"\n"
                             "width = " +
                             recipe.width + "\nheight = 2\ncolour = \"" + recipe.colour +
                             "\"\nmean = " + recipe.mean + "\nstd = " + recipe.std +
                             "\nresize = \"stretch\"\ninterpolation = \"area\"\ndecode = \"" +
                             recipe.decode + "\"\n" + recipe.taps + "[embedding]\noutput = \"" +
                             recipe.embedding + "\"\n" + recipe.how +
                             "l2_normalise = " + recipe.l2_normalise + "\n" + recipe.golden);
    }

    vdna_status open(vdna_error *error, vdna_backbone **out_backbone,
                     const char *runtime = nullptr) const
    {
        vdna_backbone_config config;
        vdna_backbone_config_init(&config);
        config.manifest = manifest_.c_str();
        config.runtime = runtime;
        return vdna_backbone_open(&config, error, out_backbone);
    }

  private:
    Folder folder_;
    std::filesystem::path manifest_;
};

static vdna_backbone *opened(const Recipe &recipe = {})
{
    const TinyNetwork network(recipe);
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    if (network.open(&error, &backbone) != VDNA_OK)
        fail_msg("%s", error.text);
    return backbone;
}

// Opening the network of `recipe` fails with `status`, in a sentence with `words`.
static void assert_not_opened(const Recipe &recipe, vdna_status status, const std::string &words,
                              const char *runtime = nullptr)
{
    const TinyNetwork network(recipe);
    vdna_error error = {""};
    vdna_backbone *backbone = nullptr;
    assert_int_equal(network.open(&error, &backbone, runtime), status);
    assert_null(backbone);
    if (std::string(error.text).find(words) == std::string::npos)
        fail_msg("expected: %s; found: %s", words.c_str(), error.text);
}

// 2x2 pixels of R, G, B; the network takes them as they are.
static const uint8_t four_pixels[] = {10, 20, 30, 11, 21, 31, 12, 22, 32, 13, 23, 33};
static const vdna_image small = {four_pixels, sizeof four_pixels, 2, 2, 0, VDNA_PIXEL_RGB3};

static vdna_backbone_frame run(vdna_backbone *backbone, const vdna_image &image)
{
    vdna_error error;
    vdna_backbone_frame frame = {};
    if (vdna_backbone_run(backbone, &image, &error, &frame) != VDNA_OK)
        fail_msg("%s", error.text);
    return frame;
}

static void assert_values(const float *found, const std::vector<float> &expected)
{
    for (size_t i = 0; i < expected.size(); i++)
        assert_float_equal(found[i], expected[i], 1e-5f);
}

// The open and one run of a process that has no file in its home directory yet.
static int use_a_backbone_at_home(const char *home)
{
    for (const char *name : {"CI", "XDG_CACHE_HOME", "ORT_DISABLE_TELEMETRY"})
        unsetenv(name);
    setenv("HOME", home, 1);
    vdna_backbone *backbone = opened();
    run(backbone, small);
    vdna_backbone_close(backbone);
    const char *disabled = std::getenv("ORT_DISABLE_TELEMETRY");
    return disabled && std::strcmp(disabled, "1") == 0 ? 0 : 1;
}

static void the_runtime_writes_nothing_at_home(void **)
{
    const Folder home;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(use_a_backbone_at_home(home.path().c_str()));
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_true(std::filesystem::is_empty(home.path()));
}

static void an_open_backbone_describes_itself(void **)
{
    Recipe recipe;
    recipe.taps += "[[taps]]\noutput = \"tokens\"\nlayout = \"samples_neurons\"\n";
    vdna_backbone *backbone = opened(recipe);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_string_equal(info.identity.backbone, "tiny");
    assert_int_equal(std::strlen(info.identity.model_sha256), 64);
    assert_string_equal(info.identity.preprocessing,
                        "2x2 RGB mean=0,0,0 std=1,1,1 resize=stretch/area l2=0");
    assert_string_equal(info.identity.taps, "map:3:4,tokens:3:4");
    assert_memory_equal(info.runtime, "onnxruntime 1.", 14);
    assert_int_equal(info.tap_count, 2);
    assert_int_equal(info.identity.neurons, 6);
    assert_int_equal(info.identity.dim, 3);
    assert_int_equal(info.input_width, 2);
    assert_int_equal(info.input_height, 2);
    vdna_backbone_close(backbone);
}

static void taps_have_the_layout_of_the_network(void **)
{
    Recipe recipe;
    recipe.taps += "[[taps]]\noutput = \"tokens\"\nlayout = \"samples_neurons\"\n"
                   "[[taps]]\noutput = \"mean\"\nlayout = \"samples_neurons\"\n";
    vdna_backbone *backbone = opened(recipe);
    const vdna_backbone_frame frame = run(backbone, small);
    assert_int_equal(frame.tap_count, 3);
    assert_values(frame.taps[0].values, {10, 11, 12, 13, 20, 21, 22, 23, 30, 31, 32, 33});
    assert_values(frame.taps[1].values, {10, 20, 30, 11, 21, 31, 12, 22, 32, 13, 23, 33});
    assert_values(frame.taps[2].values, {11.5f, 21.5f, 31.5f});
    assert_values(frame.embedding, {11.5f, 21.5f, 31.5f});
    assert_int_equal(frame.taps[0].layout, VDNA_LAYOUT_NEURONS_SAMPLES);
    assert_int_equal(frame.taps[1].samples, 4);
    assert_int_equal(frame.taps[2].samples, 1);
    // 0.299 * 11.5 + 0.587 * 21.5 + 0.114 * 31.5
    assert_float_equal(frame.grey, 19.65f, 1e-4f);
    vdna_backbone_close(backbone);
}

static void mean_and_std_are_in_the_channel_order_of_the_network(void **)
{
    Recipe recipe;
    recipe.colour = "BGR";
    recipe.mean = "[30, 20, 10]";
    recipe.std = "[0.5, 1, 2]";
    vdna_backbone *backbone = opened(recipe);
    assert_values(run(backbone, small).embedding, {3.0f, 1.5f, 0.75f});

    // The same picture, sent in the other order.
    Bytes swapped(four_pixels, four_pixels + sizeof four_pixels);
    for (size_t i = 0; i < swapped.size(); i += 3)
        std::swap(swapped[i], swapped[i + 2]);
    const vdna_image image = {swapped.data(), swapped.size(), 2, 2, 0, VDNA_PIXEL_BGR3};
    assert_values(run(backbone, image).embedding, {3.0f, 1.5f, 0.75f});
    vdna_backbone_close(backbone);
}

static void a_larger_picture_is_averaged_down(void **)
{
    // 4x4 grey pixels, averaged 2x2: 0 and 100 by turns, then 200.
    const uint8_t pixels[] = {0, 100, 200, 200, 100, 0, 200, 200, 50, 50, 8, 8, 50, 50, 8, 8};
    const vdna_image image = {pixels, sizeof pixels, 4, 4, 0, VDNA_PIXEL_GREY};
    vdna_backbone *backbone = opened();
    assert_values(run(backbone, image).taps[0].values, {50, 200, 50, 8, 50, 200, 50, 8});
    vdna_backbone_close(backbone);
}

// A JPEG that says nothing but 4 colours, one in each 8x8 block.
static std::string four_blocks()
{
    vdna_pixels pixels = {nullptr, size_t{16} * 3, 16, 16, 3, {0, 1, 2}};
    Bytes bytes;
    for (size_t y = 0; y < 16; y++)
        for (size_t x = 0; x < 16; x++)
            for (size_t c = 0; c < 3; c++)
                bytes.push_back(static_cast<uint8_t>(40 + 60 * (x / 8) + 90 * (y / 8)));
    pixels.data = bytes.data();
    return vdna::picture::jpeg_of(pixels, 100);
}

static void a_jpeg_is_reduced_only_if_the_manifest_says_so(void **)
{
    const std::string jpeg = four_blocks();
    const vdna_image image = {
        reinterpret_cast<const uint8_t *>(jpeg.data()), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG};
    Recipe recipe;
    for (const auto &[decode, side] : {std::pair("full", 16u), std::pair("reduced", 2u)}) {
        recipe.decode = decode;
        vdna_backbone *backbone = opened(recipe);
        const vdna_backbone_frame frame = run(backbone, image);
        assert_int_equal(frame.health.width, side);
        const float levels[] = {40, 100, 130, 190};
        for (size_t i = 0; i < 4; i++)
            assert_float_equal(frame.input[i], levels[i], 2.0f);
        vdna_backbone_info info;
        vdna_backbone_describe(backbone, &info);
        assert_int_equal(std::strstr(info.identity.preprocessing, "decode=reduced") != nullptr,
                         side == 2);
        vdna_backbone_close(backbone);
    }
}

static void l2_normalisation_concerns_the_embedding_only(void **)
{
    Recipe recipe;
    recipe.taps = "[[taps]]\noutput = \"mean\"\nlayout = \"samples_neurons\"\n";
    recipe.l2_normalise = "true";
    recipe.mean = "[8.5, 17.5, 31.5]"; // leaves 3, 4, 0
    vdna_backbone *backbone = opened(recipe);
    const vdna_backbone_frame frame = run(backbone, small);
    assert_values(frame.embedding, {0.6f, 0.8f, 0.0f});
    assert_values(frame.taps[0].values, {3.0f, 4.0f, 0.0f});
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_non_null(std::strstr(info.identity.preprocessing, "l2=1"));
    vdna_backbone_close(backbone);
}

static void a_grid_of_a_feature_map_is_the_embedding_and_the_tap_stays(void **)
{
    Recipe recipe;
    recipe.embedding = "map";
    recipe.how = "grid = [1, 2]\ncentre = true\nlast_layer = \"mean\"\nstorage = \"int8\"\n";
    vdna_backbone *backbone = opened(recipe);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_string_equal(info.identity.embedding, "map grid=1x2 last=mean centred");
    assert_int_equal(info.identity.dim, 6);
    assert_int_equal(info.last_layer_dim, 3);
    assert_int_equal(info.embedding_int8, 1);
    assert_int_equal(vdna_identity_is_centred(&info.identity), 1);

    // By channel, then by column: nothing is subtracted here.
    const vdna_backbone_frame frame = run(backbone, small);
    assert_int_equal(frame.dim, 6);
    assert_values(frame.embedding, {11, 12, 21, 22, 31, 32});
    assert_values(frame.taps[0].values, {10, 11, 12, 13, 20, 21, 22, 23, 30, 31, 32, 33});
    assert_values(frame.last_layer, {11.5f, 21.5f, 31.5f});
    vdna_backbone_close(backbone);

    // l2 normalisation comes after the means.
    recipe.how = "grid = 1\n";
    recipe.l2_normalise = "true";
    recipe.mean = "[8.5, 17.5, 31.5]"; // leaves 3, 4, 0
    backbone = opened(recipe);
    assert_values(run(backbone, small).embedding, {0.6f, 0.8f, 0.0f});
    assert_null(run(backbone, small).last_layer);
    vdna_backbone_close(backbone);
}

static void a_map_may_keep_fewer_numbers_than_a_frame_has(void **)
{
    Recipe recipe;
    recipe.how = "dims = 3\n";
    vdna_backbone *backbone = opened(recipe);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_int_equal(info.embedding_dims, 3);
    assert_int_equal(info.identity.dim, 3);
    assert_string_equal(info.identity.embedding, "");
    assert_int_equal(run(backbone, small).dim, 3);
    vdna_backbone_close(backbone);

    recipe.how = "dims = 4\n";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                      "output 'mean' gives embeddings of 3 numbers; expected at least 'dims', 4");
}

// The section [golden] of a recipe's network.
static std::string golden_of(const Recipe &recipe)
{
    vdna_backbone *backbone = opened(recipe);
    const std::string text =
        vdna::backbone::golden_text(run(backbone, vdna::backbone::test_picture()));
    vdna_backbone_close(backbone);
    return text;
}

static void a_network_that_gives_its_golden_numbers_is_opened(void **)
{
    Recipe recipe;
    recipe.how = "last_layer = \"mean\"\n";
    recipe.golden = golden_of(recipe);
    vdna_backbone_close(opened(recipe));
}

static void one_that_gives_others_is_refused_by_the_first_that_differs(void **)
{
    Recipe recipe;
    recipe.golden = golden_of(recipe);
    const auto refused = [&recipe](const char *what) {
        assert_not_opened(recipe, VDNA_ERR_MISMATCH, what);
        assert_not_opened(recipe, VDNA_ERR_MISMATCH, "`vdna model golden` prints");
    };
    recipe.colour = "BGR";
    refused("tiny.toml: for the test picture tap 'map' gives ");
    recipe.colour = "RGB";
    recipe.std = "[1.002, 1.002, 1.002]"; // above the tolerance of 0.001
    refused("of 8, [golden] expects ");
    recipe.std = "[1.0005, 1.0005, 1.0005]"; // below
    vdna_backbone_close(opened(recipe));

    recipe.l2_normalise = "true"; // of the embedding only
    refused("the embedding gives ");
    recipe.l2_normalise = "false";
    recipe.golden = "[golden]\ntolerance = 0.1\ntaps = [[0]]\nembedding = [1, 2, 3, 4]\n";
    refused("tap 'map' gives ");
}

static void more_golden_numbers_than_an_output_has_are_refused(void **)
{
    Recipe recipe;
    recipe.golden = with(golden_of(recipe), "embedding = [", "embedding = [0, 0, 0, ");
    assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                      "the embedding has 3 numbers, [golden] expects 6 parts of them");
}

static void a_grid_of_what_has_no_rows_and_columns_is_refused(void **)
{
    Recipe recipe;
    recipe.how = "grid = 2\n";
    for (const char *output : {"mean", "tokens"}) {
        recipe.embedding = output;
        assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                          "tiny.onnx: output '" + std::string(output) + "' has ");
        assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                          "dimensions and no rows and columns; expected a feature map");
    }
    recipe.embedding = "map";
    recipe.how = "grid = 3\n";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                      "output 'map' has 2x2 pixels, which 'grid' cannot divide into 3x3 cells");
    recipe.how = "grid = [1, 3]\n";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH, "into 1x3 cells");
    recipe.how = "last_layer = \"absent\"\n";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH, "has no output 'absent'; it has: mean, map");
    recipe.how = "last_layer = \"tokens\"\n";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                      "output 'tokens' has 2 dimensions besides the batch; expected one, 1xN, for "
                      "'last_layer'");
}

static void outputs_that_are_not_finite_are_refused(void **)
{
    const Bytes black(12, 0);
    const vdna_image image = {black.data(), black.size(), 2, 2, 0, VDNA_PIXEL_RGB3};
    vdna_error error;
    vdna_backbone_frame frame = {};

    Recipe tapped; // log(0) is minus infinity
    tapped.taps = "[[taps]]\noutput = \"logarithm\"\nlayout = \"samples_neurons\"\n";
    vdna_backbone *backbone = opened(tapped);
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), VDNA_ERR_NONFINITE);
    assert_null(frame.taps); // untouched
    run(backbone, small);
    vdna_backbone_close(backbone);

    Recipe normalised; // 0 / 0
    normalised.l2_normalise = "true";
    backbone = opened(normalised);
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), VDNA_ERR_NONFINITE);
    vdna_backbone_close(backbone);
}

static void a_refused_picture_leaves_the_backbone_as_it_was(void **)
{
    vdna_backbone *backbone = opened();
    vdna_image cut = small;
    cut.size--;
    vdna_error error = {""};
    vdna_backbone_frame frame = {};
    assert_int_equal(vdna_backbone_run(backbone, &cut, &error, &frame), VDNA_ERR_FORMAT);
    assert_non_null(std::strstr(error.text, "expected at least 12 bytes"));
    assert_null(frame.embedding);
    assert_values(run(backbone, small).embedding, {11.5f, 21.5f, 31.5f});
    vdna_backbone_close(backbone);
}

static void a_model_other_than_the_pinned_one_is_refused(void **)
{
    Recipe wrong;
    wrong.sha256 = std::string(64, '0');
    assert_not_opened(wrong, VDNA_ERR_CHECKSUM, "the manifest expects 0000");

    Recipe outside;
    outside.model = "\x0a\x08location\x12\x0bweights.bin";
    assert_not_opened(outside, VDNA_ERR_UNSUPPORTED, "weights in another file");

    Recipe nonsense;
    nonsense.model = "no network";
    assert_not_opened(nonsense, VDNA_ERR_RUNTIME, "tiny.onnx: ");
}

static void a_model_that_does_not_fit_its_manifest_is_refused(void **)
{
    Recipe recipe;
    recipe.embedding = "absent";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH,
                      "has no output 'absent'; it has: mean, map, tokens");
    recipe.embedding = "flat";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH, "output 'flat' has shape 12");
    recipe.embedding = "whole";
    assert_not_opened(recipe, VDNA_ERR_MISMATCH, "output 'whole'");

    Recipe wide;
    wide.width = "3";
    assert_not_opened(wide, VDNA_ERR_MISMATCH,
                      "has shape 1x3x2x2; the manifest expects floats, 1x3x2x3");
}

static void a_library_that_is_no_runtime_is_refused(void **)
{
    assert_not_opened({}, VDNA_ERR_RUNTIME, "/nowhere/libonnxruntime.so",
                      "/nowhere/libonnxruntime.so");
    assert_not_opened({}, VDNA_ERR_RUNTIME, "this is no ONNX Runtime", "libm.so.6");
    const char *set_by_ctest = std::getenv("VDNA_ONNXRUNTIME");
    assert_non_null(set_by_ctest);
    const std::string good = set_by_ctest;
    setenv("VDNA_ONNXRUNTIME", "/elsewhere.so", 1);
    assert_not_opened({}, VDNA_ERR_RUNTIME, "/elsewhere.so");
    setenv("VDNA_ONNXRUNTIME", good.c_str(), 1);
}

static void arguments_are_checked(void **)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    assert_int_equal(config.threads, 2);
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    assert_int_equal(vdna_backbone_open(&config, &error, &backbone), VDNA_ERR_ARG);
    config.manifest = "absent.toml";
    assert_int_equal(vdna_backbone_open(&config, &error, nullptr), VDNA_ERR_ARG);
    assert_int_equal(vdna_backbone_open(&config, &error, &backbone), VDNA_ERR_IO);
    config.threads = 0;
    assert_int_equal(vdna_backbone_open(&config, nullptr, &backbone), VDNA_ERR_ARG);
    config.threads = 1;
    assert_int_equal(config.max_pixels, VDNA_IMAGE_PIXELS_MAX);
    for (const uint32_t pixels : {0u, VDNA_IMAGE_PIXELS_MAX + 1}) {
        config.max_pixels = pixels;
        assert_int_equal(vdna_backbone_open(&config, nullptr, &backbone), VDNA_ERR_ARG);
    }
    config.max_pixels = 1;
    for (const uint32_t size : {0u, config.struct_size - 1, config.struct_size + 1}) {
        vdna_backbone_config other = config;
        other.struct_size = size;
        assert_int_equal(vdna_backbone_open(&other, &error, &backbone), VDNA_ERR_ARG);
    }
    assert_int_equal(vdna_backbone_open(nullptr, &error, &backbone), VDNA_ERR_ARG);

    backbone = opened();
    vdna_backbone_frame frame;
    assert_int_equal(vdna_backbone_run(backbone, nullptr, &error, &frame), VDNA_ERR_ARG);
    assert_int_equal(vdna_backbone_run(backbone, &small, &error, nullptr), VDNA_ERR_ARG);
    assert_int_equal(vdna_backbone_run(nullptr, &small, &error, &frame), VDNA_ERR_ARG);
    vdna_backbone_cancel(nullptr);
    vdna_backbone_close(backbone);
    vdna_backbone_close(nullptr);
}

static vdna_backbone *opened_real(uint32_t threads)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = "efficientnet_lite0";
    config.threads = threads;
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    if (vdna_backbone_open(&config, &error, &backbone) != VDNA_OK)
        fail_msg("%s", error.text);
    return backbone;
}

// A different picture for each `seed`.
static Bytes noise(uint32_t seed, size_t size)
{
    Bytes bytes(size);
    for (uint8_t &byte : bytes) {
        seed = seed * 1664525u + 1013904223u;
        byte = static_cast<uint8_t>(seed >> 24);
    }
    return bytes;
}

static std::vector<float> embedding_of(vdna_backbone *backbone, const Bytes &rgb)
{
    const vdna_image image = {rgb.data(), rgb.size(), 300, 200, 0, VDNA_PIXEL_RGB3};
    const vdna_backbone_frame frame = run(backbone, image);
    return {frame.embedding, frame.embedding + frame.dim};
}

static void a_picture_gives_the_same_bits_whatever_came_before(void **)
{
    const Bytes one = noise(1, 180000), other = noise(2, 180000);
    vdna_backbone *backbone = opened_real(2);
    const std::vector<float> first = embedding_of(backbone, one);
    assert_true(embedding_of(backbone, one) == first);
    assert_true(embedding_of(backbone, other) != first);
    vdna_image broken = {one.data(), 5, 300, 200, 0, VDNA_PIXEL_RGB3};
    vdna_backbone_frame frame;
    assert_int_equal(vdna_backbone_run(backbone, &broken, nullptr, &frame), VDNA_ERR_FORMAT);
    assert_true(embedding_of(backbone, one) == first);
    vdna_backbone_close(backbone);

    vdna_backbone *alone = opened_real(1);
    assert_true(embedding_of(alone, one) == first);
    vdna_backbone_close(alone);
}

static void cancel_ends_a_run_and_stays(void **)
{
    const Bytes rgb = noise(1, 180000);
    const vdna_image image = {rgb.data(), rgb.size(), 300, 200, 0, VDNA_PIXEL_RGB3};
    vdna_backbone *backbone = opened_real(2);
    std::atomic<bool> started{false};
    std::thread canceller([&] {
        while (!started)
            std::this_thread::yield();
        vdna_backbone_cancel(backbone);
    });

    vdna_error error = {""};
    vdna_backbone_frame frame;
    vdna_status status = VDNA_OK;
    for (int i = 0; i < 10000 && status == VDNA_OK; i++) {
        started = true;
        status = vdna_backbone_run(backbone, &image, &error, &frame);
    }
    canceller.join();
    assert_int_equal(status, VDNA_ERR_RUNTIME);
    assert_non_null(std::strstr(error.text, "cancelled"));
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), VDNA_ERR_RUNTIME);
    assert_non_null(std::strstr(error.text, "cancelled"));
    vdna_backbone_close(backbone);
}

int main()
{
    const CMUnitTest tests[] = {
        // First: it forks, and the runtime must not be loaded yet.
        cmocka_unit_test(the_runtime_writes_nothing_at_home),
        cmocka_unit_test(an_open_backbone_describes_itself),
        cmocka_unit_test(taps_have_the_layout_of_the_network),
        cmocka_unit_test(mean_and_std_are_in_the_channel_order_of_the_network),
        cmocka_unit_test(a_larger_picture_is_averaged_down),
        cmocka_unit_test(a_jpeg_is_reduced_only_if_the_manifest_says_so),
        cmocka_unit_test(l2_normalisation_concerns_the_embedding_only),
        cmocka_unit_test(a_grid_of_a_feature_map_is_the_embedding_and_the_tap_stays),
        cmocka_unit_test(a_map_may_keep_fewer_numbers_than_a_frame_has),
        cmocka_unit_test(a_network_that_gives_its_golden_numbers_is_opened),
        cmocka_unit_test(one_that_gives_others_is_refused_by_the_first_that_differs),
        cmocka_unit_test(more_golden_numbers_than_an_output_has_are_refused),
        cmocka_unit_test(a_grid_of_what_has_no_rows_and_columns_is_refused),
        cmocka_unit_test(outputs_that_are_not_finite_are_refused),
        cmocka_unit_test(a_refused_picture_leaves_the_backbone_as_it_was),
        cmocka_unit_test(a_model_other_than_the_pinned_one_is_refused),
        cmocka_unit_test(a_model_that_does_not_fit_its_manifest_is_refused),
        cmocka_unit_test(a_library_that_is_no_runtime_is_refused),
        cmocka_unit_test(arguments_are_checked),
        cmocka_unit_test(a_picture_gives_the_same_bits_whatever_came_before),
        cmocka_unit_test(cancel_ends_a_run_and_stays),
    };
    return cmocka_run_group_tests_name("backbone", tests, nullptr, nullptr);
}
