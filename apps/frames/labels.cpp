#include "frames/labels.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>
#include <vdna/identity.h>

#include "frames/csv.hpp"
#include "program/notice.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

std::string lower(std::string text)
{
    for (char &c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

// What to do about a cell that is no number; "" if nobody knows.
std::string remedy_of(const std::string &cell)
{
    if (cell.find(',') != std::string::npos)
        return "; write decimals with a point";
    const size_t behind = cell.find_last_of("0123456789.") + 1; // npos + 1 is 0
    const std::string unit = cell.substr(behind);
    if (behind > 0 && !unit.empty())
        return "; leave out '" + trimmed(unit) + "'";
    return "";
}

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

    bool is_blank(const CsvRow &row, const char *column) const
    {
        return trimmed(text(row, column)).empty();
    }

    template <typename Number>
    Number whole(const CsvRow &row, const char *column) const
    {
        Number value{};
        if (!parse(trimmed(text(row, column)), value))
            fail(row, column, std::is_signed_v<Number> ? "a whole number" : "a number from 0");
        return value;
    }

    // NaN for the texts by which programs write that there is no number.
    double real(const CsvRow &row, const char *column) const
    {
        const std::string cell = trimmed(text(row, column)), word = lower(cell);
        for (const char *none :
             {"nan", "+nan", "-nan", "inf", "+inf", "-inf", "na", "n/a", "none", "null"})
            if (word == none)
                return std::nan("");
        double value = 0;
        if (!parse(cell, value))
            fail(row, column, "a decimal number" + remedy_of(cell));
        return std::isfinite(value) ? value : std::nan("");
    }

    [[noreturn]] void fail(const CsvRow &row, const char *column, const std::string &expected) const
    {
        throw Error(path_ + ":" + std::to_string(row.line) + ": " + column + " is '" +
                    text(row, column) + "', expected " + expected);
    }

    // " (found 'Latitude')": a column that is probably meant; "" if there is none.
    std::string meant(const std::vector<const char *> &others) const
    {
        for (const auto &column : table_.columns)
            for (const char *other : others)
                if (lower(column.first) == other)
                    return " (found '" + column.first + "')";
        return "";
    }

    const std::string &path() const { return path_; }

  private:
    template <typename Number>
    static bool parse(const std::string &cell, Number &out_value)
    {
        const char *end = cell.data() + cell.size();
        const auto result = std::from_chars(cell.data(), end, out_value);
        return result.ec == std::errc() && result.ptr == end;
    }

    const std::string &path_;
    const CsvTable &table_;
};

// Far beyond the Earth, so that squares and sums stay finite.
constexpr double furthest_m = 1e9;

// The columns of a position.
struct Columns {
    const char *first, *second, *height;
};
constexpr Columns degrees = {"lat", "lon", "alt"}, metres = {"x", "y", "z"};

bool has_both(const Cells &cells, const Columns &columns)
{
    return cells.has(columns.first) && cells.has(columns.second);
}

double height_of(const Cells &cells, const CsvRow &row, const Columns &columns)
{
    if (!cells.has(columns.height) || cells.is_blank(row, columns.height))
        return 0;
    const double height = cells.real(row, columns.height);
    return std::isnan(height) ? 0 : height;
}

// Reads the positions of a table, and leaves out those that nobody can have been at.
class Positions
{
  public:
    Positions(const Cells &cells, const LabelOptions &options)
        : cells_(cells), columns_(has_both(cells, degrees) ? degrees : metres),
          exists_(has_both(cells, columns_)), local_(options.local_frame)
    {
        if (is_global() && !local_.empty() && local_ != VDNA_FRAME_WGS84)
            throw Error(cells.path() +
                        ": has lat and lon, which are in frame " VDNA_FRAME_WGS84 ", not " +
                        local_ + "; leave out --frame");
    }

    // row: its number.
    void read(const CsvRow &row, size_t number, const std::string &drive, Label &label)
    {
        if (!exists_)
            return;
        const bool blank = cells_.is_blank(row, columns_.first);
        if (blank != cells_.is_blank(row, columns_.second))
            left_out_[Flaw::incomplete]++;
        else if (!blank)
            take(row, number, drive, label);
    }

    // Leave out jumps, and check that something is left. Returns what was left out.
    std::string finish(std::vector<Label> &rows)
    {
        for (const size_t row : jumps_among(timed_)) {
            rows[row].position.reset();
            rows[row].position_frame.clear();
            left_out_[Flaw::jump]++;
        }
        const size_t off =
            left_out_.count(Flaw::off_the_globe) ? left_out_[Flaw::off_the_globe] : 0;
        if (off > 1 && taken_ == 0)
            throw Error(first_off_globe_ + ", and no other row has a position on the globe, "
                                           "expected degrees; metres go into the columns x and y");
        return text_of(left_out_);
    }

    bool exists() const { return exists_; }

  private:
    bool is_global() const { return exists_ && columns_.first == degrees.first; }

    void take(const CsvRow &row, size_t number, const std::string &drive, Label &label)
    {
        const double first = cells_.real(row, columns_.first);
        const double second = cells_.real(row, columns_.second);
        const double height = height_of(cells_, row, columns_);
        std::optional<Flaw> flaw;
        if (std::isnan(first) || std::isnan(second))
            flaw = Flaw::not_a_number;
        else if (is_global())
            flaw = flaw_of_fix(first, second, height);
        if (flaw) {
            left_out_[*flaw]++;
            if (*flaw == Flaw::off_the_globe && first_off_globe_.empty())
                first_off_globe_ = cells_.path() + ":" + std::to_string(row.line) +
                                   ": lat,lon is " + cells_.text(row, "lat") + "," +
                                   cells_.text(row, "lon");
            return;
        }
        taken_++;
        std::array<double, 3> ground = {first, second, 0};
        if (is_global()) {
            label.position.emplace();
            vdna_geodesy_to_ecef(first, second, height, label.position->data());
            vdna_geodesy_to_ecef(first, second, 0, ground.data());
        } else {
            require_near(row, first, second, height);
            label.position = {{first, second, height}};
        }
        label.position_frame = frame_of(row);
        if (label.utime)
            timed_.push_back({number, drive, *label.utime, ground});
    }

    void require_near(const CsvRow &row, double x, double y, double z) const
    {
        for (const auto &[column, value] :
             {std::pair(metres.first, x), {metres.second, y}, {metres.height, z}})
            if (std::abs(value) > furthest_m)
                cells_.fail(row, column, "metres within +-1e9");
    }

    std::string frame_of(const CsvRow &row)
    {
        if (is_global())
            return VDNA_FRAME_WGS84;
        if (!local_.empty())
            return local_;
        if (!cells_.has("position_frame"))
            return VDNA_FRAME_LOCAL;
        const std::string name = cells_.text(row, "position_frame");
        if (vdna_name_check(name.c_str(), nullptr) != VDNA_OK || name == VDNA_FRAME_WGS84)
            cells_.fail(row, "position_frame",
                        "the name of a local frame: 1 to 63 " VDNA_NAME_ALPHABET
                        ", and not " VDNA_FRAME_WGS84);
        if (named_.empty())
            named_ = name;
        if (name != named_)
            cells_.fail(row, "position_frame", named_ + " as in the rows before");
        return name;
    }

    const Cells &cells_;
    Columns columns_;
    bool exists_;
    std::string local_; // of the options
    std::string named_; // of the table
    std::vector<TimedPosition> timed_;
    std::map<Flaw, size_t> left_out_;
    std::string first_off_globe_;
    size_t taken_ = 0;
};

void require_columns(const std::string &path, const Cells &cells)
{
    if (!cells.has("file") && !cells.has("frame"))
        throw Error(path +
                    ": no column 'file' or 'frame', expected one that says which picture "
                    "or frame a row is about" +
                    cells.meant({"file", "frame", "filename", "file_name", "image", "name",
                                 "picture", "path"}));
    const bool has_metres = has_both(cells, metres), has_degrees = has_both(cells, degrees);
    if (has_metres && has_degrees)
        throw Error(path + ": columns x,y and lat,lon both give a position, expected one of them");
    if (!has_metres && !has_degrees && !cells.has("place") && !cells.has("utime"))
        throw Error(
            path +
            ": no column with a label, expected place, or x,y[,z], or "
            "lat,lon[,alt], or utime" +
            cells.meant({"lat", "lon", "latitude", "longitude", "lng", "long", "x", "y", "easting",
                         "northing", "place", "utime", "time", "timestamp", "stamp"}));
}

std::optional<int64_t> place_of(const Cells &cells, const CsvRow &row)
{
    if (!cells.has("place") || cells.is_blank(row, "place"))
        return {};
    const auto place = cells.whole<int64_t>(row, "place");
    if (place == VDNA_PLACE_NONE)
        cells.fail(row, "place", "a whole number above -2^63, which stands for none");
    return place;
}

// Rows of different drives may be in one table.
std::string drive_of(const Cells &cells, const CsvRow &row)
{
    std::string drive;
    if (cells.has("file"))
        drive = fs::path(cells.text(row, "file")).parent_path().string();
    if (cells.has("experience"))
        drive += '\n' + cells.text(row, "experience");
    return drive;
}

} // namespace

