// Why the daemon waits: facts of each second in, a sentence out.
#include <cstring>
#include <string>
#include <vector>

#include "cmocka.hpp"
#include "selectord/waiting.hpp"

using namespace vdna::selectord;

namespace
{

constexpr uint64_t image = 0x14739ffe13d5f5f0, images = 0x20ba4f05e8f5e33a;

// Facts that change from second to second, and the verdicts on them.
struct Seconds {
    Config config;
    Waiting waiting;
    Facts facts;
    Verdict verdict;
    std::vector<vdna_transport_overheard> channels;
    unsigned printed = 0;

    explicit Seconds(bool replay = false) : waiting(config, replay) {}

    // Judge, now and after each of some seconds; `change` is called before each of these.
    template <typename Change>
    void pass(int seconds, Change change)
    {
        for (int i = 0; i < seconds; i++) {
            facts.now_us += 1000000;
            change(facts);
            judge();
        }
    }
    void pass(int seconds)
    {
        pass(seconds, [](Facts &) {});
    }
    void judge()
    {
        for (vdna_transport_overheard &channel : channels)
            channel.last_us = facts.now_us;
        facts.overheard = channels.data();
        facts.overheard_count = static_cast<uint32_t>(channels.size());
        verdict = waiting.judge(facts);
        printed += verdict.is_news;
    }

    // A channel that will have carried 31 messages in 3 s from now, in the last two of them.
    void overhear(const char *name, uint64_t fingerprint)
    {
        vdna_transport_overheard channel{};
        std::strcpy(channel.channel, name);
        channel.fingerprint = fingerprint;
        channel.messages = 31;
        channel.first_us = facts.now_us + 1000000;
        channels.push_back(channel);
    }

