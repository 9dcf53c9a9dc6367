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

// Blanks around a column's name are dropped. Throws Error with file and line, and says what it is
// if the columns are not separated by commas or the text is not UTF-8.
CsvTable read_csv(const std::filesystem::path &path);

// A cell without the blanks around it.
std::string trimmed(const std::string &cell);

} // namespace vdna::frames
