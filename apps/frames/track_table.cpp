// Tracks of CSV tables.
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string>

#include <vdna/cpp/error.hpp>

#include "frames/csv.hpp"
#include "frames/iso_time.hpp"
#include "frames/track_file.hpp"

namespace vdna::frames
{

namespace
{

// "Longitude (°)" and " longitude" are "longitude".
std::string plain(const std::string &name)
{
    std::string text;
    for (const char c : name.substr(0, name.find_first_of("([")))
        text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const size_t begin = text.find_first_not_of(' ');
    return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// The column with the first of these names that there is.
std::optional<size_t> find_column(const CsvTable &table, std::initializer_list<const char *> names)
{
    for (const char *name : names)
        for (const auto &[column, position] : table.columns)
            if (plain(column) == name)
                return position;
    return {};
}

// The number that is all of the text.
std::optional<double> number_of(const std::string &text)
{
    double value = 0;
    const char *end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value))
        return {};
    return value;
}

// Programs count from 1970 in different units. Between 1990 and 2100 no number fits two of them.
std::optional<int64_t> utime_since_1970(double number)
{
    constexpr double year_1990_s = 631152000, year_2100_s = 4102444800;
    for (const double unit_s : {1.0, 1e-3, 1e-6, 1e-9})
        if (number * unit_s >= year_1990_s && number * unit_s < year_2100_s)
            return std::llround(number * (unit_s * 1e6));
    return {};
}

class TableReader
{
  public:
    explicit TableReader(const std::filesystem::path &path)
        : path_(path.string()), table_(read_csv(path)), utime_(find_column(table_, {"utime"})),
          time_(find_column(table_, {"time", "timestamp", "datetime", "date_time", "date"})),
          lat_(find_column(table_, {"lat", "latitude"})),
          lon_(find_column(table_, {"lon", "lng", "long", "longitude"})),
          alt_(find_column(table_, {"alt", "altitude", "ele", "elevation", "height"}))
    {
        if ((!utime_ && !time_) || !lat_ || !lon_)
            throw Error(path_ + ": a column of the track is missing, expected time (or utime in "
                                "microseconds), lat and lon, and alt if known");
    }

    TrackFile read() const
    {
        TrackFile file;
        for (const CsvRow &row : table_.rows) {
            if (time_text(row).empty() || row.fields[*lat_].empty() || row.fields[*lon_].empty())
                file.unplaced++;
            else
                file.fixes.push_back(fix_of(row));
        }
        if (file.fixes.empty())
            throw Error(path_ + ": no row has a time and a position, expected a recorded track");
        return file;
    }

  private:
    const std::string &time_text(const CsvRow &row) const
    {
        return row.fields[utime_ ? *utime_ : *time_];
    }

    Fix fix_of(const CsvRow &row) const
    {
        Fix fix{utime_of(row), number_in(row, *lat_, "lat"), number_in(row, *lon_, "lon"), {}};
        if (alt_ && !row.fields[*alt_].empty())
            fix.alt = number_in(row, *alt_, "alt");
        return fix;
    }

    int64_t utime_of(const CsvRow &row) const
    {
        const std::string &text = time_text(row);
        int64_t utime = 0;
        const char *end = text.data() + text.size();
        if (utime_) {
            const auto result = std::from_chars(text.data(), end, utime);
            constexpr int64_t furthest_us = 4000000000000000000; // differences fit
            if (result.ec != std::errc() || result.ptr != end || utime < -furthest_us ||
                utime > furthest_us)
                fail(row, "utime", text, "a whole number of microseconds");
            return utime;
        }
        if (const std::optional<int64_t> iso = utime_of_iso(text))
            return *iso;
        const std::optional<double> number = number_of(text);
        const std::optional<int64_t> counted = number ? utime_since_1970(*number) : std::nullopt;
        if (!counted)
            fail(
                row, "time", text,
                "a time such as 2024-05-01T12:00:00Z, or a number since 1970 (of s, ms, us or ns)");
        return *counted;
    }

    double number_in(const CsvRow &row, size_t column, const char *name) const
    {
        const std::optional<double> number = number_of(row.fields[column]);
        if (!number)
            fail(row, name, row.fields[column], "a decimal number with a point");
        return *number;
    }

    [[noreturn]] void fail(const CsvRow &row, const char *name, const std::string &found,
                           const char *expected) const
    {
        throw Error(path_ + ":" + std::to_string(row.line) + ": " + name + " is '" + found +
                    "', expected " + expected);
    }

    std::string path_;
    CsvTable table_;
    std::optional<size_t> utime_, time_, lat_, lon_, alt_;
};

} // namespace

TrackFile read_track_table(const std::filesystem::path &path)
{
    return TableReader(path).read();
}

} // namespace vdna::frames
