#include "frames/dataset.hpp"

#include <algorithm>
#include <set>

#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

bool begins_with_at(const fs::path &folder)
{
    return pictures_in(folder).front().filename().string()[0] == '@';
}

// Detect the format from the names of files and folders.
std::string format_of(const fs::path &path)
{
    if (fs::exists(path / "manifest.csv"))
        return "manifest";
    const std::vector<fs::path> folders = folders_in(path);
    const auto all = [&](auto is_such) {
        return !folders.empty() && std::all_of(folders.begin(), folders.end(), is_such);
    };
    if (all([](const fs::path &folder) { return fs::exists(folder / "labels.csv"); }))
        return "folders";
    if (all([](const fs::path &folder) { return !season_of(folder).empty(); }))
        return "nordland";
    if (all(begins_with_at))
        return "utm";
    throw Error(path.string() + ": not known as a data set; expected manifest.csv, or a folder for "
                                "each traversal, with labels.csv, or with pictures called "
                                "@UTM_EAST@UTM_NORTH@...; or set --format");
}

Dataset load(const fs::path &path, const std::string &format, size_t partition_frames)
{
    if (format == "manifest")
        return load_manifest(path);
    if (format == "nordland")
        return load_nordland(path, partition_frames);
    if (format == "parks")
        return load_parks(path);
    return format == "utm" ? load_utm(path) : load_folders(path);
}

void require_usable(const Dataset &dataset)
{
    std::set<std::string> names;
    for (const DatasetTraversal &traversal : dataset.traversals) {
        if (traversal.name == "all")
            throw Error(dataset.path + ": a traversal is called 'all', which results call the map "
                                       "of all of them; rename it");
        if (!names.insert(traversal.name).second)
            throw Error(dataset.path + ": two traversals are called '" + traversal.name +
                        "'; rename one");
    }
    if (names.size() < 2)
        throw Error(dataset.path + ": has " + std::to_string(names.size()) +
                    " traversals, expected at least a query and a reference");
}

} // namespace

const std::vector<std::string> dataset_formats = {"folders", "manifest", "nordland", "parks",
                                                  "utm"};

Dataset load_dataset(const std::string &path, const std::string &format, size_t partition_frames)
{
    if (!fs::is_directory(path))
        throw Error(path + ": not a directory, expected a data set");
    Dataset dataset = load(path, format.empty() ? format_of(path) : format, partition_frames);
    dataset.path = path;
    require_usable(dataset);
    return dataset;
}

std::string usual_warmup(const Dataset &dataset)
{
    if (!dataset.warmup.empty())
        return dataset.warmup;
    size_t shortest = 250;
    for (const DatasetTraversal &traversal : dataset.traversals)
        shortest = std::min(shortest, traversal.frames.size());
    return std::to_string(std::max<size_t>(shortest * 2 / 5, 2));
}

std::vector<fs::path> folders_in(const fs::path &path)
{
    std::vector<fs::path> folders;
    std::error_code failure;
    for (fs::directory_iterator entry(path, failure), end; !failure && entry != end;
         entry.increment(failure))
        if (entry->is_directory() && entry->path().filename().string()[0] != '.')
            folders.push_back(*entry);
    if (failure)
        throw Error(path.string() + ": cannot read this folder: " + failure.message());
    std::sort(folders.begin(), folders.end());
    return folders;
}

} // namespace vdna::frames
