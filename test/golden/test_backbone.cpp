// Embeddings of the shipped networks, against numbers of another implementation.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <cmocka.hpp>
#include <folder.hpp>

#include <vdna/backbone.h>

#include "picture/files/file_converter.hpp"

// As explained in make_embeddings.py.
static const float tolerance = 1e-3f;
static const size_t picture_count = 4;

static const std::filesystem::path here = VDNA_GOLDEN;
static const std::filesystem::path shared = VDNA_SHARED "/models/golden";

// The numbers of a NumPy file of little-endian float32: a 10-byte preface, a header, the numbers.
static std::vector<float> numbers_of(const std::filesystem::path &file)
{
    const std::string bytes = file_bytes(file);
    assert_true(bytes.size() > 10 && bytes.compare(0, 6, "\x93NUMPY") == 0);
    const size_t begin =
        10u + static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    assert_true(begin < bytes.size());
    std::vector<float> numbers((bytes.size() - begin) / sizeof(float));
    std::memcpy(numbers.data(), bytes.data() + begin, numbers.size() * sizeof(float));
    return numbers;
}

static vdna_backbone *open_network(const char *name)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = name;
    vdna_error error;
    vdna_backbone *backbone = nullptr;
    if (vdna_backbone_open(&config, &error, &backbone) != VDNA_OK)
        fail_msg("%s", error.text);
    return backbone;
}

// Numbers that a network gives of a picture, beside those of the peer.
struct Row {
    const float *found;
    uint32_t dim;
};
using RowOf = Row (*)(const vdna_backbone_frame &frame);

static Row embedding(const vdna_backbone_frame &frame)
{
    return {frame.embedding, frame.dim};
}

static Row last_layer(const vdna_backbone_frame &frame)
{
    return {frame.last_layer, frame.last_layer_dim};
}

// The largest difference between a row of a picture file and `expected`.
static float distance(vdna_backbone *backbone, const std::filesystem::path &file, RowOf row_of,
                      const float *expected, size_t count)
{
    const std::string bytes = file_bytes(file);
    vdna::picture::FileConverter converter;
    const vdna_image image =
        converter.convert(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size());
    vdna_error error;
    vdna_backbone_frame frame;
    if (vdna_backbone_run(backbone, &image, &error, &frame) != VDNA_OK)
        fail_msg("%s: %s", file.c_str(), error.text);
    const Row row = row_of(frame);
    assert_int_equal(row.dim, count);
    float largest = 0.0f;
    for (size_t i = 0; i < count; i++)
        largest = std::fmax(largest, std::fabs(row.found[i] - expected[i]));
    return largest;
}

static void assert_reproduced(const char *name, RowOf row_of, const std::filesystem::path &numbers,
                              const std::filesystem::path &pictures)
{
    vdna_backbone *backbone = open_network(name);
    const std::vector<float> expected = numbers_of(numbers);
    const size_t dim = expected.size() / picture_count;
    for (size_t i = 0; i < picture_count; i++) {
        const std::string file = pictures.string() + std::to_string(i) + ".png";
        const float found = distance(backbone, file, row_of, &expected[i * dim], dim);
        std::printf("%s %s: differs by up to %.2g\n", name, file.c_str(),
                    static_cast<double>(found));
        if (!(found <= tolerance))
            fail_msg("%s: expected at most %g", file.c_str(), static_cast<double>(tolerance));
    }
    vdna_backbone_close(backbone);
}

static void drawn_pictures_give_the_embeddings_of_the_python_peer(void **)
{
    for (const std::string name : {"efficientnet_lite0", "mobilenet_v2"}) {
        assert_reproduced(name.c_str(), last_layer, here / (name + ".npy"), here / "picture");
        assert_reproduced(name.c_str(), embedding, here / (name + "_grid.npy"), here / "picture");
    }
}

static void real_pictures_give_the_embeddings_of_the_python_peer(void **)
{
    for (const std::string name : {"efficientnet_lite0", "mobilenet_v2"})
        assert_reproduced(name.c_str(), last_layer, shared / (name + "_embedding.npy"),
                          shared / "g");
}

// Real pictures if there is an argument: they are not part of the project.
int main(int argc, char **)
{
    const CMUnitTest drawn[] = {
        cmocka_unit_test(drawn_pictures_give_the_embeddings_of_the_python_peer),
    };
    const CMUnitTest real[] = {
        cmocka_unit_test(real_pictures_give_the_embeddings_of_the_python_peer),
    };
    if (argc == 1)
        return cmocka_run_group_tests_name("golden backbone", drawn, nullptr, nullptr);
    if (!std::filesystem::exists(shared)) {
        std::printf("skipped: no %s\n", shared.c_str());
        return 77;
    }
    return cmocka_run_group_tests_name("golden backbone, real", real, nullptr, nullptr);
}
