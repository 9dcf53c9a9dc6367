// The process of a network: opens it, and runs the pictures of the mailbox, until the daemon ends.
#pragma once

namespace vdna::selectord
{

// The command line of vdna_selectord by which the daemon starts it; for nobody else.
constexpr const char *backbone_process_option = "--backbone-process";

// Whether a command line is that one.
bool is_backbone_child(int argc, const char *const *argv);

// Run it, on the files of backbone_mailbox.hpp. Gives the exit code.
int run_backbone_child();

} // namespace vdna::selectord
