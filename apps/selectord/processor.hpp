// Which processors the daemon runs on, and before whom.
#pragma once

#include "selectord/config.hpp"

namespace vdna::selectord
{

// Apply [cpu] to this thread; those that it starts inherit it. Throws Error if the setting makes no
// sense or is not permitted.
void take_processors(const Config &config);

} // namespace vdna::selectord
