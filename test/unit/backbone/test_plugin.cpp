// The seam of lib/backbone: tables of operations, given directly or by a plug-in.
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <thread>

#include <cmocka.hpp>
#include <folder.hpp>

#include <vdna/backbone.h>

// What the made-up network below says and gives; each test breaks something of it.
struct Made {
    vdna_status open_status = VDNA_OK, run_status = VDNA_OK;
    std::string sentence;
    std::string taps = "a:2:1,b:1:2";
    std::string sha256 = std::string(64, 'a');
    std::string embedding;
    uint32_t dim = 2, tap_count = 2, input_width = 0, last_layer_dim = 0, embedding_dims = 0;
    float numbers[4] = {1, 2, 3, 4};
    vdna_activations found[2] = {{numbers, 2, 1, VDNA_LAYOUT_SAMPLES_NEURONS},
                                 {numbers + 2, 1, 2, VDNA_LAYOUT_SAMPLES_NEURONS}};
    vdna_backbone_frame frame = {found, numbers, nullptr, 2, 2, 17.0f, 1, 2, 3, 0, nullptr, {}};
    // What was done to it.
    vdna_backbone_config config{};
    int opened = 0, closed = 0, runs = 0, cancelled = 0;
    bool throws = false;
};

static Made *made;

// As at first, at the same place: it points to itself, and open networks to it.
static void make_anew()
{
    made->~Made();
    new (made) Made;
}

static void say(vdna_error *error)
{
    std::strcpy(error->text, made->sentence.c_str());
}

static vdna_status made_open(const vdna_backbone_config *config, vdna_error *error,
                             void **out_state)
{
    say(error);
    made->opened++;
    made->config = *config;
    *out_state = made;
    return made->open_status;
}

static void made_close(void *state)
{
    static_cast<Made *>(state)->closed++;
}

static void made_describe(const void *, vdna_backbone_info *out_info)
{
    vdna_identity &identity = out_info->identity;
    std::strcpy(identity.backbone, "made");
    std::strcpy(identity.model_sha256, made->sha256.c_str());
    std::strcpy(identity.preprocessing, "none");
    std::strcpy(identity.taps, made->taps.c_str());
    std::strcpy(identity.embedding, made->embedding.c_str());
    identity.neurons = 3;
    identity.dim = made->dim;
    identity.bins = 7;
    out_info->tap_count = made->tap_count;
    out_info->input_width = made->input_width;
    out_info->last_layer_dim = made->last_layer_dim;
    out_info->embedding_dims = made->embedding_dims;
    std::memset(out_info->runtime, 'r', sizeof out_info->runtime);
}

static vdna_status made_run(void *, const vdna_image *, vdna_error *error,
                            vdna_backbone_frame *out_frame)
{
    if (made->throws)
        throw std::string("no exception of the standard library");
    say(error);
    made->runs++;
    *out_frame = made->frame;
    return made->run_status;
}

static void made_cancel(void *)
{
    made->cancelled++;
}

static const vdna_backbone_operations table = {
    sizeof table, VDNA_BACKBONE_OPERATIONS, made_open, made_close, made_describe, made_run,
    made_cancel};

static const vdna_image image = {};

static vdna_status open_made(vdna_error *error, vdna_backbone **out_backbone,
                             const vdna_backbone_operations *operations = &table)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    return vdna_backbone_open_with(operations, &config, error, out_backbone);
}

static vdna_backbone *opened()
{
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    if (open_made(&error, &backbone) != VDNA_OK)
        fail_msg("%s", error.text);
    return backbone;
}

static void assert_says(const vdna_error &error, const std::string &words)
{
    if (std::string(error.text).find(words) == std::string::npos)
        fail_msg("expected: %s; found: %s", words.c_str(), error.text);
}

static int set_up(void **)
{
    made = new Made;
    return 0;
}

static int tear_down(void **)
{
    delete made;
    return 0;
}

static void a_table_is_used_as_given(void **)
{
    vdna_backbone *backbone = opened();
    assert_int_equal(made->config.threads, 2);
    assert_int_equal(made->config.struct_size, sizeof made->config);
    assert_null(made->config.manifest);

    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_string_equal(info.identity.backbone, "made");
    assert_int_equal(info.identity.bins, 0); // not known
    assert_int_equal(std::strlen(info.runtime), sizeof info.runtime - 1);

    vdna_backbone_frame frame = {};
    assert_int_equal(vdna_backbone_run(backbone, &image, nullptr, &frame), VDNA_OK);
    assert_ptr_equal(frame.embedding, made->numbers);
    assert_int_equal(frame.tap_count, 2);
    assert_int_equal(frame.inference_us, 3);
    vdna_backbone_close(backbone);
    assert_int_equal(made->closed, 1);
}

