// Nordland: four synchronised train journeys, one folder per season. Partitions are its
// sub-folders, or its pictures are split into partitions of equal length. Frame numbers are the
// ground truth.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>

#include "frames/dataset.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

using Pictures = std::vector<fs::path>;

// 123 for "images-00123.png".
std::optional<int64_t> number_of(const fs::path &file)
{
    const std::string stem = file.stem().string();
    const size_t begin = stem.find_last_not_of("0123456789") + 1; // npos + 1 is 0
    int64_t number = 0;
    if (std::from_chars(stem.data() + begin, stem.data() + stem.size(), number).ec != std::errc())
        return {};
    return number;
}

std::vector<Pictures> partitions_of(const fs::path &season, size_t partition_frames)
{
    std::vector<Pictures> partitions;
    for (const fs::path &folder : folders_in(season))
        partitions.push_back(pictures_in(folder));
    if (!partitions.empty())
        return partitions;
    const Pictures files = pictures_in(season);
    if (files.size() % partition_frames != 0)
        throw Error(season.string() + ": has " + std::to_string(files.size()) +
                    " pictures, expected partitions of " + std::to_string(partition_frames) +
                    "; make a sub-folder of each partition, or set --partition-frames");
    for (auto at = files.begin(); at != files.end();
         at += static_cast<Pictures::difference_type>(partition_frames))
        partitions.emplace_back(at, at + static_cast<Pictures::difference_type>(partition_frames));
    return partitions;
}

DatasetTraversal traversal_of(const std::string &season, size_t partition, const Pictures &files)
{
    const std::string group = "test:" + std::to_string(partition + 1);
    DatasetTraversal traversal{group + "/" + season, group, {}, {}};
    traversal.account.order = "numbers";
    const bool numbered = std::all_of(files.begin(), files.end(),
                                      [](const fs::path &f) { return number_of(f).has_value(); });
    for (size_t i = 0; i < files.size(); i++) {
        Label label;
        label.place = numbered ? *number_of(files[i]) : static_cast<int64_t>(i);
        traversal.frames.push_back({files[i], label});
    }
    return traversal;
}

} // namespace

std::string season_of(const fs::path &folder)
{
    const std::string name = folder.filename().string();
    for (const char *season : {"spring", "summer", "fall", "winter"}) {
        const size_t length = std::strlen(season);
        const auto same = [](char a, char b) {
            return a == std::tolower(static_cast<unsigned char>(b));
        };
        if (name.size() >= length && std::equal(season, season + length, name.begin(), same) &&
            (name.size() == length || !std::isalpha(static_cast<unsigned char>(name[length]))))
            return season;
    }
    return "";
}

Dataset load_nordland(const fs::path &path, const DatasetOptions &options)
{
    Dataset dataset;
    dataset.warmup = "100";
    dataset.stride = 5;
    for (const fs::path &folder : traversal_folders(path, options, dataset.notes)) {
        const std::string season = season_of(folder);
        if (season.empty())
            throw Error(folder.string() +
                        ": not named after a season, expected spring, summer, fall and winter");
        const std::vector<Pictures> partitions = partitions_of(folder, options.partition_frames);
        for (size_t i = 0; i < partitions.size(); i++)
            dataset.traversals.push_back(traversal_of(season, i, partitions[i]));
    }
    std::stable_sort(
        dataset.traversals.begin(), dataset.traversals.end(),
        [](const DatasetTraversal &a, const DatasetTraversal &b) { return a.group < b.group; });
    return dataset;
}

} // namespace vdna::frames
