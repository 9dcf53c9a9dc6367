// Finds the row of a table that names a picture, however the two are spelt.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vdna::frames
{

class PictureNames
{
  public:
    // table: the folder of the table. beside_table_only: names are relative to the table alone;
    // otherwise also to the folder of the pictures or to one above it.
    PictureNames(const std::filesystem::path &table, bool beside_table_only);

    // Add the next row, and get its number, from 0; the number of an earlier row about the same
    // file instead if there is one.
    size_t add(const std::string &name);

    // The row about a picture. Spellings that are not equal match if only one row fits and it fits
    // no other file: accents composed or not, letter case, backslashes.
    std::optional<size_t> find(const std::filesystem::path &file) const;

    // The files in `folder` or below that rows are about, other than `files`, which are in it.
    std::vector<std::filesystem::path>
    others_below(const std::filesystem::path &folder,
                 const std::vector<std::filesystem::path> &files) const;

    // As in the table.
    const std::string &name(size_t row) const { return rows_[row].name; }
    // The first row whose name is not UTF-8.
    std::optional<size_t> not_utf8() const;

  private:
    struct Row {
        std::string name;
        std::filesystem::path file; // relative to the table
    };
    static constexpr size_t several = SIZE_MAX;
    using Index = std::map<std::string, size_t>; // row, or several

    std::filesystem::path resolved(const std::filesystem::path &file) const;
    std::optional<size_t> fitting(const Index &index, const std::string &name) const;
    const Index &alike() const;
    std::optional<size_t> find_alike(const std::filesystem::path &path,
                                     const std::vector<std::string> &endings) const;
    bool looks_like_another(const std::filesystem::path &path) const;

    std::filesystem::path table_;
    bool beside_table_only_;
    std::vector<Row> rows_;
    std::map<std::string, size_t> by_file_;
    Index by_name_;
    mutable std::optional<Index> alike_;                                     // made when needed
    mutable std::map<std::filesystem::path, std::filesystem::path> folders_; // resolved
    // How many files of a folder have each spelling; made when needed.
    mutable std::map<std::filesystem::path, std::map<std::string, size_t>> on_disk_;
};

// The spelling that names which look alike have in common: NFC, case-folded, with slashes.
std::string alike_spelling(const std::string &name);

} // namespace vdna::frames
