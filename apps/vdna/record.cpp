// vdna record - makes an experience of a map from the running camera.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <optional>

#include <sys/resource.h>
#include <unistd.h>

#include "program/clock.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "program/notice.hpp"
#include "program/print.hpp"
#include "record/addition.hpp"
#include "record/live_recorder.hpp"
#include "record/map_change.hpp"
#include "vdna/commanding.hpp"
#include "vdna/commands.hpp"
#include "vdna/experience_table.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

namespace fs = std::filesystem;

struct RecordOptions {
    std::string map;
    std::string name;
    NetworkOptions network{"", 1}; // the daemon beside it has the other core
    frames::LiveOptions live;
    frames::SourceOptions source; // as of `vdna build`, with its defaults
    record::LiveLimits limits;
    std::string ranges;
    bool no_thumbnails = false;
    bool no_trust = false;
    bool force = false;
    bool reload = false;
    bool json = false;
};

// What a recording became.
struct Report {
    record::LiveEnd end;
    uint64_t memory_bytes;
    const record::LiveRecorder &recorder;
    frames::LiveCounts counts;
    std::string reload; // what became of it, or why it failed; "" = not asked for
};

const char *text_of(record::LiveEnd end)
{
    switch (end) {
    case record::LiveEnd::interrupted:
        return "ended by a signal";
    case record::LiveEnd::time:
        return "ended by --for";
    case record::LiveEnd::full:
        return "full: ended by --frames-max";
    case record::LiveEnd::log:
        return "the log has ended";
    case record::LiveEnd::network:
        break;
    }
    return "ended because the LCM connection is gone";
}

std::string mib_text(uint64_t bytes)
{
    return program::fixed(static_cast<double>(bytes) / (1 << 20), 1) + " MiB";
}

// Refuse what would only be found out after the drive.
void check_start(const RecordOptions &options, const record::Draft &draft)
{
    record::require_name(draft.name, options.map);
    const fs::path file = record::file_of(options.map, draft);
    if (fs::exists(file) && !options.force)
        throw Error(file.string() +
                    ": exists already; replace it with --force, or choose another name");
    if (!fs::exists(options.map) && options.ranges.empty())
        throw Error(options.map +
                    ": no such map, and its first recordings decide its ranges; make "
                    "it with `vdna build " +
                    options.map + " SOURCE`, or set --ranges");
}

void require_ranges(const RecordOptions &options, const record::Remaining &remaining)
{
    if (!remaining.first && options.ranges.empty())
        throw Error(options.map +
                    ": no other experience in this map whose ranges could be used; "
                    "begin it with `vdna build " +
                    options.map + " SOURCE`, or set --ranges");
}

void require_writable(const std::string &map)
{
    if (::access(map.c_str(), W_OK) != 0)
        throw Error(map + ": cannot be written: " + std::strerror(errno) +
                    "; run as a user who may change this map");
}

// Directions of a projection are learnt from all frames of a new map at once.
void require_projection(const Backbone &backbone, const record::Maker &maker,
                        const std::string &map)
{
    if (backbone.info().embedding_dims > 0 && !maker.blank().identity.projection)
        throw Error(map + ": network " + backbone.info().identity.backbone +
                    " keeps only some numbers of embeddings, which a new map learns from its "
                    "first frames; begin the map with `vdna build`");
}

void yield_to_others()
{
    constexpr int nice = 10;
    setpriority(PRIO_PROCESS, 0, nice); // fails only for who is nicer already
}

std::string position_frame_of(const record::Remaining &remaining)
{
    for (const record::Member &there : remaining.members)
        if (there.header.position_frame[0] != '\0')
            return there.header.position_frame;
    return "";
}

void announce(const RecordOptions &options, const record::LiveRecorder &recorder,
              const frames::Live &live)
{
    std::error_code unknown;
    const fs::space_info disk = fs::space(options.map, unknown);
    std::cerr << "vdna record: at most " << options.limits.frames_max << " frames, "
              << mib_text(recorder.memory_bytes()) << " of memory, and "
              << mib_text(live.memory_bytes()) << " for LCM; listening on " << options.live.camera;
    if (!unknown && disk.available < recorder.memory_bytes())
        std::cerr << "; only " << mib_text(disk.available) << " are free in " << options.map;
    std::cerr << std::endl;
}

void require_frames(const RecordOptions &options, const record::Draft &draft, const Report &report)
{
    if (draft.recording.frames > 0)
        return;
    if (report.counts.received == 0 && report.counts.rejected == 0)
        throw Error(options.live.camera + ": no camera frame came (" + text_of(report.end) +
                    "); does the camera send on this channel, in this LCM network? "
                    "`vdna watch` and docs/operating/no-answers.md help");
    throw Error(options.live.camera + ": none of the " + std::to_string(report.counts.received) +
                " frames that came can be used; the map is unchanged");
}

