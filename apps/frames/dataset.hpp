// Data sets: traversals, their pictures, and the place of each picture.
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
    std::string group; // traversals are compared only within their group; "" = one group
    std::vector<DatasetFrame> frames;
};

struct Dataset {
    std::string path;
    std::vector<DatasetTraversal> traversals;
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

// partition_frames: frames per partition if a Nordland season is one folder. Throws Error.
Dataset load_dataset(const std::string &path, const std::string &format,
                     size_t partition_frames = nordland_partition_frames);

// The loaders of the formats.
Dataset load_folders(const std::filesystem::path &path);
Dataset load_manifest(const std::filesystem::path &path);
Dataset load_nordland(const std::filesystem::path &path, size_t partition_frames);
Dataset load_parks(const std::filesystem::path &path);
Dataset load_utm(const std::filesystem::path &path);

// Default warmup: the data set's own, else two fifths of the shortest traversal, at most 100.
std::string usual_warmup(const Dataset &dataset);

// The visible folders within a folder, by name.
std::vector<std::filesystem::path> folders_in(const std::filesystem::path &path);

// "fall" for a folder "Fall_images_test"; "" if the name contains no season.
std::string season_of(const std::filesystem::path &folder);

} // namespace vdna::frames
