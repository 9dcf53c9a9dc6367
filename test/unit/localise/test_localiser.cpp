#include <vector>

#include <vdna/cpp/localiser.hpp>

#include "cmocka.hpp"

static const std::vector<float> embeddings = {0, 0, 1, 0, 1, 1, 0, 1};

static void it_localises_and_states_its_memory(void **)
{
    const vdna::LocaliserMap map(embeddings.data(), 4, 2, "spring");
    assert_int_equal(map.frames(), 4);
    assert_int_equal(map.dim(), 2);
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    vdna::Localiser localiser(map, config, "spring");
    config.map = map.get();
    assert_true(localiser.memory_size() >= vdna_localise_mem_size(&config));
    assert_true(map.memory_size() >= 4 * 2 * sizeof(int16_t));

    vdna_localise_answer answer;
    const float live[] = {2, 2};
    assert_int_equal(vdna_localise_feed(localiser.get(), live, &answer), VDNA_OK);
    assert_int_equal(answer.frame, 2);
    const vdna::Localiser &same = localiser;
    assert_non_null(vdna_localise_distances(same.get()));
}

template <typename Make>
static void assert_error(Make make, const char *text)
{
    try {
        make();
    } catch (const vdna::Error &error) {
        assert_string_equal(error.what(), text);
        return;
    }
    fail_msg("no error, expected: %s", text);
}

static void an_error_names_the_experience_and_the_remedy(void **)
{
    assert_error([] { vdna::LocaliserMap(embeddings.data(), 0, 2, "spring.vdna"); },
                 "spring.vdna: cannot localise in 0 frames of 2 numbers: invalid argument; rebuild "
                 "the map with `vdna build`");
    const vdna::LocaliserMap map(embeddings.data(), 4, 2, "spring.vdna", false);
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    config.jump = 2;
    assert_error([&] { vdna::Localiser(map, config, "spring.vdna"); },
                 "spring.vdna: cannot localise with these settings: invalid argument; "
                 "vdna/localise.h has their ranges");
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_localises_and_states_its_memory),
        cmocka_unit_test(an_error_names_the_experience_and_the_remedy),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
