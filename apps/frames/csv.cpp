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
            take('\r');
            if (at_ < text_.size() && !take('\n'))
                fail(path_, line_, "expected a comma or the end of the line after a field");
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

} // namespace

CsvTable read_csv(const std::filesystem::path &path)
{
    const std::string name = path.string(), text = text_of(path);
    CsvReader reader(name, text);
    CsvTable table;
    CsvRow row;
    if (!reader.next(row))
        throw Error(name + ": empty, expected a CSV header");
    const size_t width = row.fields.size();
    for (size_t i = 0; i < width; i++)
        if (!table.columns.emplace(row.fields[i], i).second)
            fail(name, row.line, "two columns are called '" + row.fields[i] + "'");
    while (reader.next(row)) {
        if (row.fields.size() != width)
            fail(name, row.line,
                 "found " + std::to_string(row.fields.size()) + " fields, expected " +
                     std::to_string(width) + " as in the header");
        table.rows.push_back(row);
    }
    return table;
}

} // namespace vdna::frames
