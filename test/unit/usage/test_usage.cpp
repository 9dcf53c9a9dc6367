// Help, manual page and completion of a small command line.
#include <cstdlib>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

#include "cmocka.hpp" // whose fail() is a macro, after CLI11, which has a member of that name
#include "usage/completion.hpp"
#include "usage/help.hpp"
#include "usage/manual_page.hpp"

namespace
{

using namespace vdna::usage;

// A program with one sub-command that has something of everything.
Command small_program()
{
    static double rate = 2.5;
    static std::string text;
    static std::vector<std::string> sources;
    static bool flag = false;
    CLI::App app("Do something", "tool");
    add_standard_options(app, "tool 1");
    CLI::App *make = app.add_subcommand("make", "Make a thing of SOURCEs");
    make->add_option("SOURCE", sources, "folder of pictures")->type_name("DIR")->required();
    make->add_option("-r,--rate", rate, "pictures per second; more of them need more room")
        ->type_name("HZ")
        ->capture_default_str();
    CLI::Option *way = make->add_option("--way", text, "how to do it")
                           ->check(CLI::IsMember({"quick", "slow"}))
                           ->type_name("NAME");
    make->add_flag("--json", flag, "report as JSON")->excludes(way);
    make->add_option("--net", text, "network")->type_name("NETWORK|PATH");
    make->add_option("--hidden", text)->group("");
    make->footer("A note that goes\non in a second line.\n\n"
                 "Examples:\n"
                 "  tool make --rate 3 --way quick winter/ summer/ autumn/ spring/\n"
                 "  tool make 'a b'");
    return described(app, "tool");
}

void help_wraps_and_keeps_examples_as_commands(void **)
{
    const Command tool = small_program();
    assert_string_equal(help_of(tool.commands.at(0), 60).c_str(),
                        "Usage: tool make [OPTION]... SOURCE...\n"
                        "\n"
                        "Make a thing of SOURCEs\n"
                        "\n"
                        "Arguments:\n"
                        "  SOURCE...         folder of pictures\n"
                        "\n"
                        "Options:\n"
                        "  -h, --help        print this help and exit\n"
                        "  -r, --rate HZ     pictures per second; more of them need\n"
                        "                    more room (default: 2.5)\n"
                        "  --way NAME        how to do it; not with --json\n"
                        "  --json            report as JSON; not with --way\n"
                        "  --net NETWORK|PATH\n"
                        "                    network\n"
                        "\n"
                        "A note that goes on in a second line.\n"
                        "\n"
                        "Examples:\n"
                        "  tool make --rate 3 --way quick winter/ summer/ autumn/ \\\n"
                        "      spring/\n"
                        "  tool make 'a b'\n");
    assert_string_equal(help_of(tool, 60).c_str(),
                        "Usage: tool [OPTION]... COMMAND ...\n"
                        "\n"
                        "Do something\n"
                        "\n"
                        "Options:\n"
                        "  -h, --help        print this help and exit\n"
                        "  --version         print the version and exit\n"
                        "\n"
                        "Commands:\n"
                        "  make              Make a thing of SOURCEs\n");
}

void help_is_as_wide_as_the_terminal_within_limits(void **)
{
    for (const auto &[columns, width] : {std::pair("72", 72), {"300", 100}, {"10", 40}}) {
        setenv("COLUMNS", columns, 1);
        assert_int_equal(help_width(), width);
    }
    for (const char *nothing : {"", "0", "wide"}) {
        setenv("COLUMNS", nothing, 1);
        assert_true(help_width() >= help_width_min && help_width() <= help_width_max);
    }
}

void the_manual_page_has_each_option_once_and_no_request_of_a_text(void **)
{
    assert_string_equal(manual_sections(small_program()).c_str(),
                        ".SH OPTIONS\n"
                        ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\n\\&print this help and exit\n"
                        ".TP\n\\fB\\-\\-version\\fR\n\\&print the version and exit\n"
                        ".SH COMMANDS\n"
                        ".SS tool make [OPTION]... SOURCE...\n"
                        "\\&Make a thing of SOURCEs.\n"
                        ".TP\n\\fISOURCE\\fR...\n\\&folder of pictures\n"
                        ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\n\\&print this help and exit\n"
                        ".TP\n\\fB\\-r\\fR, \\fB\\-\\-rate\\fR \\fIHZ\\fR\n"
                        "\\&pictures per second; more of them need more room (default: 2.5)\n"
                        ".TP\n\\fB\\-\\-way\\fR \\fINAME\\fR\n"
                        "\\&how to do it; not with \\-\\-json\n"
                        ".TP\n\\fB\\-\\-json\\fR\n\\&report as JSON; not with \\-\\-way\n"
                        ".TP\n\\fB\\-\\-net\\fR \\fINETWORK|PATH\\fR\n\\&network\n"
                        ".PP\n\\&A note that goes on in a second line.\n"
                        ".PP\n.nf\n"
                        "\\&tool make \\-\\-rate 3 \\-\\-way quick winter/ summer/ autumn/ "
                        "spring/\n"
                        "\\&tool make 'a b'\n.fi\n");
}

void assert_has(const std::string &text, const std::string &part)
{
    if (text.find(part) == std::string::npos)
        fail_msg("expected '%s' in:\n%s", part.c_str(), text.c_str());
}

void completion_knows_words_types_and_hides_what_is_hidden(void **)
{
    const std::string bash = bash_completion(small_program());
    assert_has(bash, "'tool make -r' | 'tool make --rate') words='' types='' ;;");
    assert_has(bash, "'tool make --way') words='quick slow' types='' ;;");
    assert_has(bash, "'tool make --net') words='' types='files networks' ;;");
    assert_has(bash, "*) words='make' types='' ;;");
    assert_has(bash, "*) words='' types='folders' ;;");
    const std::string zsh = zsh_completion(small_program());
    assert_has(zsh, "'(-r --rate)--rate=[pictures per second; more of them need more room]:HZ: '");
    assert_has(zsh, "'(--way)--way=[how to do it; not with --json]:NAME:(quick slow)'");
    assert_has(zsh, "'*:SOURCE:_files -/'");
    assert_true((bash + zsh).find("hidden") == std::string::npos);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(help_wraps_and_keeps_examples_as_commands),
        cmocka_unit_test(help_is_as_wide_as_the_terminal_within_limits),
        cmocka_unit_test(the_manual_page_has_each_option_once_and_no_request_of_a_text),
        cmocka_unit_test(completion_knows_words_types_and_hides_what_is_hidden),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
