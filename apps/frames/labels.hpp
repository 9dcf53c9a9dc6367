// Labels of frames (time, place, position): a CSV table with one row per picture or frame.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "frames/fixes.hpp"
#include "frames/picture_names.hpp"

namespace vdna::frames
{

// The label of one frame.
struct Label {
    std::optional<int64_t> utime;                  // camera stamp, microseconds
    std::optional<int64_t> place;                  // place number
    std::optional<std::array<double, 3>> position; // metres, in position_frame
    std::string position_frame; // VDNA_FRAME_WGS84: Earth-centred, made from GPS; else the name of
                                // a local frame; "" without a position
    bool lacks_truth = false;   // others of its table have a place or a position, this one has none
};

// How to read a table of labels.
struct LabelOptions {
    std::string local_frame; // name of the frame of x,y[,z]; "" = the table's, else
                             // VDNA_FRAME_LOCAL
    bool of_several = false; // the table is about several sources: its names are relative to it
};

// The rows of one CSV file. Columns: `file` or `frame` (index from 0), and `place`, or `x,y[,z]` in
// metres, or `lat,lon[,alt]` in WGS84 degrees and metres, or `utime`; `position_frame` names the
// frame of x,y. Others are ignored. A row with empty cells for its place or position has none, and
// so has a frame without a row; positions that nobody can have been at are left out and told once.
// Pictures are named relative to the table or to their folder; spellings may differ as PictureNames
// says.
class Labels
{
  public:
    // Throws Error with file and line if a row breaks these rules.
    explicit Labels(const std::filesystem::path &csv, const LabelOptions &options = {});

    // The row of a frame, identified by its index and, for a picture, its path ("" otherwise); a
    // label that lacks truth if there is none. Throws Error if the table is about other pictures.
    const Label &find(const std::filesystem::path &file, uint64_t frame) const;
    // At the end of a source. Throws Error if find() never found a row.
    void finish() const;

    // Files in `folder` or below that rows are about, other than `files`, which are in the folder.
    std::vector<std::filesystem::path>
    others_below(const std::filesystem::path &folder,
                 const std::vector<std::filesystem::path> &files) const;
    // The stamps of a table that numbers frames, in the order of these numbers.
    std::vector<int64_t> frame_utimes() const;
    // One more than the largest frame number; 0 for a table of files.
    uint64_t numbered_frames() const;

    // What was left out: "4 fixes left out: 3 at 0,0, 1 beyond the globe"; "" if nothing.
    const std::string &note() const { return note_; }

  private:
    void require_row_in(const std::filesystem::path &file) const;

    std::string csv_;
    bool by_file_ = false;
    std::string note_;
    std::vector<Label> rows_;
    std::vector<size_t> lines_;                       // of the rows
    PictureNames names_;                              // of the rows, if by_file_
    std::map<uint64_t, size_t> frames_;               // rows by index otherwise
    Label none_;                                      // of a frame without a row
    mutable std::set<std::filesystem::path> folders_; // with pictures that have a row
    mutable uint64_t found_ = 0, missed_ = 0, first_missed_ = 0, last_missed_ = 0;
};

} // namespace vdna::frames
