// vdna simulate - renders pictures of an imaginary route, for trials without a robot.
#include <memory>

#include <vdna/cpp/error.hpp>

#include "program/decimal.hpp"
#include "simulate/recording.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

struct Arguments {
    std::string out, condition = "summer", route = "line", size = "320x240";
    uint64_t seed = 7;
    bool sheet = false;
    simulate::DriveConfig drive;
    simulate::RecordingConfig recording;
};

void simulate(const Arguments &arguments)
{
    simulate::RecordingConfig recording = arguments.recording;
    const PictureSize size = parse_size(arguments.size, 16, 4096, "320x240");
    recording.size = cv::Size(static_cast<int>(size.width), static_cast<int>(size.height));
    const simulate::Route route(arguments.seed, arguments.route == "eight" ? simulate::Shape::eight
                                                                           : simulate::Shape::line);
    if (arguments.sheet) {
        simulate::write_sheet(arguments.out, route, arguments.drive, recording.size,
                              recording.frames, recording.quality);
        return;
    }
    const float variation = arguments.drive.variation;
    const simulate::Condition condition = simulate::on_another_day(
        simulate::find_condition(arguments.condition), variation, arguments.drive.seed);
    simulate::record_drive(arguments.out, route, condition, simulate::Drive(route, arguments.drive),
                           recording);
}

std::string condition_names(const std::string &between)
{
    std::string names;
    for (const simulate::Condition &condition : simulate::conditions())
        names += (names.empty() ? "" : between) + condition.name;
    return names;
}

void add_drive_options(CLI::App &command, simulate::DriveConfig &drive)
{
    command.add_option("--start", drive.start_m, "where the drive begins, metres along the route")
        ->check(program::within(-1e6, 1e6))
        ->type_name("M")
        ->capture_default_str();
    command
        .add_option("--step", drive.step_m, "metres from frame to frame; 0: a robot that stands")
        ->check(program::within(0, 1e3))
        ->type_name("M")
        ->capture_default_str();
    command.add_option("--rate", drive.rate_hz, "frames per second, for the time stamps")
        ->check(program::within(1e-3, 1e3))
        ->type_name("HZ")
        ->capture_default_str();
    command
        .add_option("--variation", drive.variation,
                    "deviation of this drive from the condition's plain look, the middle of the "
                    "path and the step")
        ->check(program::within(0, 1))
        ->type_name("0..1")
        ->capture_default_str();
    command.add_option("--drive", drive.seed, "seed of this drive's random numbers")
        ->type_name("N")
        ->capture_default_str();
}

void add_picture_options(CLI::App &command, Arguments &arguments)
{
    command.add_option("--condition", arguments.condition, "one of " + condition_names(", "))
        ->check(CLI::Validator("{" + condition_names(",") + "}"))
        ->type_name("NAME")
        ->capture_default_str();
    command
        .add_option("--seed", arguments.seed,
                    "seed of the world: the same seed gives the same route")
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--route", arguments.route,
                    "line: without end; eight: a figure of eight, " +
                        std::to_string(static_cast<int>(simulate::eight_length)) +
                        " metres a lap, that is driven again and again and passes its crossing "
                        "twice in each")
        ->check(CLI::IsMember({"line", "eight"}))
        ->type_name("NAME")
        ->capture_default_str();
    command.add_option("--frames", arguments.recording.frames, "pictures to render")
        ->check(CLI::Range(size_t{1}, size_t{999999}).description(""))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--size", arguments.size, "size of a picture, in pixels")
        ->type_name("WxH")
        ->capture_default_str();
    command.add_option("--quality", arguments.recording.quality, "quality of the JPEG files")
        ->check(CLI::Range(1, 100).description(""))
        ->type_name("1..100")
        ->capture_default_str();
}

} // namespace

void add_simulate(CLI::App &app)
{
    const auto arguments = std::make_shared<Arguments>();
    CLI::App *command = app.add_subcommand(
        "simulate", "Render a drive along an imaginary route: pictures and labels.csv");
    command->add_option("OUT", arguments->out, "directory to write")->type_name("PATH")->required();
    add_picture_options(*command, *arguments);
    add_drive_options(*command, arguments->drive);
    command->add_flag("--force", arguments->recording.force, "replace an earlier recording");
    command->add_flag("--sheet", arguments->sheet,
                      "write one picture file instead, with a row for each condition and a column "
                      "for each of --frames places");
    command->footer("Examples:\n"
                    "  vdna simulate winter/ --condition winter\n"
                    "  vdna simulate live/ --condition spring --variation 0.6 --drive 2\n"
                    "  vdna simulate conditions.jpg --sheet --frames 5 --start 12 --step 31 "
                    "--size 160x120 --quality 80");
    command->callback([arguments] { simulate(*arguments); });
}

} // namespace vdna::tool
