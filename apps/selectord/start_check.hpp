// What a network must do before the daemon is ready.
#pragma once

#include <vdna/cpp/backbone.hpp>

namespace vdna::selectord
{

// Run the test picture twice. Throws Error if the network gives numbers that are not finite, or
// other ones the second time: memory, processor or plug-in are then not to be trusted. Known
// numbers, if the manifest has them, were compared when it was opened. Other errors are left to the
// frames.
void require_repeatable(const Backbone &backbone);

} // namespace vdna::selectord
