// Ctrl-C and SIGTERM as a flag that long work polls between two steps.
#pragma once

namespace vdna::program
{

// From now on the first SIGINT or SIGTERM is only recorded, and blocking calls return EINTR; the
// second one ends the program as usual. Call once, early in main().
void catch_interrupts();

// True after a signal.
bool interrupted();

// For work that a signal ends well: from now on interrupted() is false until the next signal, which
// is again only recorded.
void forget_interrupt();

// Throws Error with exit_interrupted after a signal.
void require_not_interrupted();

} // namespace vdna::program
