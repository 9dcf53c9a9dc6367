#include "frames/labels.hpp"

#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include <vdna/cpp/error.hpp>

#include "frames/csv.hpp"

namespace vdna::frames
{

namespace
{

// Reads the cells of a table by column name; complaints name file, line and column.
class Cells
{
  public:
    Cells(const std::string &path, const CsvTable &table) : path_(path), table_(table) {}

    bool has(const char *column) const { return table_.columns.count(column) > 0; }

    const std::string &text(const CsvRow &row, const char *column) const
    {
        return row.fields[table_.columns.at(column)];
    }

    template <typename Number>
    Number whole(const CsvRow &row, const char *column) const
    {
        Number value{};
        if (!parse(text(row, column), value))
            fail(row, column, std::is_signed_v<Number> ? "a whole number" : "a number from 0");
        return value;
    }

    double real(const CsvRow &row, const char *column, double limit) const
    {
        double value = 0;
        if (!parse(text(row, column), value) || !(std::abs(value) <= limit))
            fail(row, column, "a decimal number within +-" + shortest(limit));
        return value;
    }

    [[noreturn]] void fail(const CsvRow &row, const char *column, const std::string &expected) const
    {
        throw Error(path_ + ":" + std::to_string(row.line) + ": " + column + " is '" +
                    text(row, column) + "', expected " + expected);
    }

  private:
    template <typename Number>
    static bool parse(const std::string &cell, Number &out_value)
    {
        const char *end = cell.data() + cell.size();
        const auto result = std::from_chars(cell.data(), end, out_value);
        return result.ec == std::errc() && result.ptr == end;
    }

    static std::string shortest(double value)
    {
        std::array<char, 32> text{};
        return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
    }

    const std::string &path_;
    const CsvTable &table_;
};

// Far beyond the Earth, so that squares and sums stay finite.
constexpr double furthest_m = 1e9;

std::optional<std::array<double, 3>> position_of(const Cells &cells, const CsvRow &row)
{
    if (cells.has("lat") && cells.has("lon"))
        return ecef_of(cells.real(row, "lat", 90), cells.real(row, "lon", 360),
                       cells.has("alt") ? cells.real(row, "alt", furthest_m) : 0);
    if (cells.has("x") && cells.has("y"))
        return {{cells.real(row, "x", furthest_m), cells.real(row, "y", furthest_m),
                 cells.has("z") ? cells.real(row, "z", furthest_m) : 0}};
    return {};
}

Label label_of(const Cells &cells, const CsvRow &row)
{
    Label label;
    if (cells.has("utime") && !cells.text(row, "utime").empty())
        label.utime = cells.whole<int64_t>(row, "utime");
    if (cells.has("place"))
        label.place = cells.whole<int64_t>(row, "place");
    label.position = position_of(cells, row);
    return label;
}

void require_columns(const std::string &path, const Cells &cells)
{
    if (!cells.has("file") && !cells.has("frame"))
        throw Error(path + ": no column 'file' or 'frame', expected one that says which picture "
                           "or frame a row is about");
    const bool metres = cells.has("x") && cells.has("y");
    const bool degrees = cells.has("lat") && cells.has("lon");
    if (metres && degrees)
        throw Error(path + ": columns x,y and lat,lon both give a position, expected one of them");
    if (!metres && !degrees && !cells.has("place") && !cells.has("utime"))
        throw Error(path + ": no column with a label, expected place, or x,y[,z], or "
                           "lat,lon[,alt], or utime");
}

// Resolves different spellings of a path to the same one. Tables name many files in few folders,
// and resolving a folder reads the disk, so its result is kept.
class Resolver
{
  public:
    std::filesystem::path operator()(const std::filesystem::path &file)
    {
        const auto found = folders_.try_emplace(file.parent_path());
        if (found.second)
            found.first->second =
                std::filesystem::weakly_canonical(std::filesystem::absolute(file.parent_path()));
        return found.first->second / file.filename();
    }

  private:
    std::map<std::filesystem::path, std::filesystem::path> folders_;
};

} // namespace

Labels::Labels(const std::filesystem::path &csv) : csv_(csv.string())
{
    const CsvTable table = read_csv(csv);
    const Cells cells(csv_, table);
    require_columns(csv_, cells);
    by_file_ = cells.has("file");
    Resolver resolve;
    for (const CsvRow &row : table.rows) {
        const std::string key = by_file_
                                    ? resolve(csv.parent_path() / cells.text(row, "file")).string()
                                    : std::to_string(cells.whole<uint64_t>(row, "frame"));
        if (!rows_.emplace(key, label_of(cells, row)).second)
            cells.fail(row, by_file_ ? "file" : "frame", "each one only once");
    }
}

const Label &Labels::find(const std::filesystem::path &file, uint64_t frame) const
{
    if (by_file_ && file.empty())
        throw Error(csv_ + ": has the column file, expected the column frame (index from 0) for "
                           "a video or a log");
    const auto row = rows_.find(by_file_ ? Resolver()(file).string() : std::to_string(frame));
    if (row == rows_.end())
        throw Error(csv_ + ": no row about " +
                    (by_file_ ? file.string() : "frame " + std::to_string(frame)) +
                    ", expected one for every frame; add it");
    return row->second;
}

std::vector<std::filesystem::path>
Labels::others_below(const std::filesystem::path &folder,
                     const std::vector<std::filesystem::path> &files) const
{
    std::vector<std::filesystem::path> others;
    if (!by_file_)
        return others;
    Resolver resolve;
    std::set<std::string> known;
    for (const std::filesystem::path &file : files)
        known.insert(resolve(file).string());
    const std::string below = resolve(folder / "").string();
    for (const auto &[file, label] : rows_)
        if (known.count(file) == 0 && file.compare(0, below.size(), below) == 0)
            others.push_back(folder / file.substr(below.size()));
    return others;
}

std::vector<int64_t> Labels::frame_utimes() const
{
    std::vector<int64_t> utimes;
    if (by_file_)
        return utimes;
    std::map<uint64_t, int64_t> by_number;
    for (const auto &[frame, label] : rows_)
        if (label.utime)
            by_number[std::stoull(frame)] = *label.utime;
    for (const auto &[frame, utime] : by_number)
        utimes.push_back(utime);
    return utimes;
}

uint64_t Labels::numbered_frames() const
{
    uint64_t frames = 0;
    if (!by_file_)
        for (const auto &[frame, label] : rows_)
            frames = std::max<uint64_t>(frames, std::stoull(frame) + 1);
    return frames;
}

std::array<double, 3> ecef_of(double lat_deg, double lon_deg, double alt_m)
{
    // WGS84: semi-major axis in metres, and first eccentricity squared.
    constexpr double a = 6378137.0, f = 1 / 298.257223563, e2 = f * (2 - f);
    constexpr double rad = 3.14159265358979323846 / 180;
    const double lat = lat_deg * rad, lon = lon_deg * rad;
    const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
    return {(n + alt_m) * std::cos(lat) * std::cos(lon),
            (n + alt_m) * std::cos(lat) * std::sin(lon), (n * (1 - e2) + alt_m) * std::sin(lat)};
}

} // namespace vdna::frames
