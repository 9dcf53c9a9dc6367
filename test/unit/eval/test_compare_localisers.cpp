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
    const record::Recording &live = f.traversals[0].recording;
    const std::vector<uint32_t> frames = {1, 2, 4};
    const eval::Drive drive = {live, 0, 1, frames, 1};
    const vdna_experience map = eval::map_of(f.traversals[1].recording, 1);
    f.evaluation.tolerance = 1;
    std::vector<eval::JudgedAnswer> judged;
    // Places 1 and 2 are told to be at 0 and at 0.
    assert_true(recall_of({{0, 0.9}, {0, 0.2}, {1, 0.5}}, drive, map, f.evaluation, judged) == 50);
    assert_int_equal(judged.size(), 2);
    assert_true(judged[0].confidence == 0.9 && judged[0].good);
    assert_true(judged[1].confidence == 0.2 && !judged[1].good);
}

void answers_without_confidence_are_not_judged_by_it(void **)
{
    const Fixture f;
    const std::vector<uint32_t> frames = {0};
    const eval::Drive drive = {f.traversals[0].recording, 0, 0, frames, 1};
    const vdna_experience map = eval::map_of(f.traversals[1].recording, 1);
    std::vector<eval::JudgedAnswer> judged;
    assert_true(recall_of({{0, {}}}, drive, map, f.evaluation, judged) == 100);
    assert_true(judged.empty());
    for (const eval::LocaliserResult &result :
         compare_localisers(f.evaluation, {"seqslam", "fused"}))
        assert_false(result.confidence.has_value());
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
    assert_true(results[0].mean.value == 50);
    assert_true(results[0].chosen.value == 25); // of "far", which has the lower distance
    assert_true(std::isnan(results[0].mean.low));
    assert_true(!results[1].in_each && results[1].recall == std::vector<double>({50}));
    assert_true(results[1].mean.value == 50 && results[1].chosen.value == 50);
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

void a_query_is_not_localised_in_itself(void **)
{
    Fixture f;
    f.evaluation.references = {0, 1, 2};
    f.evaluation.recall = {NAN, 75, 25};
    f.evaluation.methods[0].distance = {NAN, 9, 8};
    const eval::LocaliserResult result = compare_localisers(f.evaluation, {"seqslam"})[0];
    assert_int_equal(result.recall.size(), 3);
    assert_true(std::isnan(result.recall[0]) && !std::isnan(result.recall[1]));
    assert_true(result.mean.value == (result.recall[1] + result.recall[2]) / 2);
    assert_true(result.chosen.value == result.recall[2]);
}

// The sentence of the error, or "".
std::string refusal_of(const eval::Evaluation &evaluation, const std::string &key)
{
    try {
        compare_localisers(evaluation, {key});
    } catch (const Error &error) {
        return error.what();
    }
    return "";
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
        cmocka_unit_test(answers_without_confidence_are_not_judged_by_it),
        cmocka_unit_test(results_come_in_the_order_of_the_table_each_once),
        cmocka_unit_test(nearest_frames_are_those_of_the_evaluation),
        cmocka_unit_test(the_fused_map_is_searched_for_the_nearest_frame),
        cmocka_unit_test(a_query_is_not_localised_in_itself),
        cmocka_unit_test(references_without_ground_truth_cannot_be_fused),
        cmocka_unit_test(an_unknown_localiser_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
