#include <cmath>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "eval/compare_localisers.hpp"
#include "eval/methods.hpp"
#include "eval/reference_maps.hpp"

using namespace vdna;

namespace
{

// A traversal whose frames have embeddings of one number.
eval::Traversal traversal_of(const std::string &name, const std::vector<int64_t> &places,
                             const std::vector<float> &numbers)
{
    eval::Traversal traversal{name, "", {}, {}};
    traversal.recording.frames = static_cast<uint32_t>(places.size());
    traversal.recording.place = places;
    traversal.recording.embeddings = numbers;
    return traversal;
}

// Query "live" against "near" and "far"; Visual DNA chooses "far". The known recalls are 75 and 25
// percent, and 50 in all references.
struct Fixture {
    std::vector<eval::Traversal> traversals = {
        traversal_of("live", {0, 1, 2, 3, VDNA_PLACE_NONE}, {0, 0, 10, 20, 20}),
        traversal_of("near", {0, 2, 3}, {0, 10, 20}),
        traversal_of("far", {0, 2, 3}, {0, 30, 14}),
    };
    eval::Evaluation evaluation;

    Fixture()
    {
        evaluation.traversals = &traversals;
        evaluation.backbone.identity.dim = 1;
        evaluation.tolerance = 0;
        evaluation.references = {1, 2};
        evaluation.recall = {75, 25};
        eval::QueryResult query{0, 0, 2, {2, 3, 4}, {}, {}, {}};
        query.pairs.push_back({1, {}, {}});
        query.pairs.push_back({2, {}, {}});
        query.pairs[0].outcome.recall[0] = 75;
        query.pairs[1].outcome.recall[0] = 25;
        query.all.recall[0] = 50;
        evaluation.queries.push_back(query);
        evaluation.methods.push_back({"vdna", {9, 8}, {}});
    }
};

void an_answer_is_good_within_tolerance_and_a_frame_without_truth_does_not_count(void **)
{
    Fixture f;
    f.evaluation.tolerance = 1;
    const eval::DrivenQuery driven = {f.traversals[0].recording, {1, 2, 4}, std::vector<bool>(5)};
    const vdna_experience map = eval::map_of(f.traversals[1].recording, 1);
    // Places 1 and 2 are told to be at 0 and at 0.
    const eval::Judgement found = judge({{0, 0.9}, {0, 0.2}, {1, 0.5}}, driven, map, f.evaluation);
    assert_true(found.on_route == 2 && found.good == 1 && found.off_route == 0);
    assert_int_equal(found.confident.size(), 2);
    assert_true(found.confident[0].confidence == 0.9 && found.confident[0].good);
    assert_true(found.confident[1].confidence == 0.2 && !found.confident[1].good);
}

void off_the_route_only_confident_answers_count(void **)
{
    const Fixture f;
    const eval::DrivenQuery driven = {
        f.traversals[0].recording, {0, 1, 2, 3, 4}, {false, true, true, true, true}};
    const vdna_experience map = eval::map_of(f.traversals[1].recording, 1);
    const eval::Judgement found =
        judge({{0, 0.99}, {0, 0.96}, {0, 0.95}, {0, {}}, {0, 1.0}}, driven, map, f.evaluation);
    assert_true(found.on_route == 1 && found.good == 1 && found.confident.size() == 1);
    assert_true(found.off_route == 3 && found.off_route_answered == 1); // the last has no truth
}

void answers_without_confidence_are_not_judged_by_it(void **)
{
    const Fixture f;
    for (const eval::LocaliserResult &result :
         compare_localisers(f.evaluation, {"seqslam", "fused"}, eval::drive_of("off-route"))) {
        assert_false(result.mean.confidence.has_value() || result.chosen.confidence.has_value());
        assert_false(result.mean.off_route.has_value());
    }
}

void a_drive_is_scored_over_references_and_in_the_first_choice(void **)
{
    // Of the live frames 2, 3 and 4, the robot leaves the route with frame 4, which has no truth.
    Fixture f;
    f.traversals[0].recording.place[4] = 7;
    const eval::LocaliserResult result =
        compare_localisers(f.evaluation, {"filter"}, eval::drive_of("off-route"))[0];
    assert_string_equal(result.drive.c_str(), "off-route");
    assert_int_equal(result.mean.confidence->answers, 4); // frames 2 and 3 in both references
    assert_int_equal(result.chosen.confidence->answers, 2);
    assert_true(result.chosen.recall.value == result.recall[1]);
    assert_true(result.mean.off_route.has_value() && result.chosen.off_route.has_value());
}

// The sentence of the error, or "".
std::string refusal_of(const eval::Evaluation &evaluation, const std::string &key,
                       const char *drive = "plain")
{
    try {
        compare_localisers(evaluation, {key}, eval::drive_of(drive));
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

void a_drive_needs_a_map_and_labels_on_the_route(void **)
{
    Fixture f;
    f.traversals[0].recording.place[4] = 7;
    f.evaluation.tolerance = 100;
    assert_true(refusal_of(f.evaluation, "nn", "off-route")
                    .find("off-route: no frame of near is beyond the tolerance of the places of "
                          "live off the route") == 0);
    f.evaluation.tolerance = 0;
    for (size_t frame : {2, 3})
        f.traversals[0].recording.place[frame] = VDNA_PLACE_NONE;
    assert_true(refusal_of(f.evaluation, "nn", "off-route")
                    .find("off-route: no frame of live on the route has ground truth") == 0);
}

void the_most_confident_of_several_experiences_answers(void **)
{
    const std::vector<eval::Answer> best = eval::most_confident({{{1, 0.5}, {2, 0.5}, {0, {}}},
                                                                 {{3, 0.6}, {4, 0.5}, {5, 0.0}},
                                                                 {{6, 0.4}, {7, 0.9}, {8, {}}}},
                                                                {10, 20, 30});
    assert_true(best[0].frame == 13 && *best[0].confidence == 0.6);
    assert_true(best[1].frame == 37 && *best[1].confidence == 0.9);
    assert_true(best[2].frame == 15 && *best[2].confidence == 0.0);
    assert_true(eval::most_confident({{{1, 0.5}}, {{2, 0.5}}}, {10, 10})[0].frame == 1);
}

void the_best_references_are_those_nearest_by_visual_dna(void **)
{
    const Fixture f;
    const std::vector<eval::LocaliserResult> results =
        compare_localisers(f.evaluation, {"filter", "filter_top2", "filter_top3", "filter_all"});
    assert_int_equal(results.size(), 4);
    for (size_t i = 1; i < results.size(); i++) {
        assert_true(!results[i].in_each && results[i].recall == results[1].recall);
        assert_int_equal(results[i].mean.confidence->answers, 2);
        assert_true(results[i].chosen.recall.value == results[i].mean.recall.value);
    }
    assert_int_equal(results[0].mean.confidence->answers, 4);
}

void results_come_in_the_order_of_the_table_each_once(void **)
{
    const Fixture f;
    const std::vector<eval::LocaliserResult> results =
        compare_localisers(f.evaluation, {"all", "nn", "all"});
    assert_int_equal(results.size(), 2);
    assert_string_equal(results[0].name.c_str(), "nn");
    assert_string_equal(results[1].name.c_str(), "all");
}

void nearest_frames_are_those_of_the_evaluation(void **)
{
    const Fixture f;
    const std::vector<eval::LocaliserResult> results =
        compare_localisers(f.evaluation, {"nn", "all"});
    assert_true(results[0].in_each && results[0].recall == std::vector<double>({75, 25}));
    assert_true(results[0].mean.recall.value == 50);
    assert_true(results[0].chosen.recall.value == 25); // of "far", which has the lower distance
    assert_true(std::isnan(results[0].mean.recall.low));
    assert_true(!results[1].in_each && results[1].recall == std::vector<double>({50}));
    assert_true(results[1].mean.recall.value == 50 && results[1].chosen.recall.value == 50);
}

void the_fused_map_is_searched_for_the_nearest_frame(void **)
{
    // Fused: places 0, 2, 3 at 0, 20, 17. Live place 2 at 10 is nearest to 17 (wrong); live place 3
    // at 20 is nearest to 20 (wrong). With the far frames at 10 and 20 both are right.
    Fixture f;
    assert_true(compare_localisers(f.evaluation, {"fused"})[0].recall == std::vector<double>({0}));
    f.traversals[2].recording.embeddings = {0, 10, 20};
    const eval::LocaliserResult fused = compare_localisers(f.evaluation, {"fused"})[0];
    assert_true(!fused.in_each && fused.recall == std::vector<double>({100}));
}

void the_fused_map_of_a_centred_localiser_has_no_shift_between_its_parts(void **)
{
    // Place 2 is in "far" alone, whose numbers are higher by 100. Without a shift, places 0, 2, 3
    // are at 40, 50, 60, and only the last is above the mean, as are both live frames.
    Fixture f;
    f.traversals[0].recording.embeddings = {40, 40, 50, 60, 60};
    f.traversals[1] = traversal_of("near", {0, 3}, {-10, 10});
    f.traversals[2] = traversal_of("far", {0, 2, 3}, {90, 100, 110});
    const std::vector<eval::LocaliserResult> results =
        compare_localisers(f.evaluation, {"fused_centred", "fused_filter"});
    assert_true(!results[0].in_each && results[0].recall == std::vector<double>({50}));
    assert_false(results[0].mean.confidence.has_value());
    assert_true(results[1].mean.confidence.has_value());
}

void a_query_is_not_localised_in_itself(void **)
{
    Fixture f;
    f.evaluation.references = {0, 1, 2};
    f.evaluation.recall = {NAN, 75, 25};
    f.evaluation.methods[0].distance = {NAN, 9, 8};
    const eval::LocaliserResult result = compare_localisers(f.evaluation, {"seqslam"})[0];
    assert_int_equal(result.recall.size(), 3);
    assert_true(std::isnan(result.recall[0]) && !std::isnan(result.recall[1]));
    assert_true(result.mean.recall.value == (result.recall[1] + result.recall[2]) / 2);
    assert_true(result.chosen.recall.value == result.recall[2]);
}

void references_without_ground_truth_cannot_be_fused(void **)
{
    Fixture f;
    for (eval::Traversal &traversal : f.traversals)
        if (traversal.name != "live")
            traversal.recording.place.assign(3, VDNA_PLACE_NONE);
    const std::string sentence = refusal_of(f.evaluation, "fused");
    assert_true(sentence.find("no reference of live has a frame with ground truth") !=
                std::string::npos);
}

void an_unknown_localiser_is_refused(void **)
{
    const Fixture f;
    assert_string_equal(refusal_of(f.evaluation, "gps").c_str(), "'gps' is no localiser");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(
            an_answer_is_good_within_tolerance_and_a_frame_without_truth_does_not_count),
        cmocka_unit_test(off_the_route_only_confident_answers_count),
        cmocka_unit_test(a_drive_is_scored_over_references_and_in_the_first_choice),
        cmocka_unit_test(a_drive_needs_a_map_and_labels_on_the_route),
        cmocka_unit_test(the_most_confident_of_several_experiences_answers),
        cmocka_unit_test(the_best_references_are_those_nearest_by_visual_dna),
        cmocka_unit_test(answers_without_confidence_are_not_judged_by_it),
        cmocka_unit_test(results_come_in_the_order_of_the_table_each_once),
        cmocka_unit_test(nearest_frames_are_those_of_the_evaluation),
        cmocka_unit_test(the_fused_map_is_searched_for_the_nearest_frame),
        cmocka_unit_test(the_fused_map_of_a_centred_localiser_has_no_shift_between_its_parts),
        cmocka_unit_test(a_query_is_not_localised_in_itself),
        cmocka_unit_test(references_without_ground_truth_cannot_be_fused),
        cmocka_unit_test(an_unknown_localiser_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
