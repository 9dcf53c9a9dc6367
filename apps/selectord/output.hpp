// Standard output and standard error of a daemon.
#pragma once

namespace vdna::selectord
{

// From now on a line that its reader leaves no room for is lost, whoever writes it: the daemon must
// not wait for somebody who has stopped to read. Others who write to the same pipe or terminal
// are not affected. A file has always room.
void never_wait_for_readers();

} // namespace vdna::selectord
