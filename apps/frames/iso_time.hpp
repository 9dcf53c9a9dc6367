// Times as people and GPX files write them: ISO 8601, 2024-05-01T12:00:00.5+02:00.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace vdna::frames
{

// Microseconds since 1970 of a date and time with seconds; fractions beyond microseconds are cut
// off. 'T' or a blank between them, 'Z' or an offset behind; UTC where there is neither. A leap
// second is the first of the next minute. Nothing if the text is anything else, or not a day of the
// calendar.
std::optional<int64_t> utime_of_iso(const std::string &text);

// UTC to the millisecond: "2024-05-01T10:00:00.500Z".
std::string iso_of(int64_t utime);

// The same of a frame's time; "" if it does not count from 1970 by the rule of vdna/camera_time.h:
// most of those that count from the start of a machine or a video.
std::string date_of(int64_t utime);

} // namespace vdna::frames
