#include <limits>

#include "cmocka.hpp"
#include "eval/reference_maps.hpp"

using namespace vdna;

namespace
{

// Frames with embeddings of one number.
record::Recording part_of(const std::vector<int64_t> &places, const std::vector<float> &numbers)
{
    record::Recording recording;
    recording.frames = static_cast<uint32_t>(places.size());
    recording.place = places;
    recording.embeddings = numbers;
    return recording;
}

void a_place_is_the_mean_over_the_parts_that_have_been_there(void **)
{
    const record::Recording a = part_of({0, 10}, {1, 5}), b = part_of({9, 1}, {8, 3}),
                            c = part_of({0}, {8});
    const record::Recording map = eval::fused({&a, &b, &c}, 1, 2, false);
    assert_true(map.place == std::vector<int64_t>({0, 10}));
    assert_true(map.embeddings == std::vector<float>({4, 6.5f})); // (1+3+8)/3, (5+8)/2
    assert_int_equal(map.frames, 2);
}

void of_two_frames_within_tolerance_the_nearest_counts_and_the_first_of_equals(void **)
{
    const record::Recording a = part_of({10}, {0}), b = part_of({8, 11, 9}, {100, 4, 6});
    assert_true(eval::fused({&a, &b}, 1, 2, false).embeddings == std::vector<float>({2}));
}

void a_part_has_a_frame_at_each_place_where_it_has_been(void **)
{
    const record::Recording places = part_of({10, 20}, {0, 0}),
                            part = part_of({8, 11, 9}, {1, 2, 3});
    assert_true(eval::frames_at(places, part, 2, false) == std::vector<uint32_t>({1, 3}));
}

void frames_beyond_all_places_are_places_of_their_own(void **)
{
    // 3 is farther than 2 from place 0; 2 is not.
    const record::Recording a = part_of({0}, {1}), b = part_of({2, 3, 4}, {3, 7, 9}),
                            c = part_of({3}, {1});
    const record::Recording map = eval::fused({&a, &b, &c}, 1, 2, false);
    assert_true(map.place == std::vector<int64_t>({0, 3, 4}));
    // c is within tolerance of 3 and of 4, not of 0.
    assert_true(map.embeddings == std::vector<float>({2, 4, 5}));
}

void one_part_is_its_own_fused_map_without_its_unlabelled_frames(void **)
{
    const record::Recording a = part_of({5, VDNA_PLACE_NONE, 5}, {1, 2, 3});
    const record::Recording map = eval::fused({&a}, 1, 100, false);
    assert_true(map.embeddings == std::vector<float>({1, 3}));
    const record::Recording none = part_of({VDNA_PLACE_NONE}, {1});
    assert_int_equal(eval::fused({&none}, 1, 100, false).frames, 0);
}

void parts_are_shifted_to_the_mean_of_their_means(void **)
{
    // Means 2 and 10, so 6.
    std::vector<record::Recording> parts = {part_of({0, 1}, {1, 3}), part_of({0}, {10})};
    eval::give_one_mean(parts, 1);
    assert_true(parts[0].embeddings == std::vector<float>({5, 7}));
    assert_true(parts[1].embeddings == std::vector<float>({6}));
    // Two dimensions, each with a mean of its own.
    parts = {part_of({0}, {1, 20}), part_of({0}, {3, 40})};
    eval::give_one_mean(parts, 2);
    assert_true(parts[0].embeddings == std::vector<float>({2, 30}));
    assert_true(parts[1].embeddings == parts[0].embeddings);
}

void positions_align_parts_as_well(void **)
{
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    record::Recording a = part_of({}, {1, 5}), b = part_of({}, {3, 100, 9});
    a.frames = 2, b.frames = 3;
    a.position = {0, 0, 0, 50, 0, 0};
    b.position = {0, 4, 0, unknown, unknown, unknown, 50, 6, 0};
    a.position_frame = b.position_frame = "local";
    const record::Recording map = eval::fused({&a, &b}, 1, 5, false);
    assert_true(map.embeddings == std::vector<float>({2, 5, 9}));
    assert_true(map.position == std::vector<double>({0, 0, 0, 50, 0, 0, 50, 6, 0}));
    assert_string_equal(map.position_frame.c_str(), "local");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_place_is_the_mean_over_the_parts_that_have_been_there),
        cmocka_unit_test(of_two_frames_within_tolerance_the_nearest_counts_and_the_first_of_equals),
        cmocka_unit_test(a_part_has_a_frame_at_each_place_where_it_has_been),
        cmocka_unit_test(frames_beyond_all_places_are_places_of_their_own),
        cmocka_unit_test(one_part_is_its_own_fused_map_without_its_unlabelled_frames),
        cmocka_unit_test(parts_are_shifted_to_the_mean_of_their_means),
        cmocka_unit_test(positions_align_parts_as_well),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
