// Ctrl-C and SIGTERM as a question that long work asks between two steps.
#pragma once

namespace vdna::program
{

// From now on the first SIGINT or SIGTERM is only remembered, and blocking calls return with
// EINTR; the second one ends the program as usual. Call once, early in main().
void catch_interrupts();

// True once a signal has come in.
bool interrupted();

// Throws Error with exit_interrupted once a signal has come in.
void require_not_interrupted();

} // namespace vdna::program
