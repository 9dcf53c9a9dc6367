#include "frames/picture_names.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <set>

#include <utf8proc.h>

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

bool is_utf8(const std::string &text)
{
    const auto *bytes = reinterpret_cast<const utf8proc_uint8_t *>(text.data());
    utf8proc_ssize_t left = static_cast<utf8proc_ssize_t>(text.size());
    while (left > 0) {
        utf8proc_int32_t codepoint = 0;
        const utf8proc_ssize_t size = utf8proc_iterate(bytes, left, &codepoint);
        if (size <= 0)
            return false;
        bytes += size;
        left -= size;
    }
    return true;
}

std::string normal(const std::string &name)
{
    return fs::path(name).lexically_normal().string();
}

// The last components of a path, the longest first: "a/b/c", "b/c", "c".
std::vector<std::string> endings_of(const fs::path &file)
{
    std::vector<std::string> endings;
    fs::path ending;
    for (auto part = file.end(); part != file.begin();) {
        --part;
        if (part->is_absolute())
            break;
        ending = ending.empty() ? *part : *part / ending;
        endings.push_back(ending.string());
    }
    std::reverse(endings.begin(), endings.end());
    return endings;
}

} // namespace

std::string alike_spelling(const std::string &name)
{
    std::string text = name;
    std::replace(text.begin(), text.end(), '\\', '/');
    utf8proc_uint8_t *mapped = nullptr;
    const auto options = // NOLINTNEXTLINE(*EnumCastOutOfRange): flags
        static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE | UTF8PROC_CASEFOLD);
    const utf8proc_ssize_t size =
        utf8proc_map(reinterpret_cast<const utf8proc_uint8_t *>(text.data()),
                     static_cast<utf8proc_ssize_t>(text.size()), &mapped, options);
    const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owner(mapped, std::free);
    if (size >= 0) // otherwise not UTF-8, and equal only to itself
        text.assign(reinterpret_cast<const char *>(mapped), static_cast<size_t>(size));
    return normal(text);
}

PictureNames::PictureNames(const fs::path &table, bool beside_table_only)
    : table_(fs::absolute(table)), beside_table_only_(beside_table_only)
{
}

// Resolves different spellings of a path to the same one. Tables name many files in few folders,
// and resolving a folder reads the disk, so its result is kept. A folder that the disk does not
// resolve, such as a loop of links, is taken as it is spelt.
fs::path PictureNames::resolved(const fs::path &file) const
{
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const auto found = folders_.try_emplace(folder);
    if (found.second) {
        std::error_code failure;
        found.first->second = fs::weakly_canonical(fs::absolute(folder), failure);
        if (failure)
            found.first->second = fs::absolute(folder).lexically_normal();
    }
    return found.first->second / file.filename();
}

size_t PictureNames::add(const std::string &name)
{
    const fs::path file = resolved(table_ / name);
    const auto [place, is_new] = by_file_.try_emplace(file.string(), rows_.size());
    if (!is_new)
        return place->second;
    by_name_.try_emplace(normal(name), rows_.size());
    rows_.push_back({name, file});
    return rows_.size() - 1;
}

const PictureNames::Index &PictureNames::alike() const
{
    if (!alike_) {
        alike_.emplace();
        for (size_t row = 0; row < rows_.size(); row++)
            for (const std::string &name : {rows_[row].file.string(), rows_[row].name}) {
                const auto [place, is_new] = alike_->try_emplace(alike_spelling(name), row);
                if (!is_new && place->second != row)
                    place->second = several;
            }
    }
    return *alike_;
}

// The only row of this name, unless that is about another file beside the table.
std::optional<size_t> PictureNames::fitting(const Index &index, const std::string &name) const
{
    const auto found = index.find(name);
    std::error_code failure;
    if (found == index.end() || found->second == several ||
        fs::exists(rows_[found->second].file, failure))
        return {};
    return found->second;
}

std::optional<size_t> PictureNames::find(const fs::path &file) const
{
    const fs::path path = resolved(file);
    const auto exact = by_file_.find(path.string());
    if (exact != by_file_.end())
        return exact->second;

    const std::vector<std::string> endings =
        beside_table_only_ ? std::vector<std::string>{} : endings_of(path);
    for (const std::string &ending : endings)
        if (const std::optional<size_t> row = fitting(by_name_, ending))
            return row;
    return find_alike(path, endings);
}

std::optional<size_t> PictureNames::find_alike(const fs::path &path,
                                               const std::vector<std::string> &endings) const
{
    if (looks_like_another(path))
        return {};
    if (const std::optional<size_t> row = fitting(alike(), alike_spelling(path.string())))
        return row;
    for (const std::string &ending : endings)
        if (const std::optional<size_t> row = fitting(alike(), alike_spelling(ending)))
            return row;
    return {};
}

bool PictureNames::looks_like_another(const fs::path &path) const
{
    const auto found = on_disk_.try_emplace(path.parent_path());
    std::map<std::string, size_t> &spellings = found.first->second;
    std::error_code failure;
    if (found.second)
        for (fs::directory_iterator file(path.parent_path(), failure), end; !failure && file != end;
             file.increment(failure))
            spellings[alike_spelling(file->path().filename().string())]++;
    return spellings[alike_spelling(path.filename().string())] > 1;
}

std::vector<fs::path> PictureNames::others_below(const fs::path &folder,
                                                 const std::vector<fs::path> &files) const
{
    std::set<size_t> known;
    for (const fs::path &file : files)
        if (const std::optional<size_t> row = find(file))
            known.insert(*row);
    const std::string below = resolved(folder / "").string();
    std::vector<fs::path> others;
    for (size_t row = 0; row < rows_.size(); row++) {
        const std::string file = rows_[row].file.string();
        if (known.count(row) == 0 && file.compare(0, below.size(), below) == 0)
            others.push_back(folder / file.substr(below.size()));
    }
    return others;
}

std::optional<size_t> PictureNames::not_utf8() const
{
    const auto bad =
        std::find_if(rows_.begin(), rows_.end(), [](const Row &row) { return !is_utf8(row.name); });
    return bad == rows_.end() ? std::nullopt : std::optional<size_t>(bad - rows_.begin());
}

} // namespace vdna::frames
