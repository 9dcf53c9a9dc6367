// What people are told about a choice.
#include <cmath>
#include <string>

#include "cmocka.hpp"
#include "program/choice_sentence.hpp"

namespace
{

using vdna::program::Choice;

const Choice sure{"winter", "", 4, 31, 100, "", -0.2, 0.934, 0.85, 0.972, "", 0.4};

void expect(const Choice &choice, const char *sentence)
{
    assert_string_equal(vdna::program::sentence_of(choice).data(), sentence);
}

void a_choice_says_after_how_many_frames_and_how_sure(void **)
{
    expect(sure,
           "selected winter of 4 after 31 of 100 frames: expects 93 % (85 to 97) of frames right");
    Choice whole = sure;
    whole.frames = 100;
    expect(whole, "selected winter of 4 after 100 frames: expects 93 % (85 to 97) of frames right");
    whole.frames = 1;
    whole.warmup_frames = 0;
    expect(whole, "selected winter of 4 after 1 frame: expects 93 % (85 to 97) of frames right");
}

void a_map_whose_distances_say_nothing_is_told(void **)
{
    Choice choice = sure;
    choice.skill = -0.125;
    expect(choice,
           "selected winter of 4 after 31 of 100 frames: expects 93 % (85 to 97) of frames right; "
           "in this map distances say nothing about that (skill -0.12)");
    choice.skill = NAN;
    expect(choice,
           "selected winter of 4 after 31 of 100 frames: expects 93 % (85 to 97) of frames right");
}

void a_choice_without_prediction_says_why(void **)
{
    Choice choice = sure;
    choice.predicted_recall = choice.predicted_low = choice.predicted_high = NAN;
    choice.no_prediction = "3 labelled experiences are needed, 2 of 4 are";
    expect(choice, "selected winter of 4 after 31 of 100 frames; no prediction: 3 labelled "
                   "experiences are needed, 2 of 4 are");
    choice.no_prediction = "";
    expect(choice, "selected winter of 4 after 31 of 100 frames");
}

void a_run_unlike_all_is_told_what_would_help(void **)
{
    Choice choice = sure;
    choice.verdict = "unlike";
    choice.unlike = std::log(1.4);
    expect(choice, "none of 4 experiences looks like this run: the nearest is 1.40 times as far "
                   "from it as the loneliest of them is from the others; record one now with "
                   "`vdna build`");
    choice.unlike = NAN;
    expect(choice, "none of 4 experiences looks like this run; record one now with `vdna build`");
}

void frames_that_show_nothing_are_told_to_look_at_the_camera(void **)
{
    Choice choice = sure;
    choice.verdict = "blank";
    choice.unlike = std::log(0.9);
    expect(choice, "the frames hardly differ and look like none of 4 experiences: see whether the "
                   "lens is covered, or the camera broken");
}

void too_poor_a_choice_is_told_what_would_help(void **)
{
    Choice choice = sure;
    choice.verdict = "poor";
    expect(choice, "none of 4 experiences is good enough: the best, winter, expects 93 % "
                   "(85 to 97) of frames right; record one now with `vdna build`");
}

void another_choice_while_driving_says_what_it_replaces(void **)
{
    Choice choice = sure;
    choice.previous = "summer";
    choice.predicted_recall = NAN;
    expect(choice, "selected winter of 4 in place of summer, which the newest frames suit less");
}

void a_margin_says_how_much_of_it_the_named_neurons_make(void **)
{
    const auto expect_share = [](const vdna::program::MarginShare &share, const char *sentence) {
        assert_string_equal(vdna::program::sentence_of(share).data(), sentence);
    };
    expect_share({"winter", "night", 1.834, 0.567, 10, 1280},
                 "winter is 1.83 bins nearer than night: 10 of 1280 neurons make 31 % of it");
    expect_share({"winter", "night", -0.5, 0.25, 1, 2},
                 "winter is 0.50 bins farther than night: 1 of 2 neurons make -50 % of it");
    expect_share({"winter", "night", 0, 0.25, 1, 2}, "winter is as near as night");
}

void a_long_reason_is_cut(void **)
{
    const std::string reason(5000, 'x');
    Choice choice = sure;
    choice.no_prediction = reason.c_str();
    const auto sentence = vdna::program::sentence_of(choice);
    assert_int_equal(std::string(sentence.data()).size(), sentence.size() - 1);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_choice_says_after_how_many_frames_and_how_sure),
        cmocka_unit_test(a_map_whose_distances_say_nothing_is_told),
        cmocka_unit_test(a_choice_without_prediction_says_why),
        cmocka_unit_test(a_run_unlike_all_is_told_what_would_help),
        cmocka_unit_test(frames_that_show_nothing_are_told_to_look_at_the_camera),
        cmocka_unit_test(too_poor_a_choice_is_told_what_would_help),
        cmocka_unit_test(another_choice_while_driving_says_what_it_replaces),
        cmocka_unit_test(a_margin_says_how_much_of_it_the_named_neurons_make),
        cmocka_unit_test(a_long_reason_is_cut),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
