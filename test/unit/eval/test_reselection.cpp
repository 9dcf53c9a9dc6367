// Drives whose look changes, and what choosing again gains in them.
#include <cmath>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "eval/reselection.hpp"

using namespace vdna;

namespace
{

constexpr uint32_t dim = 24, frames = 160, warmup = 20;

// A route past places that no two embeddings share; at night everything is dim and shifted.
eval::Traversal traversal_of(const std::string &name, bool is_night, double begin)
{
    eval::Traversal traversal{name, "", {}, {}};
    traversal.recording.frames = frames;
    for (uint32_t frame = 0; frame < frames; frame++) {
        const double place = begin + frame, light = is_night ? 0.6 : 1;
        traversal.recording.place.push_back(frame);
        for (uint32_t k = 0; k < dim; k++)
            traversal.recording.embeddings.push_back(
                static_cast<float>(light * std::sin(place * (0.2 + 0.043 * k) + 1.3 * k) +
                                   (1 - light) * (k % 2 ? 2 : -1)));
    }
    return traversal;
}

struct Fixture {
    std::vector<eval::Traversal> traversals = {
        traversal_of("day", false, 0), traversal_of("night", true, 0),
        traversal_of("day2", false, 0.3), traversal_of("night2", true, 0.3)};
    eval::Evaluation evaluation;

    Fixture()
    {
        evaluation.traversals = &traversals;
        evaluation.backbone.identity.dim = dim;
        evaluation.tolerance = 2;
        evaluation.references = {0, 1, 2, 3};
        for (size_t traversal = 0; traversal < 2; traversal++) {
            eval::QueryResult query{};
            query.traversal = traversal;
            query.warmup_frames = warmup;
            evaluation.queries.push_back(query);
        }
    }

    eval::ReselectionResult drive(const std::string &name) const
    {
        return choose_again(evaluation, {name}).drives.at(0);
    }
};

// The text of the error; "" if there is none.
std::string refusal_of(const Fixture &f, const std::string &drive)
{
    try {
        f.drive(drive);
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

void a_drive_of_one_look_keeps_its_choice(void **)
{
    const Fixture f;
    const eval::ReselectionResult result = f.drive("day");
    assert_true(result.choices == std::vector<size_t>{2} && result.delays.empty());
    assert_true(result.again == 100 && result.never == 100 && result.best == 100);
}

void after_each_change_of_light_the_experience_of_that_light_is_chosen(void **)
{
    const Fixture f;
    const eval::ReselectionResult result = f.drive("day+night+day");
    assert_true((result.choices == std::vector<size_t>{2, 3, 2}));
    assert_int_equal(result.delays.size(), 2);
    assert_true(result.delays[0] < 30 && result.delays[1] < 30);
    assert_int_equal(result.changes.size(), 4);
    // A choice holds from the frame after the one that decided it.
    assert_true((result.since == std::vector<uint32_t>{0, result.changes[1] + result.delays[0] + 1,
                                                       result.changes[2] + result.delays[1] + 1}));
    assert_true(result.again >= result.never && result.best >= result.again);
}

void the_next_traversal_goes_on_where_the_one_before_was(void **)
{
    Fixture f;
    // "night" has passed the first half of the route before it begins.
    f.traversals[1] = traversal_of("night", true, 60);
    for (int64_t &place : f.traversals[1].recording.place)
        place += 60;
    assert_true(f.drive("day+night").again > 95);
}

void frames_without_ground_truth_do_not_count(void **)
{
    Fixture f;
    for (uint32_t frame = warmup; frame < frames - 1; frame++)
        f.traversals[0].recording.place[frame] = VDNA_PLACE_NONE;
    assert_true(f.drive("day").again == 100);
    f.traversals[0].recording.place[frames - 1] = VDNA_PLACE_NONE;
    assert_true(contains(refusal_of(f, "day"), "has ground truth"));
}

void means_are_over_the_drives(void **)
{
    const Fixture f;
    const eval::Reselection both = choose_again(f.evaluation, {"day", "day+night"});
    assert_int_equal(both.drives.size(), 2);
    assert_true(both.never.value == (both.drives[0].never + both.drives[1].never) / 2);
    assert_true(std::abs(both.gain.value - (both.again.value - both.never.value)) < 1e-9);
}

void a_drive_that_cannot_be_is_refused_with_the_reason(void **)
{
    Fixture f;
    assert_true(contains(refusal_of(f, "day+dawn"), "no traversal 'dawn'"));
    assert_true(contains(refusal_of(f, "day2+night"), "day2 is no query"));
    f.evaluation.references = {0};
    assert_true(contains(refusal_of(f, "day"), "part of the drive"));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_drive_of_one_look_keeps_its_choice),
        cmocka_unit_test(after_each_change_of_light_the_experience_of_that_light_is_chosen),
        cmocka_unit_test(the_next_traversal_goes_on_where_the_one_before_was),
        cmocka_unit_test(frames_without_ground_truth_do_not_count),
        cmocka_unit_test(means_are_over_the_drives),
        cmocka_unit_test(a_drive_that_cannot_be_is_refused_with_the_reason),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
