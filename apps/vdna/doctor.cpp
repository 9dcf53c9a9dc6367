// vdna doctor - what is wrong with this robot, and how to mend it.
#include "doctor/doctor.hpp"

#include <iostream>

#include "program/decimal.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct DoctorOptions {
    doctor::Named named;
    double seconds = 3;
    std::string root = "/";
    bool json = false;
};

void examine(const DoctorOptions &options)
{
    const doctor::Diagnosis diagnosis =
        doctor::examine(options.named, options.seconds, options.root);
    if (options.json)
        program::print_json(doctor::json_of(diagnosis));
    else
        std::cout << doctor::screen_of(diagnosis);
    if (doctor::has_failed(diagnosis))
        throw doctor::Unwell();
}

} // namespace

void add_doctor(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("doctor", "Say what is wrong with this robot, and how to mend it");
    const auto options = std::make_shared<DoctorOptions>();
    command
        ->add_option("-c,--config", options->named.file,
                     "settings of vdna_selectord (default: " +
                         std::string(doctor::packaged_settings) + " if it is there)")
        ->type_name("FILE");
    command
        ->add_option("--map", options->named.map, "directory of the map, in place of the settings'")
        ->type_name("DIR");
    command
        ->add_option(
            "-l,--lcm-url", options->named.url,
            "LCM network, in place of the settings' (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->add_option("--for", options->seconds, "listen for this time")
        ->type_name("SECONDS")
        ->check(program::within(0.1, 3600))
        ->capture_default_str();
    command->add_flag("--json", options->json, "report as JSON");
    // Of /proc, /sys and /etc; for tests.
    command->add_option("--root", options->root)->group("");
    command->footer(
        "ok: as it should be; --: cannot be said, for lack of what the check needs; warn: "
        "works, but may be better; FAIL: does not work. The line below says what mends "
        "it. Nothing is changed, and no daemon needs to run.\n\n"
        "Exit codes: 0 nothing fails, 1 something fails, 2 wrong usage.\n\n"
        "Examples:\n"
        "  vdna doctor\n"
        "  vdna doctor -c vdna.toml --for 10");
    command->callback([options] { examine(*options); });
}

} // namespace vdna::tool
