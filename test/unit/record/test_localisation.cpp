// Recall@1 on embeddings of one number.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>

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
    const Frames map("m", {0}, {INT64_MIN + 1});
    const Recording live = recording_of({0}, {INT64_MAX});
    assert_int_equal(vdna::record::localise_in(map.experience, live, 5).good(), 0);
}

void metres_go_before_places(void **)
{
    Frames map("m", {0}, {7});
    const double here[] = {0, 0, 0};
    map.experience.frame_position = here;
    Recording live = recording_of({0}, {7});
    assert_true(vdna::record::localise_in(map.experience, live, 5).unit == Unit::places);
    live.position = {3, 4, 12};
    const Localisation found = vdna::record::localise_in(map.experience, live, 5);
    assert_true(found.unit == Unit::metres);
    assert_int_equal(found.good(), 1);
    assert_int_equal(vdna::record::localise_in(map.experience, live, 4.9).good(), 0);
}

void altitude_counts_only_if_asked_for(void **)
{
    Frames map("m", {0}, {});
    const double here[] = {0, 0, 1};
    map.experience.frame_position = here;
    Recording live = recording_of({0}, {});
    live.position = {3, 4, 13};
    assert_int_equal(vdna::record::localise_in(map.experience, live, 5, 1).good(), 1);
    assert_int_equal(vdna::record::localise_in(map.experience, live, 12.9, 1, true).good(), 0);
    assert_int_equal(vdna::record::localise_in(map.experience, live, 13, 1, true).good(), 1);
}

// The Earth-centred position of a fix.
std::vector<double> ecef_of(double lat_deg, double lon_deg, double alt_m)
{
    std::vector<double> ecef(3);
    vdna_geodesy_to_ecef(lat_deg, lon_deg, alt_m, ecef.data());
    return ecef;
}

void the_altitude_of_another_day_does_not_spoil_gps(void **)
{
    Frames map("m", {0}, {});
    const std::vector<double> there = ecef_of(48.1, 11.5, 531.8);
    map.experience.frame_position = there.data();
    std::strcpy(map.experience.position_frame, VDNA_FRAME_WGS84);
    Recording live = recording_of({0}, {});
    live.position = ecef_of(48.1, 11.50001, 0); // 0.745 m east
    live.position_frame = VDNA_FRAME_WGS84;
    assert_int_equal(vdna::record::localise_in(map.experience, live, 0.75).good(), 1);
    assert_int_equal(vdna::record::localise_in(map.experience, live, 0.74).good(), 0);
}

void altitudes_on_one_side_only_are_refused_if_they_count(void **)
{
    Frames map("summer", {0}, {});
    const double here[] = {0, 0, 1};
    map.experience.frame_position = here;
    Recording live = recording_of({0}, {});
    live.position = {3, 4, 0};
    assert_int_equal(vdna::record::localise_in(map.experience, live, 5).good(), 1);
    try {
        vdna::record::localise_in(map.experience, live, 5, 1, true);
    } catch (const vdna::Error &e) {
        assert_non_null(std::strstr(
            e.what(), "the live frames have no altitudes and those of summer have some"));
        return;
    }
    fail_msg("altitudes on one side were compared");
}

void positions_of_other_frames_are_not_labelled_alike(void **)
{
    Frames map("m", {0}, {7});
    const double here[] = {0, 0, 0};
    map.experience.frame_position = here;
    std::strcpy(map.experience.position_frame, "site");
    Recording live = recording_of({0}, {});
    live.position = {0, 0, 0};
    live.position_frame = "local";
    const Localisation found = vdna::record::localise_in(map.experience, live, 5);
    assert_true(found.unit == Unit::none);
    assert_string_equal(found.difference.c_str(), "live in frame local, map in site");
    live.place = {7}; // places compare all the same
    assert_true(vdna::record::localise_in(map.experience, live, 5).unit == Unit::places);
}

