#include "selectord/operator_commands.hpp"

#include <algorithm>

#include <vdna_msg_command_t.h>

#include <vdna/identity.h>

namespace vdna::selectord
{

namespace
{

// Most bytes of a list of names: a result is a sentence, not a listing of thousands.
constexpr size_t list_max = 1000;

// The index of an experience; VDNA_SELECT_NONE if none has this name.
uint32_t find(const MapSession &session, const std::string &name)
{
    const std::vector<vdna_experience> &all = session.experiences();
    const auto found = std::find_if(all.begin(), all.end(), [&](const vdna_experience &experience) {
        return name == experience.name;
    });
    return found == all.end() ? VDNA_SELECT_NONE : static_cast<uint32_t>(found - all.begin());
}

std::string names_in(const MapSession &session)
{
    std::string names;
    for (const vdna_experience &experience : session.experiences()) {
        if (names.size() > list_max)
            return names + ", ...";
        names += (names.empty() ? "" : ", ") + std::string(experience.name);
    }
    return names;
}

Outcome no_such(const MapSession &session, const std::string &name)
{
    return {false, "no experience is called " + name + "; the map has " + names_in(session)};
}

Outcome unpin(MapSession &session)
{
    vdna_select *const select = session.select();
    if (vdna_select_pinned(select) == VDNA_SELECT_NONE)
        return {true, "nothing is pinned"};
    vdna_select_pin(select, VDNA_SELECT_NONE);
    return {true, vdna_select_has_choice(select)
                      ? std::string("nothing is pinned any more, localising in ") +
                            session.experiences()[vdna_select_chosen(select)].name
                      : "nothing is pinned any more, warming up"};
}

Outcome exclude(MapSession &session, const std::string &name)
{
    const uint32_t candidate = find(session, name);
    if (candidate == VDNA_SELECT_NONE)
        return no_such(session, name);
    if (candidate == vdna_select_pinned(session.select()))
        return {false, name + " is pinned; unpin it first"};
    if (vdna_select_exclude(session.select(), candidate, 1) != VDNA_OK)
        return {false, name + " is the only experience that may be chosen; include another first"};
    return {true, name + " is excluded"};
}

Outcome include(MapSession &session, const std::string &name)
{
    vdna_select *const select = session.select();
    const uint32_t candidate = find(session, name);
    if (!name.empty() && candidate == VDNA_SELECT_NONE)
        return no_such(session, name);
    for (uint32_t i = 0; i < session.experiences().size(); i++)
        if (name.empty() || i == candidate)
            vdna_select_exclude(select, i, 0);
    return {true, (name.empty() ? "all experiences" : name) + " may be chosen"};
}

Outcome shadow(MapSession &session, const std::string &state)
{
    if (state != "on" && state != "off")
        return {false,
                "the argument is " + (state.empty() ? "empty" : state) + ", expected on or off"};
    vdna_select_shadow(session.select(), state == "on" ? 1 : 0);
    return {true, state == "on" ? "recommending only, the choice stays"
                                : "acting again, the choice follows the ranking"};
}

} // namespace

Outcome pin(MapSession &session, const std::string &name)
{
    if (name.empty())
        return unpin(session);
    const uint32_t candidate = find(session, name);
    if (candidate == VDNA_SELECT_NONE)
        return no_such(session, name);
    if (vdna_select_pin(session.select(), candidate) != VDNA_OK)
        return {false, name + " is excluded; include it first"};
    return {true, name + " is pinned, localising in it"};
}

Outcome carry_out(MapSession &session, const vdna_transport_command &command)
{
    const std::string argument = command.argument;
    // Anybody may send anything, and the sentence repeats it.
    if (!argument.empty() && (command.argument_bytes != argument.size() ||
                              vdna_name_check(argument.c_str(), nullptr) != VDNA_OK))
        return {false, "the argument, of " + std::to_string(command.argument_bytes) +
                           " bytes, is not a name; the map has " + names_in(session)};
    switch (command.command) {
    case VDNA_MSG_COMMAND_T_PIN:
        return pin(session, argument);
    case VDNA_MSG_COMMAND_T_EXCLUDE:
        return exclude(session, argument);
    case VDNA_MSG_COMMAND_T_INCLUDE:
        return include(session, argument);
    case VDNA_MSG_COMMAND_T_SHADOW:
        return shadow(session, argument);
    default:
        return {false, "command " + std::to_string(command.command) +
                           " is not known to this version, expected 1 (RESET) to 6 (SHADOW)"};
    }
}

std::string carry_over(const MapSession &from, MapSession &to)
{
    const vdna_select *const before = from.select();
    vdna_select *const after = to.select();
    const auto name_of = [&](uint32_t candidate) { return from.experiences()[candidate].name; };
    std::string lost;
    const auto lose = [&lost](const std::string &name, const char *what) {
        lost += "; " + name + " is no longer " + what;
    };

    for (uint32_t i = 0; i < from.experiences().size(); i++)
        if (vdna_select_is_excluded(before, i))
            if (vdna_select_exclude(after, find(to, name_of(i)), 1) != VDNA_OK)
                lose(name_of(i), "excluded: it is not in this map, or all that is left of it");
    // What is pinned before shadow begins is what shadow keeps.
    vdna_select_shadow(after, vdna_select_in_shadow(before));
    if (vdna_select_in_shadow(before) && vdna_select_has_choice(before)) {
        const std::string choice = name_of(vdna_select_chosen(before));
        if (!pin(to, choice).accepted)
            lose(choice, "kept by shadow: it is not in this map");
        vdna_select_pin(after, VDNA_SELECT_NONE);
    }
    if (const uint32_t pinned = vdna_select_pinned(before); pinned != VDNA_SELECT_NONE)
        if (!pin(to, name_of(pinned)).accepted)
            lose(name_of(pinned), "pinned: it is not in this map");
    return lost;
}

void list_excluded(const MapSession &session, std::vector<char *> &names)
{
    for (uint32_t i = 0; i < session.experiences().size(); i++)
        if (vdna_select_is_excluded(session.select(), i))
            names.push_back(
                const_cast<char *>(session.experiences()[i].name)); // publishing changes nothing
}

} // namespace vdna::selectord
