// Pages of mapped files that are gone because somebody cut a file short. Reading one raises SIGBUS,
// which ends a process; here it reads as zeros instead, and is counted, so that whoever reads a
// mapped file asks afterwards whether what it read was there.
#pragma once

#include <cstdint>

namespace vdna::selectord
{

// From now on, in all threads.
void survive_lost_pages();

// How often that happened so far.
uint32_t lost_pages();

} // namespace vdna::selectord
