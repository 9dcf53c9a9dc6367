// Positions of frames from the poses and GPS fixes in the log of their drive.
#include <cmath>
#include <cstring>

#include <bot_core_pose_t.h>
#include <vdna_messages.h>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>

#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/pose_track.hpp"
#include "frames/source.hpp"

using vdna::frames::Frame;
using vdna::frames::Source;
using vdna::frames::SourceOptions;

namespace
{

std::string big_endian(uint64_t value, int bytes)
{
    std::string text;
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
        text += static_cast<char>(value >> shift & 0xff);
    return text;
}

std::string real(double value)
{
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return big_endian(bits, 8);
}

std::string event(const std::string &channel, const std::string &data)
{
    static uint64_t number = 0;
    return big_endian(0xEDA1DA01, 4) + big_endian(number++, 8) + big_endian(1, 8) +
           big_endian(channel.size(), 4) + big_endian(data.size(), 4) + channel + data;
}

// A bot_core.image_t of one grey pixel.
std::string camera(int64_t utime)
{
    return event("CAMERA",
                 big_endian(0x14739ffe13d5f5f0, 8) + big_endian(static_cast<uint64_t>(utime), 8) +
                     big_endian(1, 4) + big_endian(1, 4) + big_endian(1, 4) +
                     big_endian(VDNA_PIXEL_GREY, 4) + big_endian(1, 4) + "g" + big_endian(0, 4));
}

std::string pose(int64_t utime, double x, double y, double z)
{
    std::string data = big_endian(0x2e16efb052b0105e, 8) +
                       big_endian(static_cast<uint64_t>(utime), 8) + real(x) + real(y) + real(z);
    for (int i = 0; i < 13; i++)
        data += real(99);
    return event("POSE", data);
}

std::string gps(int64_t utime, int32_t lock, double lat, double lon)
{
    std::string data = big_endian(0xd7d20e1e68a41516, 8) +
                       big_endian(static_cast<uint64_t>(utime), 8) +
                       big_endian(static_cast<uint32_t>(lock), 4) + real(lon) + real(lat) +
                       real(70) + real(99) + real(99) + big_endian(9, 4);
    for (int i = 0; i < 6; i++)
        data += real(99);
    return event("GPS", data);
}

std::vector<Frame> frames_of(const std::string &log, const SourceOptions &options)
{
    const Folder folder;
    std::vector<Frame> frames;
    Source source(folder.write("drive.lcm", log), options);
    for (Frame frame; source.next(frame);)
        frames.push_back(frame);
    return frames;
}

SourceOptions on_channel(const std::string &channel)
{
    SourceOptions options;
    options.pose_channel = channel;
    return options;
}

// The complaint from the log's name on.
std::string refusal_of(const std::string &log, const SourceOptions &options)
{
    try {
        frames_of(log, options);
    } catch (const vdna::Error &e) {
        return std::string(e.what()).substr(std::string(e.what()).find("drive.lcm"));
    }
    return "";
}

void assert_refused(const std::string &log, const SourceOptions &options, const char *begin)
{
    const std::string refusal = refusal_of(log, options);
    if (refusal.substr(0, std::strlen(begin)) != begin)
        fail_msg("found '%s', expected '%s...'", refusal.c_str(), begin);
}

void poses_are_positions_in_a_local_frame(void **)
{
    const std::string log = pose(1000000, 1, 2, 3) + camera(1500000) + pose(2000000, 3, 4, 5) +
                            camera(2000000) + camera(2500000);
    const std::vector<Frame> frames = frames_of(log, on_channel("POSE"));
    assert_int_equal(frames.size(), 3);
    assert_true((*frames[0].label.position == std::array<double, 3>{{2, 3, 4}}));
    assert_true((*frames[1].label.position == std::array<double, 3>{{3, 4, 5}}));
    assert_false(frames[2].label.position.has_value());
    assert_true(frames[2].label.lacks_truth);
    assert_string_equal(frames[0].label.position_frame.c_str(), "local");

    SourceOptions options = on_channel("POSE");
    options.label_options.local_frame = "garage";
    assert_string_equal(frames_of(log, options)[0].label.position_frame.c_str(), "garage");
}

void gps_fixes_are_positions_on_the_globe(void **)
{
    const std::vector<Frame> frames = frames_of(
        gps(1000000, 3, 51, 179.99999) + camera(1500000) + gps(1500001, 0, 51, 179) +
            gps(2000000, 3, 51, -179.99999) + gps(2100000, 3, 0, 0) + gps(2200000, 3, NAN, 0),
        on_channel("GPS"));
    double expected[3];
    vdna_geodesy_to_ecef(51, 180, 70, expected);
    const auto &p = *frames.at(0).label.position;
    assert_true(std::hypot(p[0] - expected[0], p[1] - expected[1], p[2] - expected[2]) < 0.001);
    assert_string_equal(frames[0].label.position_frame.c_str(), "wgs84");
}

void poses_that_are_no_numbers_are_left_out(void **)
{
    const std::vector<Frame> frames =
        frames_of(pose(1000000, 1, 0, 0) + pose(1400000, NAN, 0, 0) + pose(1600000, 1e300, 0, 0) +
                      pose(INT64_MIN, 5, 5, 5) + pose(2000000, 2, 0, 0) + camera(1500000),
                  on_channel("POSE"));
    assert_true((*frames.at(0).label.position)[0] == 1.5);
    assert_refused(pose(1, NAN, 0, 0) + camera(1), on_channel("POSE"),
                   "drive.lcm: none of its poses has a finite position");
    assert_refused(gps(1, 0, 1, 1) + camera(1), on_channel("GPS"),
                   "drive.lcm: no fix of this track can be used: 1 fix left out");
}

void a_channel_that_is_not_there_is_refused_with_those_that_are(void **)
{
    assert_refused(pose(1, 0, 0, 0) + camera(1), on_channel("POSES"),
                   "drive.lcm: no message on channel POSES, expected poses; set --pose-channel to "
                   "one of: CAMERA POSE");
}

void messages_of_another_type_are_refused_with_their_fingerprint(void **)
{
    assert_refused(camera(1), on_channel("CAMERA"),
                   "drive.lcm: message 0 on CAMERA has fingerprint 14739ffe13d5f5f0 and 41 bytes, "
                   "expected bot_core.pose_t or bot_core.gps_data_t; ");
    // Cut short, empty, and another type behind the first message.
    const std::string whole = pose(1, 0, 0, 0);
    assert_refused(event("POSE", whole.substr(32, 100)) + camera(1), on_channel("POSE"),
                   "drive.lcm: message 0 on POSE has fingerprint 2e16efb052b0105e and 100 bytes");
    assert_refused(event("POSE", "") + camera(1), on_channel("POSE"),
                   "drive.lcm: message 0 on POSE has fingerprint 0000000000000000 and 0 bytes");
    assert_refused(whole + event("POSE", gps(1, 3, 1, 1).substr(31)) + camera(1),
                   on_channel("POSE"),
                   "drive.lcm: message 1 on POSE has fingerprint d7d20e1e68a41516 and 112 bytes, "
                   "expected bot_core.pose_t as before it");
}

void only_logs_have_channels(void **)
{
    const Folder folder;
    folder.write("0.jpg", "x");
    try {
        Source(folder.path(), on_channel("POSE"));
    } catch (const vdna::Error &e) {
        assert_non_null(std::strstr(
            e.what(), ": neither an LCM log nor an MCAP file, so it has no --pose-channel"));
        return;
    }
    fail_msg("a folder was accepted");
}

// A hundred poses a second for ten seconds, and a frame each 130 ms, the last ones before a pose
// that is to come.
void thinned_poses_give_the_frames_so_far_and_those_to_come_the_same_positions(void **)
{
    vdna::frames::Poses all("local"), thinned("local");
    std::vector<int64_t> frames, to_come;
    for (int64_t utime = 5000; utime < 10000000; utime += 130000)
        (utime < 9500000 ? frames : to_come).push_back(utime);
    for (int64_t i = 0; i <= 1000; i++) {
        const auto x = static_cast<double>(i * i);
        const bot_core_pose_t pose{10000 * (i ^ 1), {x, -x, 1}, {}, {}, {}, {}}; // pairs swapped
        assert_true(all.take(vdna_message_pose, &pose));
        assert_true(thinned.take(vdna_message_pose, &pose));
    }
    thinned.thin(frames, 100);
    assert_in_range(thinned.size(), frames.size(), 2 * frames.size() + 100);
    assert_true(thinned.newest_utime() == all.newest_utime());
    const auto before = all.track("all", 1000000), after = thinned.track("thinned", 1000000);
    frames.insert(frames.end(), to_come.begin(), to_come.end());
    for (const int64_t utime : frames) {
        assert_true(before.at(utime).has_value());
        assert_true(before.at(utime) == after.at(utime));
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(poses_are_positions_in_a_local_frame),
        cmocka_unit_test(gps_fixes_are_positions_on_the_globe),
        cmocka_unit_test(poses_that_are_no_numbers_are_left_out),
        cmocka_unit_test(a_channel_that_is_not_there_is_refused_with_those_that_are),
        cmocka_unit_test(messages_of_another_type_are_refused_with_their_fingerprint),
        cmocka_unit_test(only_logs_have_channels),
        cmocka_unit_test(thinned_poses_give_the_frames_so_far_and_those_to_come_the_same_positions),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