// Write it, and as long as that fails, for a full disk maybe, again: there is no other copy.
void write(const RecordOptions &options, const record::Draft &draft, const record::Maker &maker,
           std::optional<record::MapChange> &change)
{
    constexpr int64_t pause_us = 5000000;
    for (;;) {
        try {
            if (!change)
                change.emplace(options.map);
            change->add(maker.experience_of(draft));
            return change->commit();
        } catch (const Error &error) {
            program::tell_once(std::string(error.what()) +
                               "; the map is unchanged and the recording still in memory: make "
                               "room, it is tried again every 5 s; Ctrl-C gives it up");
        }
        change.reset();
        program::sleep_until(program::monotonic_us() + pause_us);
    }
}

double seconds_of(const record::Recording &recording)
{
    const auto [first, last] = std::minmax_element(recording.utime.begin(), recording.utime.end());
    return static_cast<double>(*last - *first) / 1e6;
}

uint32_t labelled_of(const record::Recording &recording)
{
    return recording.position.empty() ? 0 : recording.frames - recording.without_truth;
}

std::string unusable_text(const record::LiveRecorder &recorder)
{
    std::string parts;
    const auto add = [&](uint64_t count, const std::string &what) {
        if (count > 0)
            parts += (parts.empty() ? "" : ", ") + std::to_string(count) + " " + what;
    };
    add(recorder.verdicts()[VDNA_HEALTH_OK], "not readable");
    for (uint32_t i = 1; i < VDNA_HEALTH_COUNT; i++)
        add(recorder.verdicts()[i], vdna_health_text(i));
    return std::to_string(recorder.unusable()) + " unusable" +
           (parts.empty() ? "" : " (" + parts + ")");
}

void print(const RecordOptions &options, const record::Draft &draft,
           const vdna_experience &experience, const Report &report)
{
    const record::Recording &recording = draft.recording;
    const fs::path file = record::file_of(options.map, draft);
    std::cout << file.string() << ": " << recording.frames << " frames in "
              << program::fixed(seconds_of(recording), 1) << " s";
    if (experience.frame_position)
        std::cout << " and " << program::fixed(route_of(experience), 0) << " m";
    std::cout << ", " << program::fixed(100.0 * labelled_of(recording) / recording.frames, 0)
              << " % labelled; left out: " << unusable_text(report.recorder) << ", "
              << report.counts.skipped << " that came too fast, " << report.counts.late << " late, "
              << report.recorder.between() << " by --interval; " << report.counts.lost
              << " lost by the network, " << report.counts.rejected << " damaged; "
              << mib_text(fs::file_size(file)) << "; " << text_of(report.end) << '\n';
    if (!report.reload.empty())
        std::cout << "reload: " << report.reload << '\n';
}

void print_json(const RecordOptions &options, const record::Draft &draft,
                const vdna_experience &experience, const Report &report)
{
    const record::Recording &recording = draft.recording;
    const fs::path file = record::file_of(options.map, draft);
    program::Json verdicts = {{"not readable", report.recorder.verdicts()[VDNA_HEALTH_OK]}};
    for (uint32_t i = 1; i < VDNA_HEALTH_COUNT; i++)
        verdicts[vdna_health_text(i)] = report.recorder.verdicts()[i];
    program::print_json(
        {{"experience", draft.name},
         {"file", file.string()},
         {"frames", recording.frames},
         {"seconds", seconds_of(recording)},
         {"route_m",
          experience.frame_position ? program::Json(route_of(experience)) : program::Json()},
         {"frames_labelled", labelled_of(recording)},
         {"frames_received", report.counts.received},
         {"frames_unusable", report.recorder.unusable()},
         {"unusable", verdicts},
         {"frames_skipped", report.counts.skipped},
         {"frames_late", report.counts.late},
         {"frames_between", report.recorder.between()},
         {"frames_lost", report.counts.lost},
         {"frames_rejected", report.counts.rejected},
         {"steps_back", report.counts.backwards},
         {"bytes", fs::file_size(file)},
         {"memory_bytes", report.memory_bytes},
         {"saturated_share", draft.histogram->saturated_share()},
         {"end", text_of(report.end)},
         {"reload", report.reload.empty() ? program::Json() : program::Json(report.reload)}});
}

// What the daemon said. The recording is written, so that nothing here is an error of it.
std::string reload(const RecordOptions &options)
{
    constexpr double reload_timeout_s = 60; // the daemon reads the whole map
    const Daemon daemon{options.live.url, VDNA_CHANNEL_COMMAND, VDNA_CHANNEL_COMMAND_RESULT,
                        reload_timeout_s};
    try {
        return send_and_wait(daemon, *telemetry::find_command("reload"), "");
    } catch (const Error &error) {
        program::tell_once(std::string("reload: ") + error.what());
        return error.what();
    }
}

