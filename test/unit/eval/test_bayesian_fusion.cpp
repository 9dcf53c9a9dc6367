#include <cmath>

#include "cmocka.hpp"
#include "eval/bayesian_fusion.hpp"
#include "eval/reference_maps.hpp"

using namespace vdna;

namespace
{

void what_is_nearer_than_usual_has_the_odds_of_a_normal_tail(void **)
{
    // Mean 4, standard deviation 2.
    const float distances[] = {6, 2, 6, 2};
    const std::vector<double> odds = eval::log_odds(distances, 4);
    assert_true(odds == std::vector<double>({0, 0.5, 0, 0.5}));
    const float alike[] = {3, 3};
    assert_true(eval::log_odds(alike, 2) == std::vector<double>({0, 0}));
}

// Frames with embeddings of two numbers, about a mean of (0, 0).
record::Recording circle(const std::vector<double> &angles)
{
    record::Recording recording;
    recording.frames = static_cast<uint32_t>(angles.size());
    for (const double angle : angles) {
        recording.embeddings.push_back(static_cast<float>(std::cos(angle)));
        recording.embeddings.push_back(static_cast<float>(std::sin(angle)));
    }
    return recording;
}

void references_that_agree_outvote_one_that_is_mistaken(void **)
{
    // Four places at the corners of a square. In the third reference those of places 1 and 2 are
    // exchanged, and a further frame is at none of them.
    const double right = M_PI / 2;
    const record::Recording live = circle({0, right, 2 * right, 3 * right, right});
    const record::Recording good = circle({0, right, 2 * right, 3 * right}),
                            bad = circle({0, 2 * right, right, 3 * right});
    const std::vector<uint32_t> asked = {4};
    const eval::Drive drive = {live, 0, 4, asked, 2, 0};
    const eval::Reference agrees = {eval::map_of(good, 2), {0, 1, 2, 3}};
    const eval::Reference mistaken = {eval::map_of(bad, 2), {0, 1, 2, 3}};
    const auto place = [&](const std::vector<eval::Reference> &references) {
        return eval::most_likely(drive, references)[0].frame;
    };
    assert_int_equal(place({mistaken}), 2);
    assert_int_equal(place({mistaken, agrees, agrees}), 1);
    // One that has not been at place 1 has no vote there.
    const eval::Reference absent = {eval::map_of(good, 2), {0, 4, 2, 3}};
    assert_int_equal(place({mistaken, absent}), 2);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_is_nearer_than_usual_has_the_odds_of_a_normal_tail),
        cmocka_unit_test(references_that_agree_outvote_one_that_is_mistaken),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
