#include <cmath>

#include "cmocka.hpp"
#include "eval/reference_maps.hpp"
#include "eval/seqslam.hpp"

using namespace vdna;

namespace
{

// Frames with embeddings of one number.
record::Recording frames_of(const std::vector<float> &numbers)
{
    record::Recording recording;
    recording.frames = static_cast<uint32_t>(numbers.size());
    recording.embeddings = numbers;
    return recording;
}

std::vector<uint32_t> answers_of(const record::Recording &live, uint32_t begin,
                                 const std::vector<uint32_t> &asked, const record::Recording &map)
{
    std::vector<uint32_t> frames;
    for (const eval::Answer &answer :
         eval::seqslam({live, begin, asked.front() - begin, asked, 1}, eval::map_of(map, 1)))
        frames.push_back(answer.frame);
    return frames;
}

void a_distance_is_compared_with_those_around_it(void **)
{
    // Twelve distances: the window of the first is the first six, 0 0 0 0 0 6.
    const std::vector<double> contrast = eval::local_contrast({0, 0, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0});
    assert_true(std::fabs(contrast[0] - -1 / std::sqrt(5)) < 1e-12);
    // All eleven from 0 to 10: mean 6/11, variance 36 * 10 / 121.
    assert_true(std::fabs(contrast[5] - std::sqrt(10)) < 1e-12);
    // Its window begins after the 6.
    assert_true(contrast[11] == 0);
}

void equal_distances_have_no_contrast(void **)
{
    for (const double contrast : eval::local_contrast(std::vector<double>(7, 0.1)))
        assert_true(contrast == 0);
    assert_true(eval::local_contrast({0.1})[0] == 0);
}

void the_best_line_may_have_any_of_five_velocities(void **)
{
    // A valley that ends at map frame 14 and moves by 8 to 12 tenths of a frame.
    for (const uint32_t tenths : eval::seqslam_velocity_tenths) {
        std::vector<std::vector<double>> rows(10, std::vector<double>(20, 1));
        for (uint32_t back = 0; back < 10; back++)
            rows[back][14 - (tenths * back + 5) / 10] = -1;
        assert_int_equal(eval::best_line_end(rows), 14);
    }
}

void a_line_that_begins_before_the_map_waits_at_its_first_frame(void **)
{
    std::vector<std::vector<double>> rows(3, std::vector<double>(4, 1));
    rows[0][1] = rows[1][0] = rows[2][0] = -1;
    assert_int_equal(eval::best_line_end(rows), 1);
}

void of_equal_lines_the_lowest_end_is_taken(void **)
{
    assert_int_equal(eval::best_line_end({{1, 0, 0, 1}}), 1);
}

void a_frame_that_looks_like_elsewhere_is_placed_by_those_before_it(void **)
{
    // Random heights, and the live drive passes them at the map's speed; frame 11 shows place 3.
    const std::vector<float> heights = {5, 1, 9, 40, 7, 2, 8, 0, 6, 4, 3, 9, 1, 8, 2, 7};
    const record::Recording map = frames_of(heights);
    record::Recording live = frames_of({heights.begin(), heights.begin() + 14});
    live.embeddings[11] = heights[3];
    assert_true(answers_of(live, 0, {10, 11, 12}, map) == std::vector<uint32_t>({10, 11, 12}));
}

void frames_before_the_warmup_do_not_count(void **)
{
    // Only frame 3 belongs to the drive: alone, it is nearest to map frame 0.
    const record::Recording map = frames_of({1, 7, 3, 9, 5}), live = frames_of({1, 7, 3, 1});
    assert_true(answers_of(live, 3, {3}, map) == std::vector<uint32_t>({0}));
}

void a_map_of_one_frame_is_always_the_answer(void **)
{
    const record::Recording map = frames_of({4}), live = frames_of({1, 2, 3});
    assert_true(answers_of(live, 0, {1, 2}, map) == std::vector<uint32_t>({0, 0}));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_distance_is_compared_with_those_around_it),
        cmocka_unit_test(equal_distances_have_no_contrast),
        cmocka_unit_test(the_best_line_may_have_any_of_five_velocities),
        cmocka_unit_test(a_line_that_begins_before_the_map_waits_at_its_first_frame),
        cmocka_unit_test(of_equal_lines_the_lowest_end_is_taken),
        cmocka_unit_test(a_frame_that_looks_like_elsewhere_is_placed_by_those_before_it),
        cmocka_unit_test(frames_before_the_warmup_do_not_count),
        cmocka_unit_test(a_map_of_one_frame_is_always_the_answer),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
