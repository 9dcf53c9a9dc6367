// CSV text (RFC 4180): quoted fields, CRLF or LF, a header row.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vdna::frames
{

// One row and where it began.
struct CsvRow {
    size_t line; // from 1
    std::vector<std::string> fields;
};

// A table whose rows all have as many fields as its header.
struct CsvTable {
    std::map<std::string, size_t> columns; // name to position
    std::vector<CsvRow> rows;              // without the header
};

// Throws Error with file and line.
CsvTable read_csv(const std::filesystem::path &path);

} // namespace vdna::frames
