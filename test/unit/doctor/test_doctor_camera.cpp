// The doctor's checks of the camera, each broken on purpose.
#include <cstring>

#include "doctor/camera.hpp"
#include "verdicts.hpp"

using namespace vdna::doctor;

namespace
{

constexpr uint64_t image = 0x14739ffe13d5f5f0, images = 0x20ba4f05e8f5e33a;
constexpr int64_t now_us = 1800000000000000;

// 45 frames in three seconds, each 40 ms old when it comes.
Heard good()
{
    Heard heard;
    heard.seconds = 3;
    heard.counters.received = 45;
    heard.counters.stream_count = 1;
    heard.picture_bytes = 40960;
    for (int64_t i = 0; i < 45; i++)
        heard.stamps.push_back({now_us + i * 66667 - 40000, now_us + i * 66667});
    return heard;
}

// The same with other stamps, which `change` makes of the good ones.
template <typename Change>
Heard stamped(Change change)
{
    Heard heard = good();
    for (Stamp &stamp : heard.stamps)
        stamp.utime = change(stamp.utime);
    return heard;
}

Verdict frames_of(const Heard &heard)
{
    return check_frames(Settings{}, heard);
}

void good_frames_are_described(void **)
{
    Heard heard = good();
    expect_ok(frames_of(heard), "45 in 3.0 s, 40 KiB each, protected");
    heard.counters.unprotected_frames = 5;
    expect_ok(frames_of(heard), "partly protected");
    heard.counters.stream_count = 0;
    expect_ok(frames_of(heard), "unprotected");
    expect_ok(check_sender(Settings{}, heard), "one");
    expect_ok(check_stamps(heard), "steady, 15.0 Hz, 40 ms old");
    heard.refusal = "no route";
    expect_unknown(frames_of(heard), "see channels");
    expect_unknown(check_sender(Settings{}, heard), "no frames");
    expect_unknown(check_stamps(heard), "too few");
}

void no_frames_fail(void **)
{
    Heard heard;
    heard.seconds = 3;
    expect_failure(frames_of(heard), "nothing on CAMERA in 3.0 s", "vdna camera");
    vdna_transport_overheard other{};
    std::strcpy(other.channel, "CAMERA_FRONT");
    other.fingerprint = image;
    heard.others = {other};
    expect_failure(frames_of(heard), "but CAMERA_FRONT bot_core.image_t",
                   "set camera = \"CAMERA_FRONT\" in [lcm]");
}

void frames_that_are_refused_fail(void **)
{
    Heard heard = good();
    heard.counters = {};
    heard.counters.camera_rejected = 45;
    heard.counters.camera_fingerprint = images;
    expect_failure(frames_of(heard), "of another type: bot_core.images_t", "bot_core.image_t");
    heard.counters.camera_fingerprint = image;
    expect_failure(frames_of(heard), "malformed", "encoder");
    heard.counters.unprotected_frames = 45;
    expect_failure(frames_of(heard), "without protection", "require_protection = false");
    heard.counters.corrupted_frames = 45;
    expect_failure(frames_of(heard), "checksum is false", "network");
}

void frames_that_are_too_large_fail(void **)
{
    Heard heard = good();
    heard.counters.oversized = 45;
    heard.counters.picture_bytes_max = 6220800;
    expect_failure(frames_of(heard), "45 of 45 frames are larger than 2.0 MiB",
                   "max_image_bytes = 6220800");
}

void frames_that_are_lost_or_repeated_are_a_warning(void **)
{
    Heard heard = good();
    heard.counters.lost = 9;
    expect_warning(frames_of(heard), "9 lost, 45 came", "buffer");
    heard.counters.repeated_frames = 3;
    expect_warning(frames_of(heard), "3 repeated", "vdna command reset");
}

void several_senders_fail(void **)
{
    Heard heard = good();
    heard.counters.other_sender_frames = 1;
    expect_failure(check_sender(Settings{}, heard), "several programs send on CAMERA",
                   "stop all but");
    heard.counters.other_sender_frames = 0;
    heard.counters.stream_count = 2;
    expect_failure(check_sender(Settings{}, heard), "several programs", "stop all but");
}

void stamps_that_do_not_move_or_step_back_fail(void **)
{
    expect_failure(check_stamps(stamped([](int64_t) { return int64_t{7}; })), "the same stamp, 7",
                   "utime for each frame");
    Heard heard = good();
    std::swap(heard.stamps[10], heard.stamps[20]);
    expect_failure(check_stamps(heard), "step back", "one program");
}

void stamps_of_another_unit_or_pace_are_a_warning(void **)
{
    expect_warning(check_stamps(stamped([](int64_t us) { return us / 1000; })), "milliseconds",
                   "microseconds");
    expect_warning(check_stamps(stamped([](int64_t us) { return us * 1000; })), "nanoseconds",
                   "microseconds");
    expect_warning(check_stamps(stamped([](int64_t us) { return (us - now_us) * 3; })), "3.0",
                   "when the picture is taken");
}

void stamps_of_another_clock_are_a_warning(void **)
{
    expect_warning(check_stamps(stamped([](int64_t us) { return us - 3600000000; })),
                   "3600 s behind this machine's clock", "timedatectl");
    expect_warning(check_stamps(stamped([](int64_t us) { return us + 60000000; })),
                   "60 s ahead of this", "timedatectl");
    expect_ok(check_stamps(stamped([](int64_t us) { return us - now_us + 1000000; })),
              "no time of day");
}

void a_gap_is_a_warning(void **)
{
    Heard heard = good();
    heard.stamps.erase(heard.stamps.begin() + 10, heard.stamps.begin() + 20);
    expect_warning(check_stamps(heard), "a gap of 0.73 s at 15.0 Hz", "driver");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(good_frames_are_described),
        cmocka_unit_test(no_frames_fail),
        cmocka_unit_test(frames_that_are_refused_fail),
        cmocka_unit_test(frames_that_are_too_large_fail),
        cmocka_unit_test(frames_that_are_lost_or_repeated_are_a_warning),
        cmocka_unit_test(several_senders_fail),
        cmocka_unit_test(stamps_that_do_not_move_or_step_back_fail),
        cmocka_unit_test(stamps_of_another_unit_or_pace_are_a_warning),
        cmocka_unit_test(stamps_of_another_clock_are_a_warning),
        cmocka_unit_test(a_gap_is_a_warning),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
