#include "frames/dataset.hpp"

#include <algorithm>
#include <set>

#include "frames/source.hpp"
#include "frames/utm_name.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

bool begins_with_at(const fs::path &folder)
{
    return holds_pictures(folder) && is_utm_name(pictures_in(folder).front());
}

bool has_table(const fs::path &folder)
{
    return fs::exists(folder / "labels.csv");
}

// Detect the format from the names of files and folders.
std::string format_of(const fs::path &path, const DatasetOptions &options)
{
    if (fs::exists(path / "manifest.csv"))
        return "manifest";
    std::vector<std::string> unused;
    const std::vector<fs::path> folders = traversal_folders(path, options, unused);
    const auto all = [&](auto is_such) {
        return !folders.empty() && std::all_of(folders.begin(), folders.end(), is_such);
    };
    if (all(has_table))
        return "folders";
    if (all([](const fs::path &folder) { return !season_of(folder).empty(); }))
        return "nordland";
    if (all(begins_with_at))
        return "utm";
    const auto spoils = std::find_if_not(folders.begin(), folders.end(), has_table);
    throw Error((std::any_of(folders.begin(), folders.end(), has_table)
                     ? spoils->string() + ": has no labels.csv as its neighbours have"
                     : path.string() + ": not known as a data set") +
                "; expected manifest.csv, or a folder for each traversal, with labels.csv, or with "
                "pictures called @UTM_EAST@UTM_NORTH@...; or set --format");
}

Dataset load(const fs::path &path, const std::string &format, const DatasetOptions &options)
{
    if (format == "manifest")
        return load_manifest(path);
    if (format == "nordland")
        return load_nordland(path, options);
    if (format == "parks")
        return load_parks(path, options);
    return format == "utm" ? load_utm(path, options) : load_folders(path, options);
}

// Bring stamps to microseconds, and leave out late frames.
void put_on_time_axis(DatasetTraversal &traversal)
{
    std::vector<int64_t> stamps;
    for (const DatasetFrame &frame : traversal.frames)
        if (frame.label.utime)
            stamps.push_back(*frame.label.utime);
    TimeAxis axis(stamps, VDNA_TIME_UNIT_AUTO, VDNA_TIME_LATE_US_DEFAULT);
    std::vector<DatasetFrame> in_order;
    for (DatasetFrame &frame : traversal.frames) {
        const bool is_stamped = frame.label.utime.has_value();
        if (is_stamped)
            frame.label.utime = axis.take(*frame.label.utime);
        if (!is_stamped || frame.label.utime)
            in_order.push_back(std::move(frame));
    }
    traversal.frames = std::move(in_order);
    axis.describe(traversal.account);
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

Dataset load_dataset(const std::string &path, const DatasetOptions &options)
{
    if (!fs::is_directory(path))
        throw Error(path + ": not a directory, expected a data set");
    Dataset dataset =
        load(path, options.format.empty() ? format_of(path, options) : options.format, options);
    dataset.path = path;
    for (DatasetTraversal &traversal : dataset.traversals)
        put_on_time_axis(traversal);
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

std::vector<fs::path> traversal_folders(const fs::path &path, const DatasetOptions &options,
                                        std::vector<std::string> &notes)
{
    std::vector<fs::path> folders;
    for (const fs::path &folder : folders_in(path)) {
        const std::string name = folder.filename().string();
        if (std::count(options.exclude.begin(), options.exclude.end(), name) > 0)
            continue;
        const std::vector<fs::path> inner = folders_in(folder);
        if (holds_pictures(folder) || fs::exists(folder / "labels.csv") ||
            std::any_of(inner.begin(), inner.end(), holds_pictures))
            folders.push_back(folder);
        else
            notes.push_back(folder.string() + ": no pictures, passed over");
    }
    return folders;
}

DatasetTraversal traversal_of(const fs::path &folder, const PictureList &list,
                              const std::function<Label(const ListedPicture &)> &label_of)
{
    DatasetTraversal traversal{folder.filename().string(), "", {}, {}};
    traversal.account.order = list.order;
    traversal.account.notes = list.notes;
    for (const ListedPicture &picture : list.pictures) {
        traversal.frames.push_back({picture.file, label_of(picture)});
        traversal.frames.back().label.utime = picture.stamp;
    }
    return traversal;
}

} // namespace vdna::frames
