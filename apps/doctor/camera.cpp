#include "doctor/camera.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include <vdna_messages.h>

#include <vdna/camera_time.h>

#include "doctor/network.hpp"
#include "doctor/system_files.hpp"
#include "program/median.hpp"
#include "telemetry/type_name.hpp"

namespace vdna::doctor
{

namespace
{

constexpr const char *not_heard = "not heard: see channels";

bool nothing_to_hear(const Heard &heard)
{
    return heard.is_log || !heard.refusal.empty();
}

Verdict silence(const Settings &settings, const Heard &heard)
{
    const std::string found =
        "nothing on " + settings.camera + " in " + program::fixed(heard.seconds, 1) + " s";
    for (const vdna_transport_overheard &other : heard.others)
        if (other.fingerprint == vdna_message_image.fingerprint)
            return broken(found + ", but " + text_of(other), "set camera = \"" +
                                                                 printable(other.channel) + "\" " +
                                                                 section_of("lcm", settings));
    return broken(found, "start the camera driver on this URL; `vdna camera /dev/video0` is one");
}

// Why no message of the camera's channel is a frame.
Verdict rejection(const Settings &settings, const vdna_transport_counters &counters)
{
    const std::string all = "all messages on " + settings.camera + " are ";
    if (counters.corrupted_frames > 0)
        return broken(all + "refused: their checksum is false",
                      "see to the network between camera and robot");
    if (counters.unprotected_frames > 0)
        return broken(all + "without protection",
                      "let `vdna camera` send them, or set require_protection = false " +
                          section_of("lcm", settings));
    if (counters.camera_fingerprint == vdna_message_image.fingerprint)
        return broken(all + "malformed: bot_core.image_t that ends too early or too late",
                      "correct the driver's encoder; its build of the type may be old");
    const char *name = telemetry::type_name(counters.camera_fingerprint);
    char number[40];
    std::snprintf(number, sizeof number, "fingerprint %016" PRIx64, counters.camera_fingerprint);
    return broken(all + "of another type: " + (name ? name : number),
                  "let the driver send bot_core.image_t, or set camera " +
                      section_of("lcm", settings));
}

uint64_t lost_of(const vdna_transport_counters &counters)
{
    return std::max(counters.lost, counters.lost_frames);
}

std::string protection_text(const vdna_transport_counters &counters)
{
    if (counters.unprotected_frames == 0)
        return "protected";
    return counters.stream_count == 0 ? "unprotected" : "partly protected";
}

// What the stamps of a stretch say when they are put on the daemon's axis.
struct Axis {
    vdna_camera_time time{};
    std::vector<double> spacings_s; // of frames in order
    int64_t newest_us = 0;
};

Axis axis_of(const std::vector<Stamp> &stamps)
{
    Axis axis;
    std::vector<int64_t> given;
    for (const Stamp &stamp : stamps)
        given.push_back(stamp.utime);
    vdna_camera_time_init(&axis.time, vdna_time_unit(given.data(), given.size()),
                          VDNA_TIME_LATE_US_DEFAULT);
    for (const int64_t stamp : given) {
        const bool is_first = axis.time.frames == 0;
        const int64_t before_us = axis.time.newest_us;
        int64_t utime = 0;
        if (vdna_camera_time_take(&axis.time, stamp, &utime) == VDNA_TIME_IN_ORDER && !is_first)
            axis.spacings_s.push_back(static_cast<double>(utime - before_us) / 1e6);
    }
    axis.newest_us = axis.time.newest_us;
    return axis;
}

// Camera time that passes in a second; 0 = too few frames to tell.
double pace_of(const Axis &axis, const std::vector<Stamp> &stamps)
{
    const double wall_s = static_cast<double>(stamps.back().wall_us - stamps.front().wall_us) / 1e6;
    double camera_s = 0;
    for (const double spacing : axis.spacings_s)
        camera_s += spacing;
    return wall_s > 0 ? camera_s / wall_s : 0;
}

Verdict check_age(const Axis &axis, const Stamp &newest)
{
    constexpr int64_t absolute_us = 1000000000000000; // 2001: an earlier one counts from a start
    constexpr double most_s = 5;
    const double age_s = static_cast<double>(newest.wall_us - axis.newest_us) / 1e6;
    const double hz = 1 / std::max(program::median_of(axis.spacings_s), 1e-6);
    const std::string steady = "steady, " + program::fixed(hz, 1) + " Hz, ";
    if (axis.newest_us < absolute_us)
        return ok(steady + "since a start: no time of day");
    if (std::abs(age_s) > most_s)
        return warn(
            "stamps are " + program::fixed(std::abs(age_s), 0) + " s " +
                (age_s > 0 ? "behind" : "ahead of") + " this machine's clock",
            "sudo timedatectl set-ntp true, on the camera's machine too; a recording that is "
            "played may be old");
    return ok(steady + program::fixed(1e3 * age_s, 0) + " ms old");
}

} // namespace

Verdict check_frames(const Settings &settings, const Heard &heard)
{
    const vdna_transport_counters &counters = heard.counters;
    if (nothing_to_hear(heard))
        return unknown(not_heard);
    if (counters.received + counters.camera_rejected + counters.repeated_frames == 0)
        return silence(settings, heard);
    if (counters.received == 0 && counters.camera_rejected > 0)
        return rejection(settings, counters);
    if (counters.oversized > 0)
        return broken(std::to_string(counters.oversized) + " of " +
                          std::to_string(counters.received) + " frames are larger than " +
                          bytes_text(settings.max_image_bytes),
                      "set max_image_bytes = " + std::to_string(counters.picture_bytes_max) + " " +
                          section_of("lcm", settings) + ", or send JPEG");
    if (counters.camera_rejected + counters.repeated_frames > 0)
        return warn(std::to_string(counters.camera_rejected) + " messages refused, " +
                        std::to_string(counters.repeated_frames) + " repeated, " +
                        std::to_string(counters.received) + " good",
                    "let one camera driver send on " + settings.camera +
                        "; `vdna command reset` before a recording is sent again");
    if (const uint64_t lost = lost_of(counters); lost > 0)
        return warn(std::to_string(lost) + " lost, " + std::to_string(counters.received) + " came",
                    "enlarge the buffer (see buffer), send smaller pictures, or lower the load");
    return ok(std::to_string(counters.received) + " in " + program::fixed(heard.seconds, 1) +
              " s, " + bytes_text(heard.picture_bytes) + " each, " + protection_text(counters));
}

Verdict check_sender(const Settings &settings, const Heard &heard)
{
    if (nothing_to_hear(heard) || heard.stamps.empty())
        return unknown("no frames");
    if (heard.counters.other_sender_frames > 0 || heard.counters.stream_count > 1)
        return broken("several programs send on " + settings.camera,
                      "stop all but one, or give each a channel of its own: camera " +
                          section_of("lcm", settings));
    return ok("one program sends");
}

Verdict check_stamps(const Heard &heard)
{
    constexpr size_t frames_min = 3;
    constexpr double gap_factor = 3;
    if (nothing_to_hear(heard) || heard.stamps.size() < frames_min)
        return unknown("too few frames");
    const Axis axis = axis_of(heard.stamps);
    const vdna_camera_time &time = axis.time;
    if (time.backwards + time.late > 0)
        return broken("stamps step back, " + std::to_string(time.backwards + time.late) + " times",
                      "let one program send (see sender); set the camera's clock by one source");
    if (time.still + 1 >= heard.stamps.size())
        return broken("all frames have the same stamp, " + std::to_string(heard.stamps[0].utime),
                      "let the driver set utime for each frame");
    if (time.unit != VDNA_TIME_UNIT_US)
        return warn(std::string("stamps are ") + vdna_time_unit_name(time.unit),
                    "let the driver set utime in microseconds");
    const double pace = pace_of(axis, heard.stamps);
    if (pace > 0 && (pace < 0.5 || pace > 2))
        return warn("camera time runs at " + program::fixed(pace, 2) + " times that of the clock",
                    "let the driver set utime in microseconds, when the picture is taken");
    const double usual = program::median_of(axis.spacings_s);
    const double longest = *std::max_element(axis.spacings_s.begin(), axis.spacings_s.end());
    if (longest > gap_factor * usual)
        return warn("a gap of " + program::fixed(longest, 2) + " s at " +
                        program::fixed(1 / std::max(usual, 1e-6), 1) + " Hz",
                    "see to the camera's driver: automatic exposure, USB bandwidth, load");
    return check_age(axis, heard.stamps.back());
}

} // namespace vdna::doctor