static void a_table_that_is_none_is_refused(void **)
{
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    assert_int_equal(open_made(&error, &backbone, nullptr), VDNA_ERR_ARG);
    assert_int_equal(open_made(&error, nullptr), VDNA_ERR_ARG);
    for (const uint32_t size : {uint32_t{0}, table.struct_size - 8, table.struct_size + 8}) {
        vdna_backbone_operations other = table;
        other.struct_size = size;
        assert_int_equal(open_made(&error, &backbone, &other), VDNA_ERR_UNSUPPORTED);
        assert_says(error, "has " + std::to_string(size) + " bytes, expected ");
    }
    vdna_backbone_operations old = table; // of the time before there was a version
    old.version = 0;
    assert_int_equal(open_made(&error, &backbone, &old), VDNA_ERR_UNSUPPORTED);
    assert_says(error, " bytes of version 0, expected ");
    assert_says(error, " bytes of version 3; build it with the vdna/backbone.h of this version");
    const auto refuse_without = [&](auto member, const char *name) {
        vdna_backbone_operations other = table;
        other.*member = nullptr;
        assert_int_equal(open_made(&error, &backbone, &other), VDNA_ERR_UNSUPPORTED);
        assert_says(error, std::string("has no ") + name);
    };
    refuse_without(&vdna_backbone_operations::open, "open");
    refuse_without(&vdna_backbone_operations::close, "close");
    refuse_without(&vdna_backbone_operations::describe, "describe");
    refuse_without(&vdna_backbone_operations::run, "run");
    refuse_without(&vdna_backbone_operations::cancel, "cancel");
    vdna_backbone_config config{};
    assert_int_equal(vdna_backbone_open_with(&table, &config, &error, &backbone), VDNA_ERR_ARG);
    assert_null(backbone);
    assert_int_equal(made->opened, 0);
}

static void what_open_refuses_is_handed_on(void **)
{
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    made->open_status = VDNA_ERR_CHECKSUM;
    made->sentence = "weights.bin: is not the file that was trained";
    assert_int_equal(open_made(&error, &backbone), VDNA_ERR_CHECKSUM);
    assert_string_equal(error.text, made->sentence.c_str());

    made->sentence = "";
    made->open_status = -5; // no status of ours
    assert_int_equal(open_made(&error, &backbone), VDNA_ERR_RUNTIME);
    assert_says(error, "open failed");
    assert_null(backbone);
    assert_int_equal(made->closed, 0);
}

// What is made up describes itself wrongly, in these words, and is closed again.
static void assert_not_described(const std::string &words)
{
    vdna_error error = {""};
    vdna_backbone *backbone = nullptr;
    made->closed = 0;
    assert_int_equal(open_made(&error, &backbone), VDNA_ERR_FORMAT);
    assert_null(backbone);
    assert_says(error, words);
    assert_int_equal(made->closed, 1);
    make_anew();
}

static void a_description_that_no_map_could_carry_is_refused(void **)
{
    made->sha256 = "1234";
    assert_not_described("model_sha256 is not 64 lower-case hexadecimal digits");
    made->taps = "a:2:1";
    assert_not_described("do not have the 3 neurons");
    made->tap_count = 1;
    assert_not_described("tap_count is 1, expected as many as in taps");
    made->dim = 0;
    assert_not_described("dim is 0");
    made->embedding_dims = 3;
    assert_not_described("embedding_dims is 3, expected at most dim, 2");
    made->embedding = "levels\n";
    assert_not_described("embedding has a character that is not allowed");
    made->input_width = 8;
    assert_not_described("input_height is 0");
}

// The next picture gives `status` and these words, and the frame stays as it was.
static void assert_not_run(vdna_backbone *backbone, vdna_status status, const std::string &words)
{
    vdna_error error = {""};
    vdna_backbone_frame frame = {};
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), status);
    assert_says(error, words);
    assert_null(frame.taps);
    make_anew();
}

static void a_frame_other_than_described_is_refused(void **)
{
    vdna_backbone *backbone = opened();
    made->frame.tap_count = 1;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "gave 1 taps, expected 2");
    made->frame.taps = nullptr;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "gave 0 taps, expected 2");
    made->found[1].samples = 3;
    assert_not_run(backbone, VDNA_ERR_MISMATCH,
                   "for tap 2 1 neurons with 3 samples, expected 1 neurons with 2 samples");
    made->found[0].neurons = 1;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "for tap 1 1 neurons");
    made->found[0].values = nullptr;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "a tap without values");
    made->found[0].layout = 2;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "of no layout");
    made->frame.dim = 1;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "an embedding of 1 numbers, expected 2");
    made->frame.embedding = nullptr;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "an embedding of 0 numbers");
    made->frame.input = made->numbers;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "gave an input, expected none");
    made->frame.grey = 256.0f;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "the grey level 256");
    made->numbers[3] = std::numeric_limits<float>::quiet_NaN();
    made->frame.embedding = made->numbers;
    assert_not_run(backbone, VDNA_ERR_NONFINITE, "backbone made: gave a NaN or an infinity");
    vdna_backbone_close(backbone);
}

