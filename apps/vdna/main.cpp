// vdna - one command for maps. Each sub-command has its own file.
#include <iostream>

#include <vdna/cpp/error.hpp>

#include "doctor/doctor.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "vdna/command_line.hpp"

namespace
{

int fail(const std::string &sentence, int code)
{
    std::cerr << "vdna: " << sentence << '\n';
    return code;
}

// Parse the command line; the sub-command's callback does the work.
vdna::program::ExitCode run(CLI::App &app, int argc, char **argv)
{
    vdna::program::ExitCode code = vdna::program::exit_ok;
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty())
            std::cout << app.help();
    } catch (const CLI::Success &request) {
        app.exit(request); // prints the answer to --help and --version
    } catch (const vdna::program::NoneFits &) {
        code = vdna::program::exit_none_fits;
    } catch (const vdna::doctor::Unwell &) {
        code = vdna::program::exit_failed;
    }
    // Detect a full disk or a closed pipe, so that half a report does not count as success.
    if (!std::cout.flush())
        throw vdna::Error("standard output: cannot write");
    return code;
}

} // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): only of options that clash
int main(int argc, char **argv)
{
    vdna::program::catch_interrupts();
    const std::unique_ptr<CLI::App> app = vdna::tool::command_line();
    try {
        return run(*app, argc, argv);
    } catch (const CLI::ParseError &e) {
        return fail(std::string(e.what()) + "; see vdna --help", vdna::program::exit_usage);
    } catch (const vdna::Error &e) {
        return fail(e.what(), vdna::program::exit_code_of(e));
    } catch (const std::exception &e) {
        return fail(e.what(), vdna::program::exit_failed);
    }
}