void record_drive(const RecordOptions &options)
{
    std::vector<record::Draft> drafts(1);
    record::Draft &draft = drafts.front();
    draft.source = "live " + options.live.camera;
    draft.name = options.name;
    check_start(options, draft);
    std::optional<record::MapChange> change(options.map);
    require_writable(options.map);
    const record::Remaining remaining = record::remaining_in(options.map, drafts);
    require_ranges(options, remaining);

    // What receives keeps its priority, or frames would be lost; all threads after it yield to the
    // daemon.
    frames::Live live(options.live);
    yield_to_others();
    Backbone backbone(record::backbone_of(options.network.backbone, remaining),
                      options.network.threads);
    record::Maker maker(backbone, options.source, record::bins_of(0, remaining));
    record::find_ranges(options.ranges, remaining, backbone, maker);
    record::find_projection(options.ranges, remaining, backbone, maker);
    record::require_comparable(remaining, drafts, maker);
    require_projection(backbone, maker, options.map);
    if (!options.no_thumbnails)
        maker.add_thumbnails();

    record::LiveRecorder recorder(maker, backbone, live, options.limits,
                                  position_frame_of(remaining));
    recorder.begin(draft);
    live.begin_counting();
    announce(options, recorder, live);
    const record::LiveEnd end = recorder.record(draft);
    program::forget_interrupt(); // it has ended the drive, and shall not end what follows
    Report report{end, recorder.memory_bytes(), recorder, live.counts(), ""};
    require_frames(options, draft, report);
    draft.recording.account.order = "utime";
    recorder.label(draft, options.source.gps_gap_s);
    maker.end(draft);

    write(options, draft, maker, change);
    if (remaining.first && !options.no_trust)
        record::let_map_know_itself(options.map);
    if (options.reload)
        report.reload = reload(options);
    const vdna_experience experience = maker.experience_of(draft);
    options.json ? print_json(options, draft, experience, report)
                 : print(options, draft, experience, report);
}

void add_limit_options(CLI::App &command, record::LiveLimits &limits)
{
    command
        .add_option("--frames-max", limits.frames_max,
                    "most frames; their memory is taken at the start, and when it is full the "
                    "recording ends")
        ->check(CLI::Range(1u, 1000000u).description(""))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--for", limits.seconds, "end after this time (default: at Ctrl-C)")
        ->check(program::within(0.001, 1e9))
        ->type_name("SECONDS");
    command
        .add_option("--interval", limits.interval_s,
                    "keep frames at least this far apart in camera time, so that standing still "
                    "takes less room (default: all that the network keeps up with)")
        ->check(program::within(0.001, 3600))
        ->type_name("SECONDS");
}

} // namespace

void add_record(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "record", "Make an experience of a map from the running camera, on the robot");
    const auto options = std::make_shared<RecordOptions>();
    command->add_option("MAP", options->map, "directory of the map")->type_name("DIR")->required();
    command->add_option("NAME", options->name, "of the experience: it becomes MAP/NAME.vdna")
        ->type_name("NAME")
        ->required();
    command
        ->add_option("-l,--lcm-url", options->live.url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->add_option("--camera", options->live.camera, "camera channel")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command
        ->add_option("--pose-channel", options->live.pose_channel,
                     "channel with the robot's poses (bot_core.pose_t) or GPS fixes "
                     "(bot_core.gps_data_t), which give the frames their positions by time")
        ->type_name("CHANNEL");
    add_gap_option(*command, options->source.gps_gap_s);
    add_frame_option(*command, options->live.local_frame);
    add_time_options(*command, options->source);
    add_limit_options(*command, options->limits);
    add_network_options(*command, options->network, "that of the map");
    command
        ->add_option("--ranges", options->ranges,
                     "ranges file of `vdna calibrate`, or an experience file (default: the map's "
                     "ranges); needed to begin a map")
        ->type_name("FILE");
    command->add_flag("--no-thumbnails", options->no_thumbnails, "leave out the thumbnails");
    add_no_trust_option(*command, options->no_trust);
    command->add_flag("--force", options->force, "replace an existing experience");
    command->add_flag("--reload", options->reload,
                      "then tell vdna_selectord to open the map again, and print its answer");
    command->add_flag("--json", options->json, "report as JSON");
    command->footer(
        "Ends at Ctrl-C or SIGTERM, and then writes. Runs beside vdna_selectord, at low "
        "priority. Until the end the map is unchanged and locked for other writers.\n\n"
        "Examples:\n"
        "  vdna record route autumn --pose-channel POSE --frames-max 6000");
    command->callback([options] {
        options->live.time_unit = options->source.time_unit;
        options->live.late_s = options->source.late_s;
        record_drive(*options);
    });
}

} // namespace vdna::tool
