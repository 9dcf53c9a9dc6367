// The command lines of our programs have one style, and their examples are understood.
#include <algorithm>
#include <cctype>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "cmocka.hpp" // whose fail() is a macro, after CLI11, which has a member of that name
#include "folder.hpp"
#include "selectord/command_line.hpp"
#include "serve/command_line.hpp"
#include "usage/help.hpp"
#include "vdna/command_line.hpp"

namespace
{

using namespace vdna;
using usage::Argument;
using usage::Command;

std::vector<Command> programs()
{
    return {usage::described(*tool::command_line(), "vdna"), serve::described_command_line(),
            selectord::described_command_line()};
}

void for_each(const std::function<void(const Command &)> &see)
{
    std::vector<Command> all = programs();
    for (size_t i = 0; i < all.size(); i++) {
        const Command command = all[i];
        all.insert(all.end(), command.commands.begin(), command.commands.end());
        if (!command.is_program) // it describes itself
            see(command);
    }
    assert_true(all.size() > 15);
}

// "Show", "LCM": not "show"; for the first letter of an option's text the other way round.
bool begins_small(const std::string &text)
{
    const auto is_large = [&](size_t i) {
        return i < text.size() && (std::isupper(text[i]) || std::isdigit(text[i]));
    };
    return !text.empty() && (!is_large(0) || is_large(1));
}

void expect(bool is_so, const std::string &where, const char *what)
{
    if (!is_so)
        fail_msg("%s: expected %s", where.c_str(), what);
}

void check_argument(const Command &command, const Argument &argument)
{
    const std::string where = command.name + ": " + argument.names.front();
    const bool is_option = argument.names.front()[0] == '-';
    expect(begins_small(argument.about), where, "a text that begins with a small letter");
    expect(argument.about.back() != '.', where, "a text without a full stop");
    expect(argument.about.find("; default:") == std::string::npos, where, "'(default: ...)'");
    for (const char *unnamed : {"TEXT", "INT", "UINT", "FLOAT"})
        expect(argument.type != unnamed, where, "type_name() to say what the value is");
    expect(argument.type.find_first_of("{ ") == std::string::npos, where,
           "a name for the value: check(...).description(\"\")");
    if (!is_option)
        expect(!argument.type.empty() && std::isupper(argument.names.front()[0]), where,
               "a name in capitals, and type_name() DIR, PATH, NAME, N");
}

void all_have_one_style(void **)
{
    for_each([](const Command &command) {
        expect(std::isupper(command.about.front()) && command.about.back() != '.', command.name,
               "a sentence without a full stop");
        for (const std::string &note : command.notes)
            expect(note.back() == '.', command.name + ": " + note, "a full stop");
        for (const Argument &argument : command.positionals)
            check_argument(command, argument);
        for (const Argument &argument : command.options)
            check_argument(command, argument);
    });
}

void help_fits_every_width(void **)
{
    for_each([](const Command &command) {
        for (const size_t width : {60, 80, 100}) {
            std::istringstream help(usage::help_of(command, width));
            for (std::string line; std::getline(help, line);)
                expect(line.size() <= width, line, ("at most " + std::to_string(width)).c_str());
        }
    });
}

// The words of a command line, without quotes, up to what is the shell's.
std::vector<std::string> words_of(const std::string &line)
{
    std::vector<std::string> words(1);
    bool is_quoted = false;
    for (const char c : line) {
        if (c == '\'')
            is_quoted = !is_quoted;
        else if (c == ' ' && !is_quoted)
            words.emplace_back();
        else
            words.back() += c;
    }
    const auto is_of_shell = [](const std::string &word) {
        return word == "&&" || word == "|" || word[0] == '>';
    };
    words.erase(std::find_if(words.begin(), words.end(), is_of_shell), words.end());
    return words;
}

void parse(const std::vector<std::string> &words)
{
    std::vector<const char *> argv;
    for (const std::string &word : words)
        argv.push_back(word.c_str());
    const int argc = static_cast<int>(argv.size());
    if (words.at(0) == "vdna_selectord") {
        selectord::read_command_line(argc, argv.data());
    } else if (words.at(1) == "serve") {
        serve::read_command_line(argc - 1, argv.data() + 1);
    } else {
        const std::unique_ptr<CLI::App> app = tool::command_line();
        app->parse_complete_callback([] { throw CLI::Success(); }); // before a command's work
        try {
            app->parse(argc, argv.data());
            fail_msg("nothing would be done");
        } catch (const CLI::Success &) {
        }
    }
}

void every_example_is_understood(void **)
{
    const Folder folder;
    folder.write("vdna.toml", "[map]\ndirectory = 'map'\n");
    assert_int_equal(chdir(folder.path().c_str()), 0);
    for_each([](const Command &command) {
        expect(!command.examples.empty(), command.name, "Examples: at the end of its footer");
        for (const std::string &example : command.examples) {
            const size_t begin = example.find("vdna");
            expect(begin != std::string::npos, example, "a command of ours");
            try {
                parse(words_of(example.substr(begin)));
            } catch (const std::exception &error) {
                fail_msg("%s: %s", example.c_str(), error.what());
            }
        }
    });
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(all_have_one_style),
        cmocka_unit_test(help_fits_every_width),
        cmocka_unit_test(every_example_is_understood),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
