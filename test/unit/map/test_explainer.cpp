// Reasons by name of the tap.
#include <cmath>
#include <cstring>
#include <vector>

#include <vdna/cpp/explainer.hpp>

#include "cmocka.hpp"

namespace
{

constexpr float range[][2] = {{0, 1}, {0, 1}, {0, 1}};
constexpr uint32_t mass[] = {2, 2, 2};
constexpr int8_t codes[][3] = {{0, 5, 1}, {0, 9, 0}};
constexpr float scale[] = {1, 1};

// Of taps "mid" and "top", or of "top" alone, which is the network's last layer.
vdna_experience experience_of(const char *name, const uint32_t (*counts)[3], const char *taps)
{
    vdna_experience experience{};
    std::strcpy(experience.name, name);
    std::strcpy(experience.identity.taps, taps);
    std::strcpy(experience.identity.embedding, "mid last=top");
    experience.identity.neurons = 3;
    experience.identity.bins = 4;
    experience.identity.range = range[0];
    experience.frames = 2;
    experience.counts = counts[0];
    experience.mass = mass;
    experience.last_layer = codes[0];
    experience.last_layer_scale = scale;
    experience.last_layer_dim = 3;
    return experience;
}

constexpr uint32_t live[][3] = {{2, 2, 0}, {0, 0, 2}, {0, 0, 0}, {0, 0, 0}};
constexpr uint32_t near[][3] = {{2, 0, 0}, {0, 2, 2}, {0, 0, 0}, {0, 0, 0}};
constexpr uint32_t far[][3] = {{0, 2, 2}, {0, 0, 0}, {0, 0, 0}, {2, 0, 0}};

vdna_status explain(vdna::Explainer &explainer, const vdna_experience &winner,
                    const vdna_experience &against)
{
    const vdna_hist_view view = {range[0], live[0], mass, 3, 4};
    return explainer.explain(view, winner, against);
}

void reasons_name_the_tap_and_the_index_in_it(void **)
{
    const vdna_experience winner = experience_of("near", near, "mid:1:1,top:2:1");
    const vdna_experience against = experience_of("far", far, "mid:1:1,top:2:1");
    vdna::Explainer explainer(winner.identity, 2);
    assert_int_equal(explain(explainer, winner, against), VDNA_OK);
    assert_int_equal(explainer.reasons().size(), 2);
    const vdna::Reason &first = explainer.reasons()[0], &second = explainer.reasons()[1];
    assert_int_equal(first.tap, 0);
    assert_int_equal(first.index, 0);
    assert_true(first.part.margin_bins == 1 && first.live_bin == 0 && first.against_bin == 3);
    assert_string_equal(explainer.taps()[second.tap].name.c_str(), "top");
    assert_int_equal(second.index, 0);
    assert_true(std::fabs(second.part.margin_bins + 1.0 / 3) < 1e-12 && second.winner_bin == 1);
    // Codes of one tap do not stand for two.
    assert_int_equal(first.of_winner.most, -1);
    assert_int_equal(first.of_against.least, -1);
}

void taps_and_all_neurons_sum_to_the_margin(void **)
{
    const vdna_experience winner = experience_of("near", near, "mid:1:1,top:2:1");
    const vdna_experience against = experience_of("far", far, "mid:1:1,top:2:1");
    vdna::Explainer explainer(winner.identity, 9); // more than there are
    assert_int_equal(explain(explainer, winner, against), VDNA_OK);
    assert_int_equal(explainer.reasons().size(), 3);
    double reasons = 0, taps = 0;
    for (const vdna::Reason &reason : explainer.reasons())
        reasons += reason.part.margin_bins;
    for (const vdna::Tap &tap : explainer.taps())
        taps += explainer.of_tap(tap).margin_bins;
    assert_true(std::fabs(explainer.whole().margin_bins - 1) < 1e-12);
    assert_true(std::fabs(reasons - 1) < 1e-12 && std::fabs(taps - 1) < 1e-12);
    assert_int_equal(explainer.whole().count, 3);
}

void the_last_layer_as_the_only_tap_gives_example_frames(void **)
{
    const vdna_experience winner = experience_of("near", near, "top:3:1");
    const vdna_experience against = experience_of("far", far, "top:3:1");
    vdna::Explainer explainer(winner.identity, 2);
    assert_int_equal(explain(explainer, winner, against), VDNA_OK);
    assert_int_equal(explainer.reasons()[1].index, 1);
    assert_int_equal(explainer.reasons()[1].of_winner.most, 1);
    assert_int_equal(explainer.reasons()[1].of_winner.least, 0);
}

void distances_alone_give_no_mean_bins_and_no_frames(void **)
{
    const vdna_experience any = experience_of("near", near, "top:3:1");
    vdna::Explainer explainer(any.identity, 1);
    assert_int_equal(explainer.explain({0, 1, 0}, {3, 0, 1}), VDNA_OK);
    assert_true(explainer.reasons()[0].part.margin_bins == 1);
    assert_true(std::isnan(explainer.reasons()[0].live_bin));
    assert_int_equal(explainer.reasons()[0].of_winner.most, -1);
    assert_int_equal(explainer.explain({0, NAN, 0}, {3, 0, 1}), VDNA_ERR_NONFINITE);
}

void what_does_not_compare_is_not_explained(void **)
{
    const vdna_experience winner = experience_of("near", near, "top:3:1");
    vdna_experience shorter = experience_of("far", far, "top:3:1");
    shorter.identity.bins = 3;
    vdna::Explainer explainer(winner.identity, 1);
    assert_int_equal(explain(explainer, winner, shorter), VDNA_ERR_MISMATCH);
    assert_int_equal(explain(explainer, shorter, winner), VDNA_ERR_MISMATCH);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(reasons_name_the_tap_and_the_index_in_it),
        cmocka_unit_test(taps_and_all_neurons_sum_to_the_margin),
        cmocka_unit_test(the_last_layer_as_the_only_tap_gives_example_frames),
        cmocka_unit_test(distances_alone_give_no_mean_bins_and_no_frames),
        cmocka_unit_test(what_does_not_compare_is_not_explained),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
