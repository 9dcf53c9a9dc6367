// What an operator may tell the daemon about the choice, by the names of experiences.
#pragma once

#include <string>
#include <vector>

#include <vdna/transport.h>

#include "selectord/map_session.hpp"

namespace vdna::selectord
{

// What became of a command, in a sentence for people.
struct Outcome {
    bool accepted; // otherwise nothing has changed
    std::string text;
};

// Pin an experience; "" = none any more.
Outcome pin(MapSession &session, const std::string &name);

// PIN, EXCLUDE, INCLUDE or SHADOW; any other is refused.
Outcome carry_out(MapSession &session, const vdna_transport_command &command);

// Pin, exclude and shadow as in another map, by name, and in shadow keep its choice. Returns what
// was left out, as a clause such as "; winter is no longer pinned: it is not in this map", or "".
std::string carry_over(const MapSession &from, MapSession &to);

// Append the names of what is excluded; borrowed from the session.
void list_excluded(const MapSession &session, std::vector<char *> &names);

} // namespace vdna::selectord
