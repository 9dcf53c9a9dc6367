// One table for all traversals: manifest.csv with file, experience, order, place and gt_tol.
#include <algorithm>
#include <charconv>

#include <vdna/cpp/error.hpp>

#include "frames/csv.hpp"
#include "frames/dataset.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

// A row's place in its traversal.
struct Entry {
    double order;
    fs::path file;
};

// The table by column name; complaints name file and line.
class Manifest
{
  public:
    explicit Manifest(const fs::path &path) : path_(path.string()), table_(read_csv(path))
    {
        for (const char *column : {"file", "experience", "order", "place", "gt_tol"})
            if (table_.columns.count(column) == 0)
                throw Error(path_ + ": no column '" + column +
                            "', expected file, experience, order, place and gt_tol");
        if (table_.rows.empty())
            throw Error(path_ + ": no rows, expected one for each picture");
    }

    const std::vector<CsvRow> &rows() const { return table_.rows; }

    const std::string &text(const CsvRow &row, const char *column) const
    {
        return row.fields[table_.columns.at(column)];
    }

    double number(const CsvRow &row, const char *column) const
    {
        const std::string &cell = text(row, column);
        double value = 0;
        const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (result.ec != std::errc() || result.ptr != cell.data() + cell.size() ||
            !(value >= 0 && value <= 1e9))
            fail(row, column, "a number from 0 to 1e9");
        return value;
    }

    [[noreturn]] void fail(const CsvRow &row, const char *column, const std::string &expected) const
    {
        throw Error(path_ + ":" + std::to_string(row.line) + ": " + column + " is '" +
                    text(row, column) + "', expected " + expected);
    }

  private:
    std::string path_;
    CsvTable table_;
};

} // namespace

Dataset load_manifest(const fs::path &path)
{
    const fs::path csv = path / "manifest.csv";
    const Manifest manifest(csv);
    const Labels labels(csv);

    Dataset dataset;
    dataset.tolerance = manifest.number(manifest.rows().front(), "gt_tol");
    std::map<std::string, std::vector<Entry>> traversals;
    for (const CsvRow &row : manifest.rows()) {
        if (manifest.number(row, "gt_tol") != dataset.tolerance)
            manifest.fail(row, "gt_tol", "the same in all rows");
        if (manifest.text(row, "experience").empty())
            manifest.fail(row, "experience", "a name");
        traversals[manifest.text(row, "experience")].push_back(
            {manifest.number(row, "order"), path / manifest.text(row, "file")});
    }
    for (auto &[name, entries] : traversals) {
        std::stable_sort(entries.begin(), entries.end(),
                         [](const Entry &a, const Entry &b) { return a.order < b.order; });
        DatasetTraversal traversal{name, "", {}, {}};
        traversal.account.order = "manifest";
        for (const Entry &entry : entries)
            traversal.frames.push_back({entry.file, labels.find(entry.file, 0)});
        dataset.traversals.push_back(std::move(traversal));
    }
    return dataset;
}

} // namespace vdna::frames
