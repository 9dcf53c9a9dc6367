#include "frames/source.hpp"

#include "frames/log_events.hpp"
#include "frames/mcap_file.hpp"
#include "frames/mcap_log.hpp"
#include "frames/pose_track.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

std::optional<Labels> labels_of(const std::string &path, const SourceOptions &options)
{
    if (!options.labelled)
        return {};
    if (!options.labels.empty())
        return Labels(options.labels, options.label_options);
    const fs::path own = fs::path(path) / "labels.csv";
    if (!fs::exists(own))
        return {};
    return Labels(own, options.label_options);
}

std::optional<TrackJoin> track_of(const std::string &path, const SourceOptions &options)
{
    const int64_t gap_us = std::llround(options.gps_gap_s * 1e6);
    if (!options.labelled || (options.gps.empty() && options.pose_channel.empty()))
        return {};
    if (!options.gps.empty())
        return TrackJoin(Track::from_file(options.gps, gap_us), path);
    const std::vector<std::string> logs = parts_of(path);
    if (is_mcap(logs.front()))
        return TrackJoin(read_mcap_track(logs, options.pose_channel, gap_us), path);
    if (!is_lcm_log(logs.front()))
        throw Error(path + ": neither an LCM log nor an MCAP file, so it has no --pose-channel; "
                           "set --gps to its track");
    const std::string &local = options.label_options.local_frame;
    return TrackJoin(read_pose_track(logs, options.pose_channel,
                                     local.empty() ? VDNA_FRAME_LOCAL : local, gap_us),
                     path);
}

std::vector<int64_t> stamps_of_labels(const std::optional<Labels> &labels)
{
    return labels ? labels->frame_utimes() : std::vector<int64_t>();
}

// The stamps of the frames that are known beforehand.
std::vector<int64_t> stamps_of(const Reader &reader, const std::optional<Labels> &labels)
{
    const std::vector<int64_t> of_labels = stamps_of_labels(labels);
    return of_labels.empty() ? reader.stamps() : of_labels;
}

} // namespace

Source::Source(const std::string &path, const SourceOptions &options)
    : path_(path), options_(options), labels_(labels_of(path, options)),
      track_(track_of(path, options)),
      reader_(open_reader(path, options, labels_ ? &*labels_ : nullptr)),
      axis_(stamps_of(*reader_, labels_), options.time_unit,
            static_cast<int64_t>(options.late_s * 1e6)),
      to_skip_(options.skip)
{
    const std::vector<int64_t> stamps = stamps_of_labels(labels_);
    if (!stamps.empty())
        label_stamp_ = stamps.front();
    if (reader_->size() > 0 && options.skip >= reader_->size())
        throw Error(path + ": has " + std::to_string(reader_->size()) +
                    " frames, expected more than the " + std::to_string(options.skip) + " to skip");
}

bool Source::next(Frame &out_frame)
{
    for (;;) {
        Frame frame;
        if (!read(frame)) {
            complain_of_rows_without_frames();
            finish();
            return false;
        }
        const std::optional<int64_t> utime = axis_.take(frame.utime);
        if (!utime)
            continue;
        frame.utime = *utime;
        place(frame);
        out_frame = frame;
        return true;
    }
}

// Give a frame its time in the world, and the position that a track has for it.
void Source::place(Frame &frame)
{
    if (__builtin_add_overflow(frame.utime, options_.time_offset_us, &frame.utime))
        throw Error(frame.name + ": its time and --time-offset are beyond all dates together");
    if (track_)
        track_->label_next(frame.utime, frame.label);
}

void Source::finish() const
{
    if (labels_)
        labels_->finish();
    if (track_)
        track_->finish();
}

bool Source::read(Frame &out_frame)
{
    for (; to_skip_ > 0; to_skip_--, read_++)
        if (!reader_->skip())
            return false;
    // Set before reading, so that a bad frame also counts as the frame to keep.
    to_skip_ = options_.every - 1;
    if (!reader_->read(out_frame))
        return false;
    read_++;
    if (labels_)
        out_frame.label = labels_->find(out_frame.file, out_frame.index);
    if (label_stamp_) {
        label_stamp_ = out_frame.label.utime ? out_frame.label.utime : label_stamp_;
        out_frame.utime = *label_stamp_;
    }
    return true;
}

// A table that numbers frames tells how many there should be.
void Source::complain_of_rows_without_frames()
{
    const uint64_t rows = labels_ ? labels_->numbered_frames() : 0;
    const uint64_t frames = std::max(read_, reader_->size());
    if (rows <= frames)
        return;
    read_ = rows;
    throw BadFrame(path_ + ": ends after " + std::to_string(frames) +
                       " frames, but the table has rows up to frame " + std::to_string(rows - 1),
                   rows - frames);
}

uint64_t Source::size() const
{
    if (reader_->size() <= options_.skip)
        return 0;
    return (reader_->size() - options_.skip + options_.every - 1) / options_.every;
}

Account Source::account() const
{
    Account account;
    account.expected = reader_->size();
    reader_->describe(account);
    axis_.describe(account);
    return account;
}

std::unique_ptr<Reader> open_reader(const std::string &path, const SourceOptions &options,
                                    const Labels *labels)
{
    const std::vector<std::string> parts = parts_of(path);
    if (parts.size() > 1)
        return open_joined(parts, options);
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status))
        throw Error(path + ": not found, expected a folder of pictures, a video, an LCM log or an "
                           "MCAP file");
    if (fs::is_directory(status))
        return open_folder(path, options.rate_hz, labels);
    if (is_mcap(path))
        return open_mcap(path, options);
    return is_lcm_log(path) ? open_lcm_log(path, options) : open_video(path, options.rate_hz);
}

} // namespace vdna::frames
