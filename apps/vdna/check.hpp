// The sentence for a call of the C99 core that fails: it has a status but no text of its own.
#pragma once

#include <string>

#include <vdna/status.h>

#include "error.hpp"

namespace vdna
{

// Throw unless the call went well. `where` names the file or frame that was worked on.
inline void require_ok(vdna_status status, const std::string &where)
{
    if (status != VDNA_OK)
        throw Error(where + ": " + vdna_status_text(status));
}

} // namespace vdna
