// Fields of CSV files (RFC 4180).
#pragma once

#include <string>

namespace vdna::report
{

// In quotation marks if it needs them.
inline std::string csv_field(const std::string &text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos)
        return text;
    std::string field = "\"";
    for (const char c : text)
        field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + "\"";
}

} // namespace vdna::report