void frames_without_truth_are_neither_right_nor_wrong(void **)
{
    const Frames map("m", {0, 10, 20}, {0, VDNA_PLACE_NONE, 200});
    const Recording live = recording_of({0, 10, 20, 20}, {0, 100, VDNA_PLACE_NONE, 999});
    const Localisation found = vdna::record::localise_in(map.experience, live, 5);
    assert_int_equal(found.judged(), 3);
    assert_int_equal(found.good(), 1);
    assert_int_equal(found.unreachable(), 2); // frame 1 of the map may be at 100, but nobody knows
    assert_float_equal(found.recall_percent(), 100.0 / 3, 1e-12);
    assert_false(found.matches[2].judged);
    assert_int_equal(found.matches[2].frame, 2);
}

void positions_may_be_missing_on_both_sides(void **)
{
    Frames map("m", {0, 10}, {});
    const double positions[] = {NAN, NAN, NAN, 5, 0, 0};
    map.experience.frame_position = positions;
    Recording live = recording_of({0, 10, 10}, {});
    live.position = {0, 0, 0, NAN, NAN, NAN, 5, 1, 0};
    const Localisation found = vdna::record::localise_in(map.experience, live, 2);
    assert_int_equal(found.judged(), 2);
    assert_int_equal(found.good(), 1);
    assert_int_equal(found.unreachable(), 1);
    assert_false(found.matches[0].good);
    live.position.assign(9, NAN);
    assert_true(std::isnan(vdna::record::localise_in(map.experience, live, 2).recall_percent()));
}

vdna::frames::Frame labelled(const vdna::frames::Label &label)
{
    vdna::frames::Frame frame;
    frame.name = "f";
    frame.label = label;
    return frame;
}

void a_recording_fills_the_gaps_of_its_labels(void **)
{
    const float embedding[] = {0};
    vdna_backbone_frame output{};
    output.embedding = embedding;
    output.dim = 1;
    vdna::frames::Label none, both;
    none.lacks_truth = true;
    both.place = 3;
    both.position = {{1, 2, 3}};
    both.position_frame = "site";
    Recording recording;
    for (const vdna::frames::Label &label : {none, both, none})
        recording.add(labelled(label), output);
    assert_true(recording.place == (std::vector<int64_t>{VDNA_PLACE_NONE, 3, VDNA_PLACE_NONE}));
    assert_int_equal(recording.position.size(), 9);
    assert_true(std::isnan(recording.position[2]) && std::isnan(recording.position[6]));
    assert_true(recording.position[5] == 3);
    assert_string_equal(recording.position_frame.c_str(), "site");
    assert_int_equal(recording.without_truth, 2);
    both.position_frame = "other";
    try {
        recording.add(labelled(both), output);
    } catch (const vdna::Error &e) {
        assert_string_equal(e.what(), "f: its position is in frame other, expected site as before");
        return;
    }
    fail_msg("two frames were mixed");
}

