// Tracks of GPX files and tables: contents, refusals, positions between fixes, and the join to
// frames.
#include <cmath>
#include <cstring>
#include <random>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>

#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/track.hpp"
#include "frames/track_file.hpp"
#include "frames/track_join.hpp"

using vdna::frames::Fix;
using vdna::frames::Track;
using vdna::frames::TrackFile;
using vdna::frames::TrackJoin;

namespace
{

constexpr int64_t second_us = 1000000;
constexpr int64_t noon = 1714564800 * second_us; // 2024-05-01T12:00:00Z

std::string gpx(const std::string &points)
{
    return "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" "
           "xmlns=\"http://www.topografix.com/GPX/1/1\">"
           "<wpt lat=\"9\" lon=\"9\"><time>1999-01-01T00:00:00Z</time></wpt><trk><name>a</name>"
           "<trkseg>" +
           points + "</trkseg></trk></gpx>\n";
}

std::string point(const std::string &lat, const std::string &lon, const std::string &inner)
{
    return "<trkpt lat=\"" + lat + "\" lon=\"" + lon + "\">" + inner + "</trkpt>";
}

std::string at_noon(int second)
{
    return "<time>2024-05-01T12:00:0" + std::to_string(second) + "Z</time>";
}

TrackFile read(const std::string &name, const std::string &bytes)
{
    const Folder folder;
    const std::filesystem::path path = folder.write(name, bytes);
    return path.extension() == ".gpx" ? vdna::frames::read_gpx(path)
                                      : vdna::frames::read_track_table(path);
}

// The complaint, without the folder's name; "" if it is accepted.
std::string refusal_of(const std::string &name, const std::string &bytes)
{
    const Folder folder;
    try {
        Track::from_file(folder.write(name, bytes), 2 * second_us);
    } catch (const vdna::Error &e) {
        return std::string(e.what()).substr(folder.path().string().size() + 1);
    }
    return "";
}

void assert_refused(const std::string &name, const std::string &bytes, const std::string &begin)
{
    const std::string refusal = refusal_of(name, bytes);
    if (refusal.substr(0, begin.size()) != begin)
        fail_msg("found '%s', expected '%s...'", refusal.c_str(), begin.c_str());
}

void assert_fix(const Fix &fix, int64_t utime, double lat, double lon)
{
    assert_true(fix.utime == utime);
    assert_true(fix.lat == lat);
    assert_true(fix.lon == lon);
}

void the_points_of_all_segments_are_read(void **)
{
    const TrackFile file = read(
        "a.gpx", gpx(point("1.5", "-2.25", at_noon(1) + "<ele> 70.5 </ele>") + "</trkseg><trkseg>" +
                     point(" 3", "4e0", "<ele>1</ele><time>\n2024-05-01T14:00:02+02:00 </time>") +
                     "</trkseg></trk><trk><trkseg>" + point("5", "6", at_noon(3))));
    assert_int_equal(file.fixes.size(), 3);
    assert_fix(file.fixes[0], noon + 1 * second_us, 1.5, -2.25);
    assert_true(*file.fixes[0].alt == 70.5);
    assert_fix(file.fixes[1], noon + 2 * second_us, 3, 4);
    assert_fix(file.fixes[2], noon + 3 * second_us, 5, 6);
    assert_false(file.fixes[2].alt.has_value());
}

void points_without_a_time_are_left_out_and_counted(void **)
{
    const TrackFile file = read("a.gpx", gpx(point("1", "2", "") + point("3", "4", at_noon(1)) +
                                             point("5", "6", "<time/>")));
    assert_int_equal(file.fixes.size(), 1);
    assert_int_equal(file.unplaced, 2);
}

void a_planned_route_is_refused(void **)
{
    assert_refused("a.gpx", gpx(point("1", "2", "") + point("1", "2", "")),
                   "a.gpx: has 2 track points, none of them with a time; expected a track that was "
                   "recorded");
    assert_refused("a.gpx", gpx(""), "a.gpx: has 0 track points");
}

void a_damaged_gpx_file_is_told_with_its_place(void **)
{
    const std::string whole = gpx(point("1", "2", at_noon(1)));
    for (size_t size = 60; size < whole.size() - 2; size++)
        assert_refused("a.gpx", whole.substr(0, size), "a.gpx: damaged at byte ");
    assert_refused("a.gpx", "", "a.gpx: damaged at byte 0: ");
    assert_refused("a.gpx", "time,lat,lon\n1,2,3\n", "a.gpx: damaged at byte ");
    assert_refused("a.gpx", "<kml></kml>",
                   "a.gpx: the outermost element is 'kml', expected a GPX file");
}

void bad_values_of_a_gpx_file_are_named(void **)
{
    assert_refused("a.gpx", gpx(point("1,5", "2", at_noon(1))),
                   "a.gpx: the track point at byte 171: lat is '1,5', expected a decimal number");
    for (const char *bad : {"", "x", "1e999", "0x10"})
        assert_refused("a.gpx", gpx(point("1", bad, at_noon(1))),
                       "a.gpx: the track point at byte 171: lon is '" + std::string(bad) + "'");
    assert_refused("a.gpx", gpx(point("1", "2", "<time>1714564800</time>")),
                   "a.gpx: the track point at byte 171: time is '1714564800', expected a time such "
                   "as 2024-05-01T12:00:00Z");
    assert_refused("a.gpx", gpx(point("1", "2", at_noon(1) + "<ele>high</ele>")),
                   "a.gpx: the track point at byte 171: ele is 'high'");
}

void a_missing_track_is_named(void **)
{
    try {
        Track::from_file("/nowhere/a.GPX", second_us);
    } catch (const vdna::Error &e) {
        assert_string_equal(e.what(),
                            "/nowhere/a.GPX: cannot read this file, expected a GPX track");
        return;
    }
    fail_msg("a missing file was accepted");
}

void tables_are_read_as_phones_write_them(void **)
{
    for (const char *table : {
             "utime,lat,lon,alt\n1714564801000000,1.5,-2.25,70\n",
             "time,lat,lon,elevation,accuracy\n2024-05-01T12:00:01Z,1.5,-2.25,70,4\n",
             "Longitude (\xC2\xB0),Latitude (\xC2\xB0),Height (m),Time\n-2.25,1.5,70,1714564801\n",
             "timestamp,latitude,longitude,altitude\n1714564801000,1.5,-2.25,70\n",
             "TIMESTAMP,Lat,Lng,Ele\n1714564801000000,1.5,-2.25,70\n",
             "time,seconds_elapsed,altitude,longitude,latitude\n1714564801000000000,1,70,-2.25,1."
             "5\n",
             "time,lat,lon,alt\n2024-05-01 14:00:01+02:00,1.5,-2.25,70\n",
         }) {
        const TrackFile file = read("t.csv", table);
        assert_int_equal(file.fixes.size(), 1);
        assert_fix(file.fixes[0], noon + second_us, 1.5, -2.25);
        assert_true(*file.fixes[0].alt == 70);
    }
}

void seconds_of_a_table_keep_their_fraction(void **)
{
    assert_fix(read("t.csv", "time,lat,lon\n1714564801.125,1,2\n").fixes[0], noon + 1125000, 1, 2);
}

void utimes_may_count_from_anywhere(void **)
{
    assert_fix(read("t.csv", "utime,lat,lon\n-5,1,2\n").fixes[0], -5, 1, 2);
}

void rows_without_a_fix_are_left_out_and_counted(void **)
{
    const TrackFile file = read("t.csv", "utime,lat,lon,alt\n1,,,\n2,1,2,\n,1,2,3\n3,1,,3\n");
    assert_int_equal(file.fixes.size(), 1);
    assert_false(file.fixes[0].alt.has_value());
    assert_int_equal(file.unplaced, 3);
    assert_refused("t.csv", "utime,lat,lon\n1,,\n", "t.csv: no row has a time and a position");
}

void bad_tables_are_refused_with_their_place(void **)
{
    const char *missing = "t.csv: a column of the track is missing, expected time";
    assert_refused("t.csv", "time,lat\n1,2\n", missing);
    assert_refused("t.csv", "lat,lon\n1,2\n", missing);
    assert_refused("t.csv", "utime,lat,lon\n1,1,2\n1.5,1,2\n", "t.csv:3: utime is '1.5'");
    for (const char *bad : {"9223372036854775807", "-9223372036854775808", "99999999999999999999"})
        assert_refused("t.csv", std::string("utime,lat,lon\n") + bad + ",1,2\n",
                       "t.csv:2: utime is '");
    // Seconds since the start of an app are nobody's time of day.
    for (const char *bad : {"12.5", "-1", "nan", "1e30", "12:00:01", "yesterday"})
        assert_refused("t.csv", std::string("time,lat,lon\n") + bad + ",1,2\n",
                       "t.csv:2: time is '" + std::string(bad) +
                           "', expected a time such as 2024-");
    for (const char *bad : {"n", "nan", "inf", "1e999"})
        assert_refused("t.csv", std::string("utime,lat,lon\n1,") + bad + ",2\n",
                       "t.csv:2: lat is '" + std::string(bad) + "', expected a decimal number");
}

Track track_of(const std::vector<int64_t> &utimes, int64_t gap_us)
{
    std::vector<Track::Point> points;
    for (const int64_t utime : utimes)
        points.push_back({utime, {{double(points.size()), 0, 0}}});
    return Track("t", "local", points, gap_us);
}

void assert_x(const Track &track, int64_t utime, double x)
{
    const auto position = track.at(utime);
    assert_true(position.has_value());
    assert_float_equal((*position)[0], x, 1e-9);
}

void between_two_fixes_the_track_is_straight(void **)
{
    const Track track = track_of({1000, 2000, 4000}, 2000);
    assert_x(track, 1000, 0);
    assert_x(track, 1250, 0.25);
    assert_x(track, 2000, 1);
    assert_x(track, 3000, 1.5);
    assert_x(track, 4000, 2);
    assert_int_equal(track.spacing_us(), 2000);
}

void beyond_its_ends_and_in_a_gap_there_is_no_position(void **)
{
    const Track track = track_of({1000, 2000, 4001, 5000}, 2000);
    for (const int64_t utime : {INT64_MIN, int64_t{999}, int64_t{2001}, int64_t{3000},
                                int64_t{4000}, int64_t{5001}, INT64_MAX})
        assert_false(track.at(utime).has_value());
    assert_x(track, 2000, 1);
    assert_x(track, 4001, 2);
}

void fixes_may_be_in_any_order(void **)
{
    const Track track = track_of({3000, 1000, 2000}, 1000);
    assert_x(track, 1500, 1.5);
    assert_x(track, 2500, 1);
    assert_int_equal(track.begin_utime(), 1000);
    assert_int_equal(track.end_utime(), 3000);
}

void of_two_fixes_at_one_time_the_first_counts(void **)
{
    const Track track = track_of({1000, 2000, 2000, 3000}, 1000);
    assert_x(track, 2000, 1);
    assert_x(track, 2500, 2);
}

void a_single_fix_is_a_track_of_one_moment(void **)
{
    const Track track = track_of({1000}, 1000);
    assert_x(track, 1000, 0);
    assert_false(track.at(1001).has_value());
    assert_int_equal(track.spacing_us(), 0);
}

// Positions of random drives, some of them across 180 degrees east, against a plain computation on
// the sphere of degrees: seconds before and after by their share.
void positions_are_those_of_a_plain_computation(void **)
{
    std::mt19937 chance(7);
    const auto within = [&](double lo, double hi) {
        return std::uniform_real_distribution<double>(lo, hi)(chance);
    };
    for (int drive = 0; drive < 200; drive++) {
        std::string table = "utime,lat,lon\n";
        std::vector<Fix> fixes;
        double lat = within(-80, 80), lon = drive % 2 == 0 ? within(-180, 180) : 179.9999;
        int64_t utime = noon;
        for (int i = 0; i < 20; i++) {
            fixes.push_back({utime, lat, lon, {}});
            char row[128];
            // A receiver says -179.9 where the drive is at 180.1.
            std::snprintf(row, sizeof row, "%lld,%.12f,%.12f\n", static_cast<long long>(utime), lat,
                          lon > 180 ? lon - 360 : lon);
            table += row;
            utime += static_cast<int64_t>(within(0.1, 3) * 1e6);
            lat += within(-2e-4, 2e-4);
            lon += within(0, 2e-4);
        }
        const Folder folder;
        const Track track = Track::from_file(folder.write("t.csv", table), 2 * second_us);
        for (int i = 0; i < 100; i++) {
            const auto at = static_cast<int64_t>(within(double(noon - 1e6), double(utime)));
            const Fix *a = nullptr, *b = nullptr;
            for (size_t f = 0; f + 1 < fixes.size(); f++)
                if (fixes[f].utime <= at && at <= fixes[f + 1].utime)
                    a = &fixes[f], b = &fixes[f + 1];
            const auto position = track.at(at);
            const bool is_near = a && b->utime - a->utime <= 2 * second_us;
            assert_int_equal(position.has_value(), is_near);
            if (!is_near)
                continue;
            const double share = double(at - a->utime) / double(b->utime - a->utime);
            double expected[3];
            assert_int_equal(vdna_geodesy_to_ecef(a->lat + share * (b->lat - a->lat),
                                                  a->lon + share * (b->lon - a->lon), 0, expected),
                             VDNA_OK);
            const auto &p = *position;
            assert_true(std::hypot(p[0] - expected[0], p[1] - expected[1], p[2] - expected[2]) <
                        0.01);
        }
    }
}

void fixes_that_nobody_can_have_had_are_left_out(void **)
{
    const Folder folder;
    const Track track = Track::from_file(folder.write("t.csv", "utime,lat,lon\n"
                                                               "0,10,20\n"
                                                               "1000000,0,0\n"
                                                               "2000000,95,20\n"
                                                               "3000000,10.5,20\n"
                                                               "4000000,1e300,20\n"
                                                               "5000000,10.0001,20\n"),
                                         5 * second_us);
    assert_int_equal(track.size(), 2);
    assert_string_equal(track.frame().c_str(), "wgs84");
    const auto p = *track.at(2500000);
    double expected[3];
    vdna_geodesy_to_ecef(10.00005, 20, 0, expected);
    assert_true(std::hypot(p[0] - expected[0], p[1] - expected[1], p[2] - expected[2]) < 0.01);
    assert_refused("t.csv", "utime,lat,lon\n1,0,0\n2,,\n3,91,1\n",
                   "t.csv: no fix of this track can be used: 3 fixes left out: 1 at 0,0, 1 beyond "
                   "the globe, 1 without a time or a position; record it again");
}

void heights_count_only_if_every_fix_has_one(void **)
{
    const Folder folder;
    const auto radius_at_2 = [&](const char *table) {
        const auto p = *Track::from_file(folder.write("t.csv", table), 10).at(2);
        return std::hypot(p[0], p[1], p[2]);
    };
    assert_float_equal(radius_at_2("utime,lat,lon,alt\n1,0,90,100\n3,0,90,100\n"), 6378237, 1e-6);
    assert_float_equal(radius_at_2("utime,lat,lon,alt\n1,0,90,100\n3,0,90,\n"), 6378137, 1e-6);
}

// The complaint of a join of frames at these times.
std::string complaint_of(const Track &track, const std::vector<int64_t> &utimes)
{
    try {
        TrackJoin join(track, "drive.mp4");
        for (const int64_t utime : utimes) {
            vdna::frames::Label label;
            join.label_next(utime, label);
        }
        join.finish();
    } catch (const vdna::Error &e) {
        return e.what();
    }
    return "";
}

void frames_of_another_time_are_told_with_both_times(void **)
{
    const Track track = track_of({noon, noon + second_us}, second_us);
    const std::string expected =
        "t: the track is from 2024-05-01T12:00:00.000Z to 2024-05-01T12:00:01.000Z, but the frames "
        "of drive.mp4 ";
    const std::string remedy = "; set --time-offset to the seconds to add to the frames' times or, "
                               "if these count from 0, to the time of the first frame";
    // At the first frame, if it shows.
    assert_string_equal(complaint_of(track, {0}).c_str(),
                        (expected + "begin at 1970-01-01T00:00:00.000Z" + remedy).c_str());
    assert_string_equal(complaint_of(track, {noon + 3 * second_us}).c_str(),
                        (expected + "begin at 2024-05-01T12:00:03.000Z" + remedy).c_str());
    // Else at the end.
    assert_string_equal(
        complaint_of(track, {noon - 3 * second_us, noon - 2 * second_us}).c_str(),
        (expected + "are from 2024-05-01T11:59:57.000Z to 2024-05-01T11:59:58.000Z" + remedy)
            .c_str());
    assert_string_equal(complaint_of(track, {INT64_MIN}).substr(0, expected.size()).c_str(),
                        expected.c_str());
}

void the_track_replaces_other_truth(void **)
{
    TrackJoin join(track_of({noon, noon + second_us}, second_us), "drive.mp4");
    for (const int64_t utime : {noon, noon + 2 * second_us}) {
        vdna::frames::Label label;
        label.place = 5;
        label.position = {{7, 7, 7}};
        label.position_frame = "garage";
        join.label_next(utime, label);
        assert_false(label.place.has_value());
        assert_int_equal(label.position.has_value(), utime == noon);
        assert_int_equal(label.lacks_truth, utime != noon);
        assert_string_equal(label.position_frame.c_str(), utime == noon ? "local" : "");
        if (label.position)
            assert_true((*label.position)[0] == 0);
    }
}

void a_video_adds_when_it_was_made(void **)
{
    const Folder folder;
    const std::string video = folder.write(
        "v.mp4", std::string("\0\0\0\x18moov\0\0\0\x10mvhd\0\0\0\0\xE2\x57\xDF\x40", 24));
    try {
        TrackJoin join(track_of({noon}, 1), video);
        vdna::frames::Label label;
        join.label_next(0, label);
    } catch (const vdna::Error &e) {
        assert_non_null(
            std::strstr(e.what(), " (the file says that it was made at 2024-05-01T12:00:00.000Z)"));
        return;
    }
    fail_msg("a track of another time was accepted");
}

void some_frames_without_a_position_are_allowed(void **)
{
    const Track track = track_of({noon, noon + second_us}, second_us);
    assert_string_equal(complaint_of(track, {noon - second_us, noon, noon + 5 * second_us}).c_str(),
                        "");
    assert_string_equal(complaint_of(track, {}).c_str(), "");
}

void a_track_of_gaps_only_is_told_with_its_spacing(void **)
{
    const Track track =
        track_of({noon, noon + 5 * second_us, noon + 10 * second_us}, 2 * second_us);
    assert_string_equal(complaint_of(track, {noon + second_us, noon + 2 * second_us}).c_str(),
                        "t: its fixes are 5 s apart, so no frame of drive.mp4 lies between two of "
                        "them that are within 2 s; set a longer --gps-gap");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_points_of_all_segments_are_read),
        cmocka_unit_test(points_without_a_time_are_left_out_and_counted),
        cmocka_unit_test(a_planned_route_is_refused),
        cmocka_unit_test(a_damaged_gpx_file_is_told_with_its_place),
        cmocka_unit_test(bad_values_of_a_gpx_file_are_named),
        cmocka_unit_test(a_missing_track_is_named),
        cmocka_unit_test(tables_are_read_as_phones_write_them),
        cmocka_unit_test(seconds_of_a_table_keep_their_fraction),
        cmocka_unit_test(utimes_may_count_from_anywhere),
        cmocka_unit_test(rows_without_a_fix_are_left_out_and_counted),
        cmocka_unit_test(bad_tables_are_refused_with_their_place),
        cmocka_unit_test(between_two_fixes_the_track_is_straight),
        cmocka_unit_test(beyond_its_ends_and_in_a_gap_there_is_no_position),
        cmocka_unit_test(fixes_may_be_in_any_order),
        cmocka_unit_test(of_two_fixes_at_one_time_the_first_counts),
        cmocka_unit_test(a_single_fix_is_a_track_of_one_moment),
        cmocka_unit_test(positions_are_those_of_a_plain_computation),
        cmocka_unit_test(fixes_that_nobody_can_have_had_are_left_out),
        cmocka_unit_test(heights_count_only_if_every_fix_has_one),
        cmocka_unit_test(frames_of_another_time_are_told_with_both_times),
        cmocka_unit_test(the_track_replaces_other_truth),
        cmocka_unit_test(a_video_adds_when_it_was_made),
        cmocka_unit_test(some_frames_without_a_position_are_allowed),
        cmocka_unit_test(a_track_of_gaps_only_is_told_with_its_spacing),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