    bool says(const char *words) const { return std::strstr(verdict.text.data(), words); }
};

// Ten frames a second that are used.
void use_frames(Facts &facts)
{
    facts.camera.received += 10;
    facts.accepted += 10;
}

void nothing_is_wrong_before_three_seconds(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    assert_true(s.verdict.cause == Cause::none);
    assert_string_equal(s.verdict.text.data(), "");
    s.pass(1);
    assert_true(s.verdict.cause == Cause::silence);
}

void silence_everywhere_names_the_driver_and_the_url(void **)
{
    Seconds s;
    s.config.url = "udpm://239.255.76.67:7668";
    s.judge();
    s.pass(3);
    assert_string_equal(s.verdict.text.data(),
                        "no message on CAMERA for 3 s, nor on any other channel: start the camera "
                        "driver, on the LCM URL of this daemon (udpm://239.255.76.67:7668)");
}

void silence_with_pictures_elsewhere_names_their_channel_and_the_key(void **)
{
    Seconds s;
    s.judge();
    s.pass(1);
    s.overhear("POSE", 1);
    s.overhear("CAMERA_FRONT", image);
    s.overhear("VDNA_STATUS", 2); // our own
    s.pass(3);
    assert_string_equal(
        s.verdict.text.data(),
        "no message on CAMERA for 4 s; CAMERA_FRONT carries bot_core.image_t at 15 Hz: set [lcm] "
        "camera");
}

void several_channels_of_pictures_are_a_choice(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    for (const char *name : {"A", "B", "C", "D"})
        s.overhear(name, image);
    s.pass(1);
    assert_true(s.says("C carries bot_core.image_t and 1 more: set [lcm] camera to one of them"));
}

void other_channels_are_named_with_their_type_or_fingerprint(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    s.overhear("STEREO", images);
    s.overhear("POSE", 0xabc);
    s.pass(1);
    assert_true(s.says("; STEREO carries bot_core.images_t, POSE carries fingerprint "
                       "0000000000000abc, none bot_core.image_t: start the camera driver"));
    s.channels[1].fingerprint++;
    s.overhear("GPS", 7);
    s.pass(1);
    assert_int_equal(s.printed, 1);
}

void a_channel_that_fell_silent_is_not_named(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    s.overhear("CAMERA_FRONT", image);
    s.pass(1);
    assert_true(s.says("CAMERA_FRONT"));
    std::vector<vdna_transport_overheard> stopped;
    stopped.swap(s.channels);
    for (int i = 0; i < 3; i++) {
        s.facts.now_us += 1000000;
        s.facts.overheard = stopped.data();
        s.verdict = s.waiting.judge(s.facts);
    }
    assert_true(s.says("nor on any other channel"));
}

void control_characters_of_a_name_are_not_printed(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    s.overhear("\x1b[2J\n\x7f\xc3\xa9", image);
    s.pass(1);
    assert_true(s.says("; ?[2J??\xc3\xa9 carries"));
}

void sixteen_channels_of_longest_names_fit(void **)
{
    Seconds s;
    s.judge();
    s.pass(2);
    for (int i = 0; i < 16; i++)
        s.overhear(std::string(63, static_cast<char>('a' + i)).c_str(), 7);
    s.pass(1);
    assert_true(std::strlen(s.verdict.text.data()) < s.verdict.text.size());
    assert_true(s.says("and 13 more"));
}

void listening_begins_before_the_first_word_and_ends_with_the_pictures(void **)
{
    Seconds s;
    assert_false(s.waiting.wants_to_overhear());
    s.judge();
    s.pass(1);
    assert_false(s.waiting.wants_to_overhear());
    s.pass(1);
    assert_true(s.waiting.wants_to_overhear());
    s.pass(5, [](Facts &facts) { facts.camera.camera_rejected++; });
    assert_true(s.waiting.wants_to_overhear());
    s.pass(1, use_frames);
    assert_false(s.waiting.wants_to_overhear());
    assert_true(Waiting(s.config, true).wants_to_overhear());
}

void messages_of_another_type_are_named_by_fingerprint_and_type(void **)
{
    Seconds s;
    s.judge();
    s.facts.camera.camera_fingerprint = images;
    s.pass(3, [](Facts &facts) { facts.camera.camera_rejected += 10; });
    assert_string_equal(s.verdict.text.data(),
                        "all messages on CAMERA are of another type: found fingerprint "
                        "20ba4f05e8f5e33a (bot_core.images_t), expected bot_core.image_t, "
                        "14739ffe13d5f5f0; let the camera driver send that, or set [lcm] camera");
    s.facts.camera.camera_fingerprint = 5;
    s.pass(1, [](Facts &facts) { facts.camera.camera_rejected += 10; });
    assert_true(s.says("found fingerprint 0000000000000005, expected"));
    assert_int_equal(s.printed, 2);
}

void frames_that_their_protection_keeps_out_name_it(void **)
{
    Seconds damaged, bare, again;
    for (Seconds *s : {&damaged, &bare, &again})
        s->judge();
    damaged.pass(3, [](Facts &facts) {
        facts.camera.camera_rejected += 10;
        facts.camera.corrupted_frames += 10;
    });
    assert_true(damaged.says("their checksums are false") && damaged.says("CAMERA"));
    bare.pass(3, [](Facts &facts) {
        facts.camera.camera_rejected += 10;
        facts.camera.unprotected_frames += 10;
    });
    assert_true(bare.says("[lcm] require_protection"));
    again.pass(3, [](Facts &facts) { facts.camera.repeated_frames += 10; });
    assert_true(again.says("`vdna command reset`"));
    Seconds overtaken;
    overtaken.judge();
    overtaken.pass(3, [](Facts &facts) { facts.camera.reordered_frames += 10; });
    assert_true(overtaken.verdict.cause == Cause::repeated);
}

void a_warmup_of_a_robot_that_stands_is_told(void **)
{
    Seconds s;
    s.judge();
    s.pass(4, [](Facts &facts) {
        use_frames(facts);
        facts.parked += 10;
    });
    assert_true(s.verdict.cause == Cause::parked);
    assert_true(s.says("[warmup] distinct"));
    s.facts.selected = true;
    s.pass(4, [](Facts &facts) {
        use_frames(facts);
        facts.parked += 10;
    });
    assert_true(s.verdict.cause == Cause::none);
}

void in_silence_machines_that_may_not_send_are_told(void **)
{
    Seconds s;
    s.judge();
    s.pass(3, [](Facts &facts) { facts.camera.foreign_datagrams += 10; });
    assert_true(s.verdict.cause == Cause::silence);
    assert_true(s.says("name them in [lcm] sources"));
}

void messages_of_the_right_type_are_malformed(void **)
{
    Seconds s;
    s.judge();
    s.facts.camera.camera_fingerprint = image;
    s.pass(3, [](Facts &facts) { facts.camera.camera_rejected += 10; });
    assert_true(s.says("all messages on CAMERA are malformed"));
}

void oversized_frames_name_the_size_the_limit_and_the_key(void **)
{
    Seconds s;
    s.judge();
    s.pass(4, [](Facts &facts) {
        facts.camera.received += 10;
        facts.camera.oversized += 10;
        facts.camera.oversized_bytes = 2764800;
        facts.camera.picture_bytes_max = 2764801;
    });
    assert_true(s.verdict.cause == Cause::oversized);
    assert_true(s.says("[lcm] max_image_bytes: found 2764800 bytes, expected at most 2097152; set "
                       "it to 2764801 or more"));
    assert_int_equal(s.printed, 1);
}

void what_was_wrong_with_the_last_messages_is_still_said_in_silence(void **)
{
    Seconds s;
    s.judge();
    s.pass(3, [](Facts &facts) {
        facts.camera.received++;
        facts.camera.oversized++;
    });
    s.pass(5);
    assert_true(s.says("max_image_bytes"));
    assert_true(s.says("; no message for 5 s"));
}

void refused_frames_give_the_last_reason(void **)
{
    Seconds s;
    s.judge();
    s.facts.refusal = "picture: not a JPEG";
    s.pass(3, [](Facts &facts) {
        facts.camera.received += 10;
        facts.refused += 10;
    });
    assert_true(s.says("all frames are refused, the last one because: picture: not a JPEG"));
    assert_false(s.says("max_image_pixels"));
    s.facts.refusal =
        "picture: 9999x9999 pixels are too many; the limit is 65535 a side and 2097152 in all";
    s.pass(1, [](Facts &facts) {
        facts.camera.received += 10;
        facts.refused += 10;
    });
    assert_true(s.says("in all ([lcm] max_image_pixels)"));
    s.pass(1, [](Facts &facts) {
        facts.camera.received += 10;
        facts.refused += 9;
        facts.accepted++;
        facts.progress = 0.1;
    });
    assert_true(s.verdict.cause == Cause::none);
}

void a_warmup_that_begins_anew_again_and_again_makes_no_progress(void **)
{
    Seconds s;
    s.judge();
    s.facts.restart_reason = "because camera time stepped back";
    s.pass(5, [](Facts &facts) {
        use_frames(facts);
        facts.restarts += 2;
        facts.progress = 0.04;
    });
    assert_true(s.verdict.cause == Cause::restarts);
    assert_true(s.says("began anew 10 times so far"));
    assert_true(s.says("the last time because camera time stepped back"));
}

void restarts_between_which_there_is_progress_are_found_too(void **)
{
    Seconds s;
    s.judge();
    bool found = false;
    for (int round = 0; round < 3; round++) {
        s.pass(5, [](Facts &facts) {
            use_frames(facts);
            facts.progress += 0.1;
        });
        found = s.verdict.cause == Cause::restarts;
        s.facts.progress = 0;
        s.facts.restarts++;
    }
    assert_true(found);
}

void a_reset_by_command_is_no_restart(void **)
{
    Seconds s;
    s.judge();
    s.pass(5, [](Facts &facts) {
        use_frames(facts);
        facts.progress += 0.1;
    });
    s.facts.progress = 0;
    s.pass(4, [](Facts &facts) {
        use_frames(facts);
        facts.progress += 0.01;
        assert_true(facts.restarts == 0);
    });
    assert_true(s.verdict.cause == Cause::none);
}

void camera_time_that_stands_still_is_said_before_and_after_the_choice(void **)
{
    for (const bool selected : {false, true}) {
        Seconds s;
        s.facts.selected = selected;
        s.judge();
        s.pass(3, [](Facts &facts) {
            use_frames(facts);
            facts.still = facts.accepted - 1;
        });
        s.pass(1, [](Facts &facts) {
            use_frames(facts);
            facts.still = facts.accepted - 1;
        });
        assert_true(s.verdict.cause == Cause::still);
        assert_true(s.says("camera time has not moved for 40 frames"));
        s.pass(1, [](Facts &facts) {
            use_frames(facts);
            facts.still = 0;
            facts.progress += 0.1;
        });
        assert_true(s.verdict.cause == Cause::none);
    }
}

void a_slow_camera_with_one_stamp_repeated_is_no_cause(void **)
{
    Seconds s;
    s.facts.selected = true;
    s.judge();
    s.pass(6, [](Facts &facts) {
        facts.camera.received += 10;
        facts.accepted += 10;
        facts.still = 5;
    });
    assert_true(s.verdict.cause == Cause::none);
}

void more_than_a_tenth_of_late_frames_is_worth_a_word(void **)
{
    for (const uint64_t late : {uint64_t{1}, uint64_t{2}}) {
        Seconds s;
        s.facts.selected = true;
        s.judge();
        s.pass(3, [=](Facts &facts) {
            facts.camera.received += 10 + late;
            facts.accepted += 10;
            facts.late += late;
        });
        assert_int_equal(s.verdict.cause == Cause::late, late == 2);
    }
}

void only_late_frames_are_no_progress(void **)
{
    Seconds s;
    s.judge();
    s.pass(3, [](Facts &facts) {
        facts.camera.received += 10;
        facts.late += 10;
    });
    assert_true(s.verdict.cause == Cause::late);
}

void a_cause_is_printed_once_and_again_when_it_changes_or_comes_back(void **)
{
    Seconds s;
    s.judge();
    s.pass(30);
    assert_int_equal(s.printed, 1);
    s.overhear("CAMERA_FRONT", image);
    s.pass(10);
    assert_int_equal(s.printed, 2);

    // Soon after it was printed a cause that comes back is no news, a minute later it is.
    s.facts.selected = true;
    s.pass(1, use_frames);
    assert_true(s.verdict.cause == Cause::none);
    s.pass(5);
    assert_true(s.verdict.cause == Cause::silence);
    assert_int_equal(s.printed, 2);
    s.pass(60, use_frames);
    s.pass(5);
    assert_int_equal(s.printed, 3);
}

void answers_are_progress_after_the_choice(void **)
{
    Seconds s;
    s.facts.selected = true;
    s.facts.progress = 1;
    s.judge();
    s.pass(10, use_frames);
    assert_int_equal(s.printed, 0);
    s.pass(3);
    assert_true(s.says("no message on CAMERA for 3 s"));
}

void the_end_of_a_log_needs_no_patience_and_no_rates(void **)
{
    Seconds s(true);
    s.overhear("CAMERA_FRONT", image);
    s.judge();
    s.channels[0].last_us = s.facts.now_us + 2000000;
    const Verdict verdict = s.waiting.judge_end(s.facts);
    assert_string_equal(
        verdict.text.data(),
        "no message on CAMERA; CAMERA_FRONT carries bot_core.image_t: set [lcm] camera");

    Facts few;
    few.camera.received = few.accepted = 5;
    few.progress = 0.5;
    assert_true(s.waiting.judge_end(few).cause == Cause::none);
    Facts one;
    one.camera.received = one.accepted = 1;
    assert_true(s.waiting.judge_end(one).cause == Cause::none);
    few.still = 4;
    assert_true(s.waiting.judge_end(few).cause == Cause::still);
    few.restarts = 1;
    assert_true(s.waiting.judge_end(few).cause == Cause::restarts);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_wrong_before_three_seconds),
        cmocka_unit_test(silence_everywhere_names_the_driver_and_the_url),
        cmocka_unit_test(silence_with_pictures_elsewhere_names_their_channel_and_the_key),
        cmocka_unit_test(several_channels_of_pictures_are_a_choice),
        cmocka_unit_test(other_channels_are_named_with_their_type_or_fingerprint),
        cmocka_unit_test(a_channel_that_fell_silent_is_not_named),
        cmocka_unit_test(control_characters_of_a_name_are_not_printed),
        cmocka_unit_test(sixteen_channels_of_longest_names_fit),
        cmocka_unit_test(listening_begins_before_the_first_word_and_ends_with_the_pictures),
        cmocka_unit_test(messages_of_another_type_are_named_by_fingerprint_and_type),
        cmocka_unit_test(frames_that_their_protection_keeps_out_name_it),
        cmocka_unit_test(a_warmup_of_a_robot_that_stands_is_told),
        cmocka_unit_test(in_silence_machines_that_may_not_send_are_told),
        cmocka_unit_test(messages_of_the_right_type_are_malformed),
        cmocka_unit_test(oversized_frames_name_the_size_the_limit_and_the_key),
        cmocka_unit_test(what_was_wrong_with_the_last_messages_is_still_said_in_silence),
        cmocka_unit_test(refused_frames_give_the_last_reason),
        cmocka_unit_test(a_warmup_that_begins_anew_again_and_again_makes_no_progress),
        cmocka_unit_test(restarts_between_which_there_is_progress_are_found_too),
        cmocka_unit_test(a_reset_by_command_is_no_restart),
        cmocka_unit_test(camera_time_that_stands_still_is_said_before_and_after_the_choice),
        cmocka_unit_test(a_slow_camera_with_one_stamp_repeated_is_no_cause),
        cmocka_unit_test(more_than_a_tenth_of_late_frames_is_worth_a_word),
        cmocka_unit_test(only_late_frames_are_no_progress),
        cmocka_unit_test(a_cause_is_printed_once_and_again_when_it_changes_or_comes_back),
        cmocka_unit_test(answers_are_progress_after_the_choice),
        cmocka_unit_test(the_end_of_a_log_needs_no_patience_and_no_rates),
    };
    return cmocka_run_group_tests_name("waiting", tests, nullptr, nullptr);
}