static void a_plugin_may_give_a_second_embedding(void **)
{
    made->embedding = "levels centred";
    made->last_layer_dim = made->frame.last_layer_dim = 3;
    made->frame.last_layer = made->numbers;
    vdna_backbone *backbone = opened();
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_string_equal(info.identity.embedding, "levels centred");
    assert_int_equal(info.last_layer_dim, 3);
    vdna_backbone_frame frame = {};
    assert_int_equal(vdna_backbone_run(backbone, &image, nullptr, &frame), VDNA_OK);
    assert_ptr_equal(frame.last_layer, made->numbers);

    // make_anew() takes it away again.
    made->frame.last_layer = nullptr;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "gave a last layer of 0 numbers, expected 3");
    made->frame.last_layer = made->numbers;
    made->frame.last_layer_dim = 2;
    assert_not_run(backbone, VDNA_ERR_MISMATCH, "gave a last layer of 2 numbers, expected 3");
    const float infinite[] = {1, 2, std::numeric_limits<float>::infinity()};
    made->frame.last_layer = infinite;
    made->frame.last_layer_dim = 3;
    assert_not_run(backbone, VDNA_ERR_NONFINITE, "backbone made: gave a NaN or an infinity");
    vdna_backbone_close(backbone);
}

static void what_run_refuses_is_handed_on(void **)
{
    vdna_backbone *backbone = opened();
    made->run_status = VDNA_ERR_FORMAT;
    made->sentence = "the picture is cut";
    assert_not_run(backbone, VDNA_ERR_FORMAT, "the picture is cut");
    made->run_status = VDNA_STATUS_COUNT;
    assert_not_run(backbone, VDNA_ERR_RUNTIME, "made: run failed");
    made->throws = true;
    assert_not_run(backbone, VDNA_ERR_RUNTIME, "unknown exception");
    vdna_backbone_frame frame;
    assert_int_equal(vdna_backbone_run(backbone, &image, nullptr, &frame), VDNA_OK);
    vdna_backbone_close(backbone);
}

static void no_run_follows_a_cancel(void **)
{
    vdna_backbone *backbone = opened();
    std::thread([&] { vdna_backbone_cancel(backbone); }).join();
    assert_int_equal(made->cancelled, 1);
    vdna_error error = {""};
    vdna_backbone_frame frame;
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), VDNA_ERR_RUNTIME);
    assert_says(error, "cancelled");
    assert_int_equal(made->runs, 0);
    vdna_backbone_close(backbone);
}

static vdna_status open_path(const std::string &path, vdna_error *error,
                             vdna_backbone **out_backbone)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = path.c_str();
    return vdna_backbone_open(&config, error, out_backbone);
}

static void assert_path_refused(const std::string &path, vdna_status status,
                                const std::string &words)
{
    vdna_error error = {""};
    vdna_backbone *backbone = nullptr;
    assert_int_equal(open_path(path, &error, &backbone), status);
    assert_null(backbone);
    assert_says(error, words);
}

static void a_path_to_a_shared_library_loads_a_plugin(void **)
{
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    if (open_path(VDNA_STUB_BACKBONE, &error, &backbone) != VDNA_OK)
        fail_msg("%s", error.text);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    assert_string_equal(info.identity.taps, "mid:2:4,top:1:1");
    vdna_backbone_frame frame;
    assert_int_equal(vdna_backbone_run(backbone, &image, &error, &frame), VDNA_OK);
    assert_int_equal(frame.taps[0].samples, 4);
    vdna_backbone_close(backbone);
}

static void a_file_that_is_no_plugin_is_refused(void **)
{
    const Folder folder;
    const std::string text = folder.write("text.so", "no library");
    assert_path_refused(text, VDNA_ERR_IO, "text.so: the plug-in cannot be loaded: ");
    assert_path_refused("/nowhere/mine.so", VDNA_ERR_IO, "No such file");
    assert_path_refused("mine.so", VDNA_ERR_ARG, "is given by a path with a '/': ./mine.so");
    assert_path_refused(VDNA_NO_PLUGIN, VDNA_ERR_UNSUPPORTED,
                        "does not export vdna_backbone_plugin()");
    assert_path_refused(VDNA_SMALL_PLUGIN, VDNA_ERR_UNSUPPORTED, "small_plugin.so: the table");
    assert_path_refused(VDNA_NULL_PLUGIN, VDNA_ERR_UNSUPPORTED, "there is no table of operations");
}

int main()
{
#define WITH_MADE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const CMUnitTest tests[] = {
        WITH_MADE(a_table_is_used_as_given),
        WITH_MADE(a_table_that_is_none_is_refused),
        WITH_MADE(what_open_refuses_is_handed_on),
        WITH_MADE(a_description_that_no_map_could_carry_is_refused),
        WITH_MADE(a_frame_other_than_described_is_refused),
        WITH_MADE(a_plugin_may_give_a_second_embedding),
        WITH_MADE(what_run_refuses_is_handed_on),
        WITH_MADE(no_run_follows_a_cancel),
        cmocka_unit_test(a_path_to_a_shared_library_loads_a_plugin),
        cmocka_unit_test(a_file_that_is_no_plugin_is_refused),
    };
    return cmocka_run_group_tests_name("plugin", tests, nullptr, nullptr);
}