void without_common_labels_there_are_matches_only(void **)
{
    const Frames map("m", {0, 5}, {});
    const Localisation found = vdna::record::localise_in(map.experience, recording_of({4}, {1}), 5);
    assert_true(found.unit == Unit::none);
    assert_int_equal(found.matches[0].frame, 1);
    assert_string_equal(found.difference.c_str(), "the map has no ground truth");
    const Frames places("m", {0}, {1});
    Recording live = recording_of({4}, {});
    assert_string_equal(vdna::record::localise_in(places.experience, live, 5).difference.c_str(),
                        "the live frames have no ground truth");
    live.position = {1, 2, 3};
    assert_string_equal(vdna::record::localise_in(places.experience, live, 5).difference.c_str(),
                        "live with positions, map with places");
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

// A map of 20 places, and a drive through 10 of them.
struct Drive {
    static std::vector<float> looks(int first, int frames)
    {
        std::vector<float> numbers;
        for (int i = first; i < first + frames; i++)
            for (const int k : {1, 2, 3, 4})
                numbers.push_back(std::sin(0.3f * static_cast<float>(k * i)) +
                                  static_cast<float>(k));
        return numbers;
    }
    static std::vector<int64_t> places(int first, int frames)
    {
        std::vector<int64_t> numbers;
        for (int i = first; i < first + frames; i++)
            numbers.push_back(i);
        return numbers;
    }

    explicit Drive(const char *embedding)
        : map("m", looks(0, 20), places(0, 20)), live(recording_of(looks(5, 10), places(5, 10))),
          warmup(recording_of(looks(3, 2), {}))
    {
        for (Recording *recording : {&live, &warmup})
            recording->frames /= 4;
        map.experience.frames = 20;
        map.experience.identity.dim = 4;
        std::strcpy(map.experience.identity.embedding, embedding);
    }

    Frames map;
    Recording live, warmup;
};

void a_robot_follows_the_map_and_is_judged_beside_the_nearest_frame(void **)
{
    for (const char *embedding : {"", "grid 3x3 centred"}) {
        Drive drive(embedding);
        drive.live.place[9] = VDNA_PLACE_NONE;
        const vdna::record::Followed found =
            follow_in(drive.map.experience, drive.warmup, drive.live, 1, false, true);
        for (const Localisation *answers : {&found.filter, &found.nearest}) {
            assert_int_equal(answers->matches.size(), 10);
            assert_int_equal(answers->judged(), 9);
            assert_int_equal(answers->unreachable(), 0);
            assert_true(answers->unit == Unit::places);
        }
        assert_int_equal(found.distances.size(), 10 * 20);
        for (size_t i = 0; i < 10; i++) {
            const vdna::record::Match &nearest = found.nearest.matches[i];
            const float *const row = &found.distances[20 * i];
            assert_int_equal(nearest.frame, std::min_element(row, row + 20) - row);
            assert_float_equal(nearest.distance, row[nearest.frame], 1e-6);
            assert_true(found.filter.matches[i].confidence && !nearest.confidence);
        }
        assert_int_equal(found.filter.matches[8].frame, 13);
        assert_true(follow_in(drive.map.experience, drive.warmup, drive.live, 1).distances.empty());
    }
    const Drive drive("");
    const Localisation euclidean = localise_in(drive.map.experience, drive.live, 1),
                       nearest =
                           follow_in(drive.map.experience, drive.warmup, drive.live, 1).nearest;
    for (size_t i = 0; i < 10; i++)
        assert_true(nearest.matches[i].distance == euclidean.matches[i].distance);
}

void the_surest_answer_speaks_for_all(void **)
{
    const Frames map("m", {0}, {});
    const auto answers = [&](std::vector<double> confidences) {
        Localisation localisation;
        for (const double confidence : confidences) {
            vdna::record::Match match{&map.experience, 0, confidence};
            match.confidence = confidence;
            localisation.matches.push_back(match);
        }
        return localisation;
    };
    const Localisation all = vdna::record::composite_of({answers({.2, .9}), answers({.5, .8})});
    assert_true(all.matches[0].confidence == .5 && all.matches[1].confidence == .9);
    assert_float_equal(all.unsure_percent(.6), 50, 1e-9);
    assert_float_equal(all.unsure_percent(.5), 0, 1e-9); // at least that is sure
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
        cmocka_unit_test(altitude_counts_only_if_asked_for),
        cmocka_unit_test(the_altitude_of_another_day_does_not_spoil_gps),
        cmocka_unit_test(altitudes_on_one_side_only_are_refused_if_they_count),
        cmocka_unit_test(positions_of_other_frames_are_not_labelled_alike),
        cmocka_unit_test(frames_without_truth_are_neither_right_nor_wrong),
        cmocka_unit_test(positions_may_be_missing_on_both_sides),
        cmocka_unit_test(a_recording_fills_the_gaps_of_its_labels),
        cmocka_unit_test(without_common_labels_there_are_matches_only),
        cmocka_unit_test(all_together_is_the_nearest_of_each),
        cmocka_unit_test(a_robot_follows_the_map_and_is_judged_beside_the_nearest_frame),
        cmocka_unit_test(the_surest_answer_speaks_for_all),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