Labels::Labels(const fs::path &csv, const LabelOptions &options)
    : csv_(csv.string()), names_(fs::absolute(csv).parent_path(), options.of_several)
{
    const CsvTable table = read_csv(csv);
    const Cells cells(csv_, table);
    require_columns(csv_, cells);
    Positions positions(cells, options);
    by_file_ = cells.has("file");
    for (const CsvRow &row : table.rows) {
        const char *const key = by_file_ ? "file" : "frame";
        const size_t number = rows_.size();
        const size_t place =
            by_file_ ? names_.add(cells.text(row, key))
                     : frames_.try_emplace(cells.whole<uint64_t>(row, key), number).first->second;
        if (place != number)
            cells.fail(row, key,
                       "each one only once; it is also in line " + std::to_string(lines_[place]));
        Label &label = rows_.emplace_back();
        lines_.push_back(row.line);
        if (cells.has("utime") && !cells.is_blank(row, "utime"))
            label.utime = cells.whole<int64_t>(row, "utime");
        label.place = place_of(cells, row);
        positions.read(row, number, drive_of(cells, row), label);
    }
    const std::string left_out = positions.finish(rows_);
    if (!left_out.empty()) {
        note_ = csv_ + ": " + left_out;
        program::tell_once(note_);
    }
    const bool is_truth = positions.exists() || cells.has("place");
    for (Label &label : rows_)
        label.lacks_truth = is_truth && !label.place && !label.position;
    none_.lacks_truth = is_truth;
}

