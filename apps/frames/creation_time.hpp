// When a video says that it was made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace vdna::frames
{

// The creation time of an MP4 or MOV file, in microseconds since 1970; nothing if it has none.
// Cameras write when they began or when they ended, to the second, so it is a hint and no time
// stamp.
std::optional<int64_t> creation_time_of(const std::filesystem::path &video);

} // namespace vdna::frames
