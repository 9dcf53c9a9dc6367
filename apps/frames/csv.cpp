#include "frames/csv.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <vdna/cpp/error.hpp>

namespace vdna::frames
{

namespace
{

[[noreturn]] void fail(const std::string &path, size_t line, const std::string &sentence)
{
    throw Error(path + ":" + std::to_string(line) + ": " + sentence);
}

// What other programs put between columns.
constexpr const char *other_separators = ";\t|";

std::string name_of_separator(char c)
{
    return c == '\t' ? "tabs" : "'" + std::string(1, c) + "'";
}

// Reads rows from text, one at a time.
class CsvReader
{
  public:
    CsvReader(const std::string &path, const std::string &text) : path_(path), text_(text)
    {
        // Spreadsheets put a byte order mark before the first column's name.
        if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0)
            at_ = 3;
    }

    // The next row that is not blank; false at the end.
    bool next(CsvRow &row)
    {
        while (at_ < text_.size()) {
            row = {line_, {}};
            do
                row.fields.push_back(field());
            while (take(','));
            end_line();
            if (row.fields.size() > 1 || !row.fields[0].empty())
                return true;
        }
        return false;
    }

  private:
    bool take(char wanted)
    {
        if (at_ >= text_.size() || text_[at_] != wanted)
            return false;
        line_ += wanted == '\n';
        at_++;
        return true;
    }

    void end_line()
    {
        const bool carriage_return = take('\r');
        if (at_ == text_.size() || take('\n'))
            return;
        if (carriage_return)
            fail(path_, line_,
                 "the line ends in a carriage return alone, expected LF or CRLF; save "
                 "the table with one of them");
        const char found = text_[at_];
        fail(path_, line_,
             "expected a comma or the end of the line after a field" +
                 (std::string(other_separators).find(found) == std::string::npos
                      ? ""
                      : ", found " + name_of_separator(found) +
                            "; save the table with commas between the columns"));
    }

    std::string field()
    {
        if (take('"'))
            return quoted();
        const size_t begin = at_;
        at_ = std::min(text_.find_first_of(",\r\n", begin), text_.size());
        return text_.substr(begin, at_ - begin);
    }

    // The rest of a quoted field; two quotes within it stand for one.
    std::string quoted()
    {
        const size_t opened = line_;
        std::string value;
        for (;;) {
            const size_t quote = text_.find('"', at_);
            if (quote == std::string::npos)
                fail(path_, opened, "a quoted field is never closed");
            const std::string part = text_.substr(at_, quote - at_);
            line_ += static_cast<size_t>(std::count(part.begin(), part.end(), '\n'));
            value += part;
            at_ = quote + 1;
            if (!take('"'))
                return value;
            value += '"';
        }
    }

    const std::string &path_;
    const std::string &text_;
    size_t at_ = 0;
    size_t line_ = 1;
};

std::string text_of(const std::filesystem::path &path)
{
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    // << fails on an empty file, which is harmless: the caller reports the missing header.
    if (!stream || !(text << stream.rdbuf() || stream.peek() == EOF))
        throw Error(path.string() + ": cannot read this table; expected a CSV file");
    return text.str();
}

// Other encodings than UTF-8 that show before a column is read.
void require_bytes(const std::string &path, const std::string &text)
{
    const std::string mark = text.substr(0, 2);
    if (mark == "\xFF\xFE" || mark == "\xFE\xFF" || text.find('\0') != std::string::npos)
        throw Error(path + ": UTF-16 or binary, expected text in UTF-8; save the table as CSV in "
                           "UTF-8");
}

// A header of one column that holds another separator is a header of several columns.
void require_commas(const std::string &path, const CsvRow &header)
{
    const size_t at = header.fields[0].find_first_of(other_separators);
    if (header.fields.size() == 1 && at != std::string::npos)
        fail(path, header.line,
             "the columns are separated by " + name_of_separator(header.fields[0][at]) +
                 ", expected commas; save the table with commas, and with points in decimal "
                 "numbers");
}

void require_width(const std::string &path, const CsvRow &row, size_t width)
{
    if (row.fields.size() != width)
        fail(path, row.line,
             "found " + std::to_string(row.fields.size()) + " fields, expected " +
                 std::to_string(width) + " as in the header" +
                 (row.fields.size() > width
                      ? "; write decimal numbers with a point, and quote names that hold a comma"
                      : ""));
}

} // namespace

std::string trimmed(const std::string &cell)
{
    const size_t begin = cell.find_first_not_of(" \t");
    return begin == std::string::npos
               ? ""
               : cell.substr(begin, cell.find_last_not_of(" \t") - begin + 1);
}

CsvTable read_csv(const std::filesystem::path &path)
{
    const std::string name = path.string(), text = text_of(path);
    require_bytes(name, text);
    CsvReader reader(name, text);
    CsvTable table;
    CsvRow row;
    if (!reader.next(row))
        throw Error(name + ": empty, expected a CSV header");
    require_commas(name, row);
    const size_t width = row.fields.size();
    for (size_t i = 0; i < width; i++)
        if (!table.columns.emplace(trimmed(row.fields[i]), i).second)
            fail(name, row.line, "two columns are called '" + trimmed(row.fields[i]) + "'");
    while (reader.next(row)) {
        require_width(name, row, width);
        table.rows.push_back(row);
    }
    return table;
}

} // namespace vdna::frames
