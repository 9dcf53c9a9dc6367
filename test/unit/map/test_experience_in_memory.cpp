// The C++ face of experiences in memory.
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <unistd.h>

#include <vdna/cpp/experience.hpp>

#include "cmocka.hpp"

namespace
{

// A file of one frame, of one neuron in two bins, in whole words.
std::vector<int64_t> file_of_one_frame(size_t &size)
{
    const std::array<float, 2> range{0, 1};
    const std::array<uint32_t, 2> counts{0, 1};
    const uint32_t mass = 1;
    const int64_t utime = 5;
    const float number = 0.5F;
    vdna_experience e{};
    std::strcpy(e.name, "winter");
    std::strcpy(e.identity.backbone, "tiny");
    std::memset(e.identity.model_sha256, 'a', VDNA_SHA256_SIZE - 1);
    std::strcpy(e.identity.preprocessing, "grey");
    std::strcpy(e.identity.taps, "mid:1:1");
    e.identity.neurons = e.identity.dim = 1;
    e.identity.bins = 2;
    e.identity.range = range.data();
    e.frames = 1;
    e.counts = counts.data();
    e.mass = &mass;
    e.embeddings = e.frame_grey = &number;
    e.frame_utime = &utime;
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       ("vdna-in-memory-" + std::to_string(::getpid()) + ".vdna");
    assert_int_equal(vdna_experience_write(&e, path.c_str(), nullptr), VDNA_OK);
    size = std::filesystem::file_size(path);
    std::vector<int64_t> words(size / sizeof(int64_t) + 1);
    std::ifstream(path, std::ios::binary)
        .read(reinterpret_cast<char *>(words.data()), static_cast<std::streamsize>(size));
    std::filesystem::remove(path);
    return words;
}

void an_experience_in_memory_opens_and_damage_throws(void **)
{
    size_t size = 0;
    std::vector<int64_t> words = file_of_one_frame(size);
    {
        const vdna::Experience opened = vdna::Experience::of_memory(words.data(), size);
        assert_string_equal(opened->name, "winter");
        assert_int_equal(opened->counts[1], 1);
        assert_true(opened.path().empty());
    }
    words[words.size() / 2] ^= 1;
    bool refused = false;
    try {
        vdna::Experience::of_memory(words.data(), size);
    } catch (const vdna::Error &) {
        refused = true;
    }
    assert_true(refused);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(an_experience_in_memory_opens_and_damage_throws)};
    return cmocka_run_group_tests_name("experience_in_memory", tests, nullptr, nullptr);
}
