// Recall@1 on embeddings of one number.
#include <cstring>

#include "cmocka.hpp"
#include "record/localisation.hpp"

using vdna::record::Localisation;
using vdna::record::Recording;
using vdna::record::Unit;

namespace
{

// An experience whose frames have these embeddings and these places.
struct Frames {
    Frames(const char *name, std::vector<float> embeddings_, std::vector<int64_t> places_)
        : embeddings(std::move(embeddings_)), places(std::move(places_))
    {
        std::strncpy(experience.name, name, sizeof experience.name - 1);
        experience.frames = static_cast<uint32_t>(embeddings.size());
        experience.identity.dim = 1;
        experience.embeddings = embeddings.data();
        experience.frame_place = places.empty() ? nullptr : places.data();
    }
    std::vector<float> embeddings;
    std::vector<int64_t> places;
    vdna_experience experience{};
};

Recording recording_of(std::vector<float> embeddings, std::vector<int64_t> places)
{
    Recording live;
    live.frames = static_cast<uint32_t>(embeddings.size());
    live.embeddings = std::move(embeddings);
    live.place = std::move(places);
    return live;
}

void a_match_within_tolerance_is_good(void **)
{
    const Frames map("m", {0, 10, 20}, {0, 100, 200});
    const Recording live = recording_of({1, 12, 19}, {5, 94, 206});
    const Localisation found = vdna::record::localise_in(map.experience, live, 5);
    assert_int_equal(found.matches[1].frame, 1);
    assert_float_equal(found.matches[1].distance, 2, 1e-12);
    assert_true(found.matches[0].good);  // exactly at the tolerance
    assert_false(found.matches[1].good); // one beyond it
    assert_int_equal(found.good(), 1);
    assert_float_equal(found.recall_percent(), 100.0 / 3, 1e-12);
}

void a_place_that_the_map_never_saw_is_a_failure_and_told_apart(void **)
{
    const Frames map("m", {0, 10}, {0, 100});
    const Recording live = recording_of({10, 0}, {0, 500});
    const Localisation found = vdna::record::localise_in(map.experience, live, 5);
    assert_int_equal(found.good(), 0);
    assert_true(found.matches[0].reachable);
    assert_int_equal(found.unreachable(), 1);
}

void equal_distances_take_the_lowest_index(void **)
{
    const Frames map("m", {2, 0, 2}, {0, 1, 2});
    const Recording live = recording_of({1}, {0});
    assert_int_equal(vdna::record::localise_in(map.experience, live, 0).matches[0].frame, 0);
}

void places_at_the_ends_of_their_range_do_not_wrap(void **)
{
    const Frames map("m", {0}, {INT64_MIN});
    const Recording live = recording_of({0}, {INT64_MAX});
    assert_int_equal(vdna::record::localise_in(map.experience, live, 5).good(), 0);
}

void metres_go_before_places(void **)
{
    Frames map("m", {0}, {7});
    const double here[] = {0, 0, 0};
    map.experience.frame_position = here;
    Recording live = recording_of({0}, {7});
    assert_true(vdna::record::common_unit(live, map.experience) == Unit::places);
    live.position = {2, 3, 6};
    const Localisation found = vdna::record::localise_in(map.experience, live, 7);
    assert_true(found.unit == Unit::metres);
    assert_int_equal(found.good(), 1);
    assert_int_equal(vdna::record::localise_in(map.experience, live, 6.9).good(), 0);
}

void without_common_labels_there_are_matches_only(void **)
{
    const Frames map("m", {0, 5}, {});
    const Localisation found = vdna::record::localise_in(map.experience, recording_of({4}, {1}), 5);
    assert_true(found.unit == Unit::none);
    assert_int_equal(found.matches[0].frame, 1);
}

void all_together_is_the_nearest_of_each(void **)
{
    const Frames a("a", {0, 10}, {0, 100}), b("b", {1, 10, 30}, {0, 900, 300});
    const Recording live = recording_of({1, 10, 30}, {0, 100, 300});
    const Localisation all =
        vdna::record::composite_of({vdna::record::localise_in(a.experience, live, 5),
                                    vdna::record::localise_in(b.experience, live, 5)});
    assert_string_equal(all.matches[0].experience->name, "b");
    assert_string_equal(all.matches[1].experience->name, "a"); // a tie
    assert_int_equal(all.matches[2].frame, 2);
    assert_int_equal(all.good(), 3);
    assert_int_equal(all.unreachable(), 0);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_match_within_tolerance_is_good),
        cmocka_unit_test(a_place_that_the_map_never_saw_is_a_failure_and_told_apart),
        cmocka_unit_test(equal_distances_take_the_lowest_index),
        cmocka_unit_test(places_at_the_ends_of_their_range_do_not_wrap),
        cmocka_unit_test(metres_go_before_places),
        cmocka_unit_test(without_common_labels_there_are_matches_only),
        cmocka_unit_test(all_together_is_the_nearest_of_each),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
