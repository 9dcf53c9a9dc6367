// Sources of frames: a folder of pictures, a video file, or an LCM log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/image.h>
#include <vdna/transport.h>

#include "frames/labels.hpp"
#include "frames/track_join.hpp"

namespace vdna::frames
{

// How to read a source.
struct SourceOptions {
    double rate_hz = 10;                      // of pictures without a time stamp, > 0
    std::string camera = VDNA_CHANNEL_CAMERA; // channel of an LCM log
    std::string labels;                       // CSV file; "" = labels.csv of the folder, if present
    bool labelled = true;                     // false: neither labels nor track are read
    LabelOptions label_options;
    uint64_t skip = 0;     // frames left out at the start
    uint64_t every = 1;    // of the rest, keep every N-th frame, >= 1
    bool skip_bad = false; // for Pass: leave out unusable frames

    int64_t time_offset_us = 0; // added to the times of all frames
    std::string gps;            // track whose positions are the frames' truth; "" = none
    std::string pose_channel;   // of an LCM log, whose poses are such a track; "" = none
    double gps_gap_s = 2;       // fixes of a track further apart than this are not joined, > 0
};

// One frame. `image.data` is borrowed until the next frame is read.
struct Frame {
    uint64_t index = 0;         // in the source, from 0, including skipped frames
    int64_t utime = 0;          // microseconds: the label's, else the camera's, else index / rate
    std::string name;           // for complaints: path of the picture, or "drive.mp4: frame 12"
    std::filesystem::path file; // of a picture; "" for videos and logs
    vdna_image image{};
    Label label;
};

// This frame cannot be used, but later ones may be.
class BadFrame : public Error
{
  public:
    using Error::Error;
};

// One kind of source, without options.
class Reader
{
  public:
    virtual ~Reader() = default;
    // The next frame, without its label; false at the end. Throws BadFrame, or Error.
    virtual bool read(Frame &out_frame) = 0;
    // Skip the next frame; false at the end.
    virtual bool skip() = 0;
    // All frames of the source; for a video, the number in its header.
    virtual uint64_t size() const = 0;
};

// The frames of one source, in order.
class Source
{
  public:
    // Throws Error if there is nothing to read.
    explicit Source(const std::string &path, const SourceOptions &options = {});

    // The next frame; false at the end. Throws BadFrame, or Error if a label is missing.
    bool next(Frame &out_frame);
    // The total number of frames that next() will return, as far as known.
    uint64_t size() const;
    const std::string &path() const { return path_; }

  private:
    std::string path_;
    SourceOptions options_;
    std::unique_ptr<Reader> reader_;
    std::optional<Labels> labels_;
    std::optional<TrackJoin> track_;
    uint64_t to_skip_; // before the next frame
};

// The readers; open_reader() chooses one by the path and the first bytes of the file.
std::unique_ptr<Reader> open_reader(const std::string &path, const SourceOptions &options);
std::unique_ptr<Reader> open_folder(const std::filesystem::path &path, double rate_hz);
std::unique_ptr<Reader> open_video(const std::string &path, double rate_hz);
std::unique_ptr<Reader> open_lcm_log(const std::string &path, const std::string &channel);

// The pictures of a folder, in the order of their names. Throws Error if there are none.
std::vector<std::filesystem::path> pictures_in(const std::filesystem::path &folder);

// True if the folder contains pictures. Throws Error if it cannot be read.
bool holds_pictures(const std::filesystem::path &folder);

// The bytes of a picture file. Throws BadFrame.
std::vector<uint8_t> read_picture(const std::filesystem::path &file);

// True if the file begins like an LCM log.
bool is_lcm_log(const std::string &path);

} // namespace vdna::frames
