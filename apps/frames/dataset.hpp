// Data sets: which pictures make which traversal, and where each was taken.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "frames/labels.hpp"

namespace vdna::frames
{

struct DatasetFrame {
    std::filesystem::path file;
    Label label;
};

struct DatasetTraversal {
    std::string name;  // unique: "winter", or "test:2/winter"
    std::string group; // traversals are compared within their group only; "" = one group
    std::vector<DatasetFrame> frames;
};

struct Dataset {
    std::string path;
    std::vector<DatasetTraversal> traversals;
    // What its authors evaluate it with:
    double tolerance = 5;
    std::string warmup; // "100" or "45s"; "" = see usual_warmup()
    uint32_t stride = 1;
};

// What a data set looks like on disk; "" = find out.
//   folders   a folder per traversal, each with labels.csv
//   manifest  manifest.csv with file, experience, order, place and gt_tol
//   nordland  a folder per season; partitions as sub-folders, or cut from one folder
//   parks     as folders, with positions
//   utm       a folder per traversal, pictures called @UTM_EAST@UTM_NORTH@ZONE@...@.jpg
extern const std::vector<std::string> dataset_formats;

constexpr size_t nordland_partition_frames = 1150;

// partition_frames: of a Nordland season that is one folder. Throws Error.
Dataset load_dataset(const std::string &path, const std::string &format,
                     size_t partition_frames = nordland_partition_frames);

// The loaders of the formats.
Dataset load_folders(const std::filesystem::path &path);
Dataset load_manifest(const std::filesystem::path &path);
Dataset load_nordland(const std::filesystem::path &path, size_t partition_frames);
Dataset load_parks(const std::filesystem::path &path);
Dataset load_utm(const std::filesystem::path &path);

// The data set's own, else two fifths of the shortest traversal, but at most the paper's 100.
std::string usual_warmup(const Dataset &dataset);

// The visible folders within a folder, by name.
std::vector<std::filesystem::path> folders_in(const std::filesystem::path &path);

// "fall" of a folder "Fall_images_test", "" if it is not named after a season.
std::string season_of(const std::filesystem::path &folder);

} // namespace vdna::frames
