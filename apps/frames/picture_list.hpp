// The pictures of a traversal, in the order in which they were taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frames/labels.hpp"

namespace vdna::frames
{

// One picture that a folder or its table says there is; it may be missing or unreadable.
struct ListedPicture {
    std::filesystem::path file;
    uint64_t number;              // in natural order of the names, from 0
    std::optional<int64_t> stamp; // the table's or the name's; all pictures have one or none has
};

struct PictureList {
    std::vector<ListedPicture> pictures;
    std::string order;              // "utime", "times in names", "numbers" or "names"
    std::vector<std::string> notes; // sentences for people
};

// List the pictures of a folder and those that its table names in it or below. They are ordered by
// the table's utime if it has any, else by the times in UTM names, else by name in natural order. A
// picture without a utime goes with the one before it by name.
// labels: NULL = none. Throws Error if there are none.
PictureList list_pictures(const std::filesystem::path &folder, const Labels *labels);

// The pictures of a folder in natural order of their names. Throws Error if there are none.
std::vector<std::filesystem::path> pictures_in(const std::filesystem::path &folder);

// True if the folder contains pictures. Throws Error if it cannot be read.
bool holds_pictures(const std::filesystem::path &folder);

// The visible folders within a folder, in natural order.
std::vector<std::filesystem::path> folders_in(const std::filesystem::path &path);

// The bytes of a picture file. Throws BadFrame.
std::vector<uint8_t> read_picture(const std::filesystem::path &file);

} // namespace vdna::frames
