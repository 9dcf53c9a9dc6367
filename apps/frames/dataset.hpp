// Data sets: traversals, their pictures, and the place of each picture.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "frames/account.hpp"
#include "frames/labels.hpp"
#include "frames/picture_list.hpp"

namespace vdna::frames
{

struct DatasetFrame {
    std::filesystem::path file;
    Label label;
};

struct DatasetTraversal {
    std::string name;  // unique: "winter", or "test:2/winter"
    std::string group; // traversals are compared only within their group; "" = one group
    std::vector<DatasetFrame> frames; // in the order of their times
    Account account;                  // how they were ordered and timed
};

struct Dataset {
    std::string path;
    std::vector<DatasetTraversal> traversals;
    std::vector<std::string> notes; // sentences about folders that are no traversals
    // Settings of the authors' evaluation:
    double tolerance = 5;
    std::string warmup; // "100" or "45s"; "" = see usual_warmup()
    uint32_t stride = 1;
};

// Layouts of a data set on disk; "" = auto-detected.
//   folders   a folder per traversal, each with labels.csv
//   manifest  manifest.csv with file, experience, order, place and gt_tol
//   nordland  a folder per season; partitions as sub-folders, or cut from one folder
//   parks     as folders, with positions
//   utm       a folder per traversal, pictures called @UTM_EAST@UTM_NORTH@ZONE@...@.jpg
extern const std::vector<std::string> dataset_formats;

constexpr size_t nordland_partition_frames = 1150;

struct DatasetOptions {
    std::string format; // one of dataset_formats; "" = auto-detected
    size_t partition_frames = nordland_partition_frames; // if a Nordland season is one folder
    std::vector<std::string> exclude;                    // folders that are no traversals
};

// Throws Error.
Dataset load_dataset(const std::string &path, const DatasetOptions &options = {});

// The loaders of the formats.
Dataset load_folders(const std::filesystem::path &path, const DatasetOptions &options);
Dataset load_manifest(const std::filesystem::path &path);
Dataset load_nordland(const std::filesystem::path &path, const DatasetOptions &options);
Dataset load_parks(const std::filesystem::path &path, const DatasetOptions &options);
Dataset load_utm(const std::filesystem::path &path, const DatasetOptions &options);

// Default warmup: the data set's own, else two fifths of the shortest traversal, at most 100.
std::string usual_warmup(const Dataset &dataset);

// The folders of a data set that hold pictures, themselves or one level down, and are not excluded;
// those without are noted.
std::vector<std::filesystem::path> traversal_folders(const std::filesystem::path &path,
                                                     const DatasetOptions &options,
                                                     std::vector<std::string> &notes);

// A traversal of the pictures of a list, each with its label.
DatasetTraversal traversal_of(const std::filesystem::path &folder, const PictureList &list,
                              const std::function<Label(const ListedPicture &)> &label_of);

// "fall" for a folder "Fall_images_test"; "" if the name contains no season.
std::string season_of(const std::filesystem::path &folder);

} // namespace vdna::frames