const Label &Labels::find(const fs::path &file, uint64_t frame) const
{
    if (by_file_ && file.empty())
        throw Error(csv_ + ": has the column file, expected the column frame (index from 0) for "
                           "a video or a log");
    std::optional<size_t> row;
    if (by_file_)
        row = names_.find(file);
    else if (const auto place = frames_.find(frame); place != frames_.end())
        row = place->second;
    if (row) {
        found_++;
        return rows_[*row];
    }
    if (by_file_)
        require_row_in(file);
    first_missed_ = missed_++ == 0 ? frame : first_missed_;
    last_missed_ = frame;
    return none_;
}

// A picture without a row is one among others, or the table is about others altogether.
void Labels::require_row_in(const fs::path &file) const
{
    if (const std::optional<size_t> bad = names_.not_utf8())
        throw Error(csv_ + ":" + std::to_string(lines_[*bad]) + ": file is not UTF-8, and " +
                    file.string() + " has no row; save the table in UTF-8");
    const fs::path folder = fs::absolute(file).parent_path();
    if (folders_.count(folder))
        return;
    std::error_code failure;
    for (fs::directory_iterator other(folder, failure), end; !failure && other != end;
         other.increment(failure))
        if (names_.find(other->path())) {
            folders_.insert(folder);
            return;
        }
    throw Error(csv_ + ": no row is about a picture of " + file.parent_path().string() + ": " +
                (rows_.empty()
                     ? "it has no rows"
                     : "its first row is about '" + names_.name(0) +
                           "', and a picture is called '" + file.filename().string() + "'") +
                ", expected names relative to the table or to the folder of the pictures");
}

std::vector<fs::path> Labels::others_below(const fs::path &folder,
                                           const std::vector<fs::path> &files) const
{
    return by_file_ ? names_.others_below(folder, files) : std::vector<fs::path>{};
}

std::vector<int64_t> Labels::frame_utimes() const
{
    std::vector<int64_t> utimes;
    for (const auto &[frame, row] : frames_)
        if (const std::optional<int64_t> &utime = rows_[row].utime)
            utimes.push_back(*utime);
    return utimes;
}

uint64_t Labels::numbered_frames() const
{
    return frames_.empty() ? 0 : frames_.rbegin()->first + 1;
}

void Labels::finish() const
{
    if (found_ > 0 || missed_ == 0 || by_file_)
        return;
    const auto span = [](uint64_t first, uint64_t last) {
        return std::to_string(first) + " to " + std::to_string(last);
    };
    throw Error(csv_ + ": no row is about a frame that was read: " +
                (frames_.empty() ? "it has no rows"
                                 : "its rows are about frames " +
                                       span(frames_.begin()->first, frames_.rbegin()->first)) +
                ", those read are " + span(first_missed_, last_missed_) +
                "; frame is the index in the source, from 0");
}

} // namespace vdna::frames
