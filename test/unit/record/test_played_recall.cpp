// A stored run as if live, in experiences of one or two numbers for each frame.
#include <cmath>
#include <cstring>
#include <vector>

#include "cmocka.hpp"
#include "record/played_recall.hpp"

using vdna::record::played_recall;

namespace
{

// A drive past the places 0 to frames - 1.
struct Drive {
    explicit Drive(uint32_t frames) : embeddings(2 * size_t{frames}), places(frames)
    {
        for (uint32_t f = 0; f < frames; f++) {
            embeddings[2 * size_t{f}] = static_cast<float>(f);
            places[f] = f;
        }
        std::strcpy(experience.name, "drive");
        experience.frames = frames;
        experience.identity.dim = 2;
        experience.embeddings = embeddings.data();
        experience.frame_place = places.data();
    }
    Drive(const Drive &) = delete;

    std::vector<float> embeddings;
    std::vector<int64_t> places;
    vdna_experience experience{};
};

void frames_after_the_warmup_count(void **)
{
    Drive run(10), map(10);
    run.embeddings[2 * 3] = 9; // the last of the warmup
    assert_float_equal(played_recall(run.experience, map.experience, 0), 1, 0);
    run.embeddings[2 * 4] = 9; // the first after it
    assert_float_equal(played_recall(run.experience, map.experience, 0), 5.0 / 6, 1e-12);
    assert_float_equal(played_recall(run.experience, map.experience, 5), 1, 0);
}

void a_warmup_is_no_longer_than_a_hundred_frames(void **)
{
    Drive run(400), map(400);
    run.embeddings[2 * 100] = 0;
    assert_float_equal(played_recall(run.experience, map.experience, 0), 299.0 / 300, 1e-12);
}

void frames_without_a_label_are_not_judged(void **)
{
    Drive run(5), map(5);
    run.places[4] = VDNA_PLACE_NONE;
    run.places[3] = 0;
    assert_float_equal(played_recall(run.experience, map.experience, 0), 1.0 / 2, 0);
    run.experience.frame_place = nullptr;
    assert_true(std::isnan(played_recall(run.experience, map.experience, 0)));
}

void a_run_of_one_frame_has_it_judged(void **)
{
    const Drive run(1), map(3);
    assert_float_equal(played_recall(run.experience, map.experience, 0), 1, 0);
}

void positions_decide_where_both_have_them(void **)
{
    Drive run(2), map(2);
    const std::vector<double> here = {0, 0, 0, 9, 0, 0}, there = {0, 0, 0, 20, 0, 0};
    run.experience.frame_position = here.data();
    map.experience.frame_position = there.data();
    for (Drive *drive : {&run, &map})
        std::strcpy(drive->experience.position_frame, "yard");
    assert_float_equal(played_recall(run.experience, map.experience, 11), 1, 0);
    assert_float_equal(played_recall(run.experience, map.experience, 10), 1.0 / 2, 0);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(frames_after_the_warmup_count),
        cmocka_unit_test(a_warmup_is_no_longer_than_a_hundred_frames),
        cmocka_unit_test(frames_without_a_label_are_not_judged),
        cmocka_unit_test(a_run_of_one_frame_has_it_judged),
        cmocka_unit_test(positions_decide_where_both_have_them),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
