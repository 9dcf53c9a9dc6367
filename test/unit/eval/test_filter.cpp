// Localisers about the means: the nearest frame and the place filter.
#include <cmath>
#include <numeric>

#include "cmocka.hpp"
#include "eval/filter.hpp"
#include "eval/reference_maps.hpp"

namespace
{

namespace eval = vdna::eval;
namespace record = vdna::record;

constexpr uint32_t map_frames = 60, live_frames = 40, entry = 10, dim = 8, warmup = 5;

// What a place of the route looks like.
std::vector<float> look(uint32_t place)
{
    std::vector<float> numbers;
    for (uint32_t k = 0; k < dim; k++)
        numbers.push_back(
            std::sin(0.37f * static_cast<float>(place) * (1 + 0.3f * static_cast<float>(k)) +
                     static_cast<float>(k)));
    return numbers;
}

record::Recording drive_of(uint32_t first, uint32_t frames, float brightness)
{
    record::Recording recording;
    recording.frames = frames;
    for (uint32_t i = 0; i < frames; i++)
        for (const float number : look(first + i))
            recording.embeddings.push_back(0.8f * number + brightness);
    return recording;
}

struct Fixture {
    record::Recording map = drive_of(0, map_frames, 0), live = drive_of(entry, live_frames, 1);
    std::vector<uint32_t> asked;

    Fixture() : asked(live_frames - warmup) { std::iota(asked.begin(), asked.end(), warmup); }

    eval::Drive drive() const { return {live, 0, warmup, asked, dim, 2}; }
    // The map frame that the i-th answer should tell.
    uint32_t right(size_t i) const { return entry + asked[i]; }
};

uint32_t apart(uint32_t a, uint32_t b)
{
    return a > b ? a - b : b - a;
}

void another_brightness_hides_no_place_from_distances_about_the_means(void **)
{
    const Fixture f;
    const std::vector<eval::Answer> answers = centred(f.drive(), eval::map_of(f.map, dim));
    assert_int_equal(answers.size(), f.asked.size());
    const std::vector<eval::Answer> plain = nearest(f.drive(), eval::map_of(f.map, dim));
    size_t wrong = 0, wrong_plain = 0;
    for (size_t i = 0; i < answers.size(); i++) {
        wrong += apart(answers[i].frame, f.right(i)) > 2;
        wrong_plain += apart(plain[i].frame, f.right(i)) > 2;
        assert_false(answers[i].confidence.has_value());
    }
    // The live mean begins with the map's, so the first frames are still off.
    assert_in_range(wrong, 0, answers.size() / 5);
    assert_in_range(wrong_plain, 2 * wrong + 1, answers.size());
}

void the_filter_passes_over_a_frame_from_elsewhere(void **)
{
    Fixture f;
    const std::vector<float> elsewhere = look(2);
    for (uint32_t k = 0; k < dim; k++)
        f.live.embeddings[30 * dim + k] = 0.8f * elsewhere[k] + 1;
    const vdna_experience map = eval::map_of(f.map, dim);
    const std::vector<eval::Answer> nearest = centred(f.drive(), map);
    const std::vector<eval::Answer> filtered = filter(f.drive(), map);
    const size_t odd = 30 - warmup;
    assert_in_range(nearest[odd].frame, 0, 4);
    for (size_t i = 10; i < filtered.size(); i++) {
        assert_in_range(apart(filtered[i].frame, f.right(i)), 0, 3);
        assert_true(*filtered[i].confidence > 0 && *filtered[i].confidence < 1);
    }
    assert_true(*filtered[odd].confidence < *filtered[odd - 1].confidence);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(another_brightness_hides_no_place_from_distances_about_the_means),
        cmocka_unit_test(the_filter_passes_over_a_frame_from_elsewhere),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
