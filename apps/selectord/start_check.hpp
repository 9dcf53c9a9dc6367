// What a network must do before the daemon is ready.
#pragma once

#include <vdna/cpp/backbone.hpp>

namespace vdna::selectord
{

// Run a picture that is made here twice. Throws Error if the network gives numbers that are not
// finite, or other ones the second time: memory, processor or plug-in are then not to be trusted.
// Its numbers are not compared with known ones, since none are kept for a network: its file is
// pinned by SHA-256 in the manifest. Other errors are left to the frames.
void require_repeatable(const Backbone &backbone);

} // namespace vdna::selectord
