// Processor affinity and niceness of the daemon.
#pragma once

#include "selectord/config.hpp"

namespace vdna::selectord
{

// Apply [cpu] to this thread; threads started later inherit it. Throws Error if a setting is
// invalid or not permitted.
void take_processors(const Config &config);

} // namespace vdna::selectord
