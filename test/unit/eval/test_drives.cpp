// Disturbed drives, and what they leave of a map.
#include <algorithm>
#include <map>
#include <set>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "eval/drives.hpp"
#include "eval/reference_maps.hpp"

using namespace vdna;

namespace
{

constexpr uint32_t first = 80, frames = 240; // the warmup is a third of the traversal

std::vector<eval::DriveStep> steps_of(const char *key, uint32_t seed = 1)
{
    std::mt19937 random(seed);
    return eval::drive_of(key).steps(first, frames, random);
}

uint32_t apart(uint32_t a, uint32_t b)
{
    return std::max(a, b) - std::min(a, b);
}

void a_plain_drive_has_every_frame_after_the_warmup(void **)
{
    const std::vector<eval::DriveStep> steps = steps_of("plain");
    assert_int_equal(steps.size(), frames - first);
    for (uint32_t i = 0; i < steps.size(); i++)
        assert_true(steps[i].at == first + i && steps[i].seen == first + i && !steps[i].off_route);
}

void a_varied_drive_is_slow_and_fast_stops_and_is_carried_elsewhere_once(void **)
{
    std::map<uint32_t, uint32_t> moves; // how often the robot moves so far
    uint32_t stood = 0;
    for (uint32_t seed = 1; seed <= 50; seed++) {
        const std::vector<eval::DriveStep> steps = steps_of("varied", seed);
        assert_true(steps.size() >= (frames - first) / 2);
        uint32_t carried = 0;
        for (size_t i = 0; i < steps.size(); i++) {
            assert_true(steps[i].at < frames && steps[i].seen == steps[i].at);
            if (i < 2)
                continue;
            const uint32_t moved = apart(steps[i].at, steps[i - 1].at);
            carried += moved > 2;
            assert_true(moved <= 2 || moved >= frames / 4 - 2);
            moves[moved]++;
            // The slowest drive shows a picture twice.
            stood += moved == 0 && steps[i - 2].at == steps[i].at;
        }
        assert_int_equal(carried, 1);
    }
    const uint32_t usual = moves[1];
    assert_true(moves[0] > usual / 4 && moves[2] > usual / 4 && stood > 50);
}

void in_a_replaced_drive_three_of_ten_pictures_are_from_elsewhere(void **)
{
    uint32_t replaced = 0, all = 0;
    for (uint32_t seed = 1; seed <= 50; seed++) {
        const std::vector<eval::DriveStep> steps = steps_of("replaced", seed);
        for (uint32_t i = 0; i < steps.size(); i++) {
            assert_int_equal(steps[i].at, first + i);
            if (steps[i].seen == steps[i].at)
                continue;
            assert_true(apart(steps[i].seen, steps[i].at) >= frames / 4);
            replaced++;
        }
        all += static_cast<uint32_t>(steps.size());
    }
    assert_true(replaced > 0.28 * all && replaced < 0.32 * all);
}

// Steps off the route, which must follow one another; out_begin: the first.
size_t off_route(const std::vector<eval::DriveStep> &steps, size_t &out_begin)
{
    const auto is_off = [](const eval::DriveStep &step) { return step.off_route; };
    const auto begin = std::find_if(steps.begin(), steps.end(), is_off);
    const auto end = std::find_if_not(begin, steps.end(), is_off);
    assert_true(std::none_of(end, steps.end(), is_off));
    out_begin = static_cast<size_t>(begin - steps.begin());
    return static_cast<size_t>(end - begin);
}

void a_gap_is_a_quarter_of_the_route_and_its_place_is_drawn(void **)
{
    std::set<size_t> begins;
    for (uint32_t seed = 1; seed <= 20; seed++) {
        size_t begin = 0;
        assert_int_equal(off_route(steps_of("gap", seed), begin), frames / 4);
        begins.insert(begin);
    }
    assert_true(begins.size() > 10);
}

void an_off_route_drive_leaves_halfway_and_stays_away(void **)
{
    size_t begin = 0;
    assert_int_equal(off_route(steps_of("off-route"), begin), (frames - first) / 2);
    assert_int_equal(begin, (frames - first) / 2);
}

void a_seed_gives_one_drive(void **)
{
    const auto frames_of = [](uint32_t seed) {
        std::vector<uint32_t> at;
        for (const eval::DriveStep &step : steps_of("varied", seed))
            at.push_back(step.at);
        return at;
    };
    assert_true(frames_of(3) == frames_of(3));
    assert_true(frames_of(3) != frames_of(4));
}

void the_shortest_traversal_can_be_driven(void **)
{
    for (const eval::DriveKind &kind : eval::drive_kinds)
        for (uint32_t seed = 1; seed <= 50; seed++) {
            std::mt19937 random(seed);
            assert_false(kind.steps(2, 3, random).empty());
        }
}

// Frames 0..5, in places 10..15, see 0..5. The warmup ended with frame 1.
record::Recording traversal()
{
    record::Recording recording;
    recording.frames = 6;
    recording.place = {10, 11, 12, 13, 14, 15};
    recording.embeddings = {0, 1, 2, 3, 4, 5};
    return recording;
}

// Sees frame 0 from place 12, then leaves the route.
const eval::DriveKind crafted = {"crafted", "", [](uint32_t, uint32_t, std::mt19937 &) {
                                     return std::vector<eval::DriveStep>{
                                         {2, 0, false}, {4, 4, true}, {5, 5, true}};
                                 }};

void a_drive_has_the_places_where_it_is_and_the_pictures_that_it_sees(void **)
{
    const eval::QueryResult query{0, 1, 1, {2, 3, 4, 5}, {}, {}, {}};
    const eval::DrivenQuery driven = drive_through(crafted, query, traversal(), 1, 1, 1);
    assert_true(driven.recording.place == std::vector<int64_t>({11, 12, 14, 15}));
    assert_true(driven.recording.embeddings == std::vector<float>({1, 0, 4, 5}));
    assert_true(driven.off_route == std::vector<bool>({false, false, true, true}));
    assert_true(driven.live == std::vector<uint32_t>({1, 2, 3}));
    assert_true(drive_through(crafted, query, traversal(), 1, 2, 1).live ==
                std::vector<uint32_t>({1, 3}));
}

void the_map_of_a_drive_lacks_what_is_within_tolerance_off_the_route(void **)
{
    const eval::QueryResult query{0, 1, 1, {2, 3, 4, 5}, {}, {}, {}};
    const eval::DrivenQuery driven = drive_through(crafted, query, traversal(), 1, 1, 1);
    const auto places_left = [&](double tolerance) {
        return without_off_route(traversal(), driven, 1, tolerance, false).place;
    };
    assert_true(places_left(0) == std::vector<int64_t>({10, 11, 12, 13}));
    assert_true(places_left(1) == std::vector<int64_t>({10, 11, 12}));
}

void an_unknown_drive_is_refused(void **)
{
    try {
        eval::drive_of("flight");
        fail();
    } catch (const Error &error) {
        assert_string_equal(error.what(), "'flight' is no drive");
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_drive_has_every_frame_after_the_warmup),
        cmocka_unit_test(a_varied_drive_is_slow_and_fast_stops_and_is_carried_elsewhere_once),
        cmocka_unit_test(in_a_replaced_drive_three_of_ten_pictures_are_from_elsewhere),
        cmocka_unit_test(a_gap_is_a_quarter_of_the_route_and_its_place_is_drawn),
        cmocka_unit_test(an_off_route_drive_leaves_halfway_and_stays_away),
        cmocka_unit_test(a_seed_gives_one_drive),
        cmocka_unit_test(the_shortest_traversal_can_be_driven),
        cmocka_unit_test(a_drive_has_the_places_where_it_is_and_the_pictures_that_it_sees),
        cmocka_unit_test(the_map_of_a_drive_lacks_what_is_within_tolerance_off_the_route),
        cmocka_unit_test(an_unknown_drive_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
