// Sources of frames: a folder of pictures, a video file, an LCM log, an MCAP file, or several files
// of one drive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vdna/camera_time.h>
#include <vdna/cpp/error.hpp>
#include <vdna/image.h>
#include <vdna/transport.h>

#include "frames/account.hpp"
#include "frames/labels.hpp"
#include "frames/time_axis.hpp"
#include "frames/track_join.hpp"

namespace vdna::frames
{

// How to read a source.
struct SourceOptions {
    double rate_hz = 10;                             // of pictures without a time stamp, > 0
    std::string camera = VDNA_CHANNEL_CAMERA;        // channel of an LCM log, topic of an MCAP
                                                     // file; if that has none of this name, the
                                                     // only one with pictures
    std::string camera_option = "--camera";          // what complaints call the option that sets it
    uint32_t time_unit = VDNA_TIME_UNIT_AUTO;        // of time stamps
    double late_s = VDNA_TIME_LATE_US_DEFAULT / 1e6; // frames this much older than the newest are
                                                     // late and left out, >= 0
    std::string labels;   // CSV file; "" = labels.csv of the folder, if present
    bool labelled = true; // false: neither labels nor track are read
    LabelOptions label_options;
    uint64_t skip = 0;     // frames left out at the start
    uint64_t every = 1;    // of the rest, keep every N-th frame, >= 1
    bool skip_bad = false; // for Pass: leave out unusable frames

    int64_t time_offset_us = 0; // added to the times of all frames
    std::string gps;            // track whose positions are the frames' truth; "" = none
    std::string pose_channel; // of an LCM log or MCAP file, whose poses are such a track; "" = none
    double gps_gap_s = 2;     // fixes of a track further apart than this are not joined, > 0
};

// One frame. `image.data` is borrowed until the next frame is read.
struct Frame {
    uint64_t index = 0;         // in the source, from 0, including skipped frames
    int64_t utime = 0;          // microseconds: the label's, else the camera's or the video's,
                                // else of a regular beat
    std::string name;           // for complaints: path of the picture, or "drive.mp4: frame 12"
    std::filesystem::path file; // of a picture; "" for videos and logs
    vdna_image image{};
    Label label;
};

// Some frames cannot be used or are missing, but later ones may be there.
class BadFrame : public Error
{
  public:
    explicit BadFrame(const std::string &sentence, uint64_t frames = 1)
        : Error(sentence), frames_(frames)
    {
    }
    uint64_t frames() const { return frames_; } // how many, >= 1

  private:
    uint64_t frames_;
};

// One kind of source, without options.
class Reader
{
  public:
    virtual ~Reader() = default;
    // The next frame, without its label, its time in the source's unit; false at the end. Throws
    // BadFrame, or Error.
    virtual bool read(Frame &out_frame) = 0;
    // Skip the next frame; false at the end. Throws BadFrame where frames are missing.
    virtual bool skip() = 0;
    // Frames that the source should have; 0 = it does not say.
    virtual uint64_t size() const = 0;
    // The times of its frames in their order, as far as they are known beforehand and someone
    // stamped them.
    virtual std::vector<int64_t> stamps() const { return {}; }
    // Fill in order and notes.
    virtual void describe(Account &account) const = 0;
};

// The frames of one source, in the order of their times.
class Source
{
  public:
    // Throws Error if there is nothing to read.
    explicit Source(const std::string &path, const SourceOptions &options = {});

    // The next frame that is not late; false at the end. Throws BadFrame, or Error.
    bool next(Frame &out_frame);
    // The total number of frames that next() will return, late ones included; 0 = unknown.
    uint64_t size() const;
    const std::string &path() const { return path_; }
    // What has been read so far.
    Account account() const;

  private:
    bool read(Frame &out_frame);
    void place(Frame &frame);
    void complain_of_rows_without_frames();
    void finish() const;

    std::string path_;
    SourceOptions options_;
    std::optional<Labels> labels_;
    std::optional<TrackJoin> track_;
    std::unique_ptr<Reader> reader_;
    TimeAxis axis_;
    uint64_t to_skip_;  // before the next frame
    uint64_t read_ = 0; // frames, skipped ones included
    // Of a table that numbers frames and stamps them: the newest stamp, which also counts for
    // frames without one.
    std::optional<int64_t> label_stamp_;
};

// The readers; open_reader() chooses one by the path and the first bytes of the file. labels: NULL
// = none; borrowed for the call.
std::unique_ptr<Reader> open_reader(const std::string &path, const SourceOptions &options,
                                    const Labels *labels);
std::unique_ptr<Reader> open_folder(const std::filesystem::path &path, double rate_hz,
                                    const Labels *labels);
std::unique_ptr<Reader> open_video(const std::string &path, double rate_hz);
std::unique_ptr<Reader> open_lcm_log(const std::string &path, const SourceOptions &options);
std::unique_ptr<Reader> open_mcap(const std::string &path, const SourceOptions &options);

// Several files as one source, in the order given; only videos, LCM logs or MCAP files can be
// joined.
std::unique_ptr<Reader> open_joined(const std::vector<std::string> &paths,
                                    const SourceOptions &options);

// Join the files among these sources that a recorder cut: those that differ only in a number at the
// end of their names, "drive.lcm.00" and "drive.lcm.01". Others stay as they are.
std::vector<std::string> join_numbered(const std::vector<std::string> &sources);

// Files of one drive, in their order, as the path of one source.
std::string join(const std::vector<std::string> &paths);

// The name of a drive: that of its folder or file, without endings and the numbers of cut files.
std::string drive_name_of(const std::string &source);

// The paths of a source that names several files, as "a.mp4+b.mp4" does; one if the whole text is
// the name of a file, or if any part is not.
std::vector<std::string> parts_of(const std::string &path);

} // namespace vdna::frames
