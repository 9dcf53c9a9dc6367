#include "usage/completion.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

namespace vdna::usage
{

namespace
{

// Where the installed networks are, as lib/backbone looks for them; %s is the program.
constexpr const char *bash_networks = R"sh(
    local folder file program
    program=$(type -P %s)
    for folder in "$VDNA_MODELS" "${program%/*}/../share/vdna/models"; do
        for file in "$folder"/*.toml; do
            [ ! -e "$file" ] || basename "$file" .toml
        done
    done
)sh";

constexpr const char *zsh_networks = R"sh(
    local folder
    local -a networks
    for folder in "$VDNA_MODELS" "${commands[%s]:h}/../share/vdna/models"; do
        networks+=("$folder"/*.toml(N:t:r))
    done
    compadd -a networks
)sh";

// What is under the cursor: --option=value is three words to bash.
constexpr const char *bash_begin = R"sh(
    local command=%s current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
    local word words='' types=''
    for word in "${COMP_WORDS[@]:1:COMP_CWORD - 1}"; do
        case "$command $word" in
        %c) command+=" $word" ;;
        esac
    done
    [ "$current" != = ] || current=''
    [ "$before" != = ] || before=${COMP_WORDS[COMP_CWORD - 2]}
)sh";

constexpr const char *bash_end = R"sh(
    COMPREPLY=()
    case $types in
    *networks*) words+=" $(%f_networks)" ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    case $types in
    *files*) mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$current") ;;
    *folders*) mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -d -- "$current") ;;
    esac
    case $types in
    *files* | *folders*) compopt -o filenames 2>/dev/null ;;
    esac
)sh";

std::string with(std::string text, const std::string &mark, const std::string &value)
{
    for (size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
        text.replace(at, mark.size(), value);
    return text;
}

// As one word of a shell.
std::string quoted(const std::string &text)
{
    std::string word = "'";
    for (const char c : text)
        word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
} // namespace

std::string joined(const std::vector<std::string> &parts, const std::string &between)
{
    std::string text;
    for (const std::string &part : parts)
        text += (text.empty() ? "" : between) + part;
    return text;
}

// "networks", "files" and "folders", as the type of an argument says.
std::set<std::string> types_of(const Argument &argument)
{
    std::set<std::string> types;
    std::istringstream alternatives(argument.type);
    for (std::string type; std::getline(alternatives, type, '|');) {
        if (type == "NETWORK")
            types.insert("networks");
        if (type == "DIR")
            types.insert("folders");
        if (type == "FILE" || type == "PATH")
            types.insert("files");
    }
    return types;
}

std::string types_text(const std::set<std::string> &types)
{
    return joined({types.begin(), types.end()}, " ");
}

std::string function_of(const std::string &name)
{
    std::string function = "_" + name;
    std::replace_if(
        function.begin(), function.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
    return function;
}

std::string last_word(const std::string &name)
{
    return name.substr(name.rfind(' ') + 1);
}

void visit(const Command &command, const std::function<void(const Command &)> &see)
{
    see(command);
    for (const Command &sub : command.commands)
        visit(sub, see);
}

// What may follow each option that a value follows.
std::string bash_values(const Command &command)
{
    std::string cases;
    for (const Argument &option : command.options) {
        if (option.value.empty())
            continue;
        std::vector<std::string> names;
        for (const std::string &name : option.names)
            names.push_back(quoted(command.name + " " + name));
        cases += "    " + joined(names, " | ") + ") words=" + quoted(joined(option.words, " ")) +
                 " types=" + quoted(types_text(types_of(option))) + " ;;\n";
    }
    return cases;
}

// What may follow anything else.
std::string bash_words(const Command &command)
{
    std::vector<std::string> options, words;
    std::set<std::string> types;
    for (const Argument &option : command.options)
        options.insert(options.end(), option.names.begin(), option.names.end());
    for (const Command &sub : command.commands)
        words.push_back(last_word(sub.name));
    for (const Argument &positional : command.positionals) {
        words.insert(words.end(), positional.words.begin(), positional.words.end());
        types.merge(types_of(positional));
    }
    const bool has_options_only = words.empty() && types.empty();
    return "        " + quoted(command.name) +
           ")\n            case $current in\n            -*) words=" +
           quoted(joined(options, " ")) +
           " ;;\n            *) words=" + quoted(joined(has_options_only ? options : words, " ")) +
           " types=" + quoted(types_text(types)) + " ;;\n            esac\n            ;;\n";
}

// For the inside of a specification of _arguments, in brackets or between colons.
std::string zsh_text(const std::string &text)
{
    std::string escaped;
    for (const char c : text)
        escaped += (c == '[' || c == ']' || c == ':' || c == '\\' ? "\\" : "") + std::string(1, c);
    return escaped;
}

std::string zsh_action(const std::string &program, const Argument &argument)
{
    const std::set<std::string> types = types_of(argument);
    if (!argument.words.empty())
        return "(" + joined(argument.words, " ") + ")";
    if (types.count("networks"))
        return "{" + function_of(program) + "_networks; _files}";
    if (types.count("files"))
        return "_files";
    return types.count("folders") ? "_files -/" : " ";
}

void add_zsh_option(const std::string &program, const Argument &option,
                    std::vector<std::string> &specifications)
{
    for (const std::string &name : option.names) {
        const bool may_join = !option.value.empty() && name.rfind("--", 0) == 0;
        specifications.push_back(
            quoted((option.is_many ? "*" : "(" + joined(option.names, " ") + ")") + name +
                   (may_join ? "=" : "") + "[" + zsh_text(option.about) + "]" +
                   (option.value.empty()
                        ? ""
                        : ":" + zsh_text(option.value) + ":" + zsh_action(program, option))));
    }
}

std::string zsh_function(const std::string &program, const Command &command)
{
    std::vector<std::string> specifications;
    for (const Argument &option : command.options)
        add_zsh_option(program, option, specifications);
    for (const Argument &positional : command.positionals)
        specifications.push_back(quoted((positional.is_many ? "*:" : ":") +
                                        zsh_text(positional.names.front()) + ":" +
                                        zsh_action(program, positional)));
    if (command.commands.empty())
        return function_of(command.name) + "()\n{\n    _arguments -s -S : \\\n        " +
               joined(specifications, " \\\n        ") + "\n}\n\n";

    std::string names, cases;
    for (const Command &sub : command.commands) {
        const std::string name = last_word(sub.name);
        names += "        " + quoted(with(name, ":", "\\:") + ":" + sub.about) + "\n";
        cases += "        " + name + ") " + function_of(sub.name) + " ;;\n";
    }
    specifications.insert(specifications.end(),
                          {"':command:->command'", "'*::argument:->argument'"});
    return function_of(command.name) +
           "()\n{\n    local curcontext=$curcontext state line\n    local -a names\n"
           "    names=(\n" +
           names + "    )\n    _arguments -C -s -S : \\\n        " +
           joined(specifications, " \\\n        ") +
           "\n    case $state in\n    command) _describe command names ;;\n    argument)\n"
           "        case $line[1] in\n" +
           cases + "        esac\n        ;;\n    esac\n}\n\n";
}

} // namespace

std::string bash_completion(const Command &program)
{
    const std::string function = function_of(program.name);
    std::string values, words;
    std::vector<std::string> commands;
    visit(program, [&](const Command &command) {
        values += bash_values(command);
        words += bash_words(command);
        if (command.name != program.name)
            commands.push_back(quoted(command.name));
    });
    if (commands.empty())
        commands.emplace_back("''");
    return "# Completion of " + program.name + " in bash; made from its command line.\n" +
           function + "_networks()\n{" + with(bash_networks, "%s", program.name) + "}\n\n" +
           function + "()\n{" +
           with(with(bash_begin, "%s", program.name), "%c", joined(commands, " | ")) +
           "    case \"$command $before\" in\n" + values + "    *)\n        case $command in\n" +
           words + "        esac\n        ;;\n    esac" + with(bash_end, "%f", function) +
           "}\ncomplete -F " + function + " " + program.name + "\n";
}

std::string zsh_completion(const Command &program)
{
    const std::string function = function_of(program.name);
    std::string functions;
    visit(program, [&](const Command &command) {
        if (command.name != program.name)
            functions += zsh_function(program.name, command);
    });
    return "#compdef " + program.name + "\n# Completion in zsh; made from the command line of " +
           program.name + ".\n" + function + "_networks()\n{" +
           with(zsh_networks, "%s", program.name) + "}\n\n" + functions +
           zsh_function(program.name, program) + function + " \"$@\"\n";
}

} // namespace vdna::usage
