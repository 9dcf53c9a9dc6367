#include "frames/source.hpp"

#include <cmath>

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
    if (!is_lcm_log(path))
        throw Error(path + ": not an LCM log, so it has no --pose-channel; set --gps to its track");
    const std::string &local = options.label_options.local_frame;
    return TrackJoin(read_pose_track({path}, options.pose_channel,
                                     local.empty() ? VDNA_FRAME_LOCAL : local, gap_us),
                     path);
}

} // namespace

Source::Source(const std::string &path, const SourceOptions &options)
    : path_(path), options_(options), reader_(open_reader(path, options)),
      labels_(labels_of(path, options)), track_(track_of(path, options)), to_skip_(options.skip)
{
    if (options.skip >= reader_->size())
        throw Error(path + ": has " + std::to_string(reader_->size()) +
                    " frames, expected more than the " + std::to_string(options.skip) + " to skip");
}

bool Source::next(Frame &out_frame)
{
    for (; to_skip_ > 0; to_skip_--)
        if (!reader_->skip())
            return false;
    // Set before reading, so that a bad frame also counts as the frame to keep.
    to_skip_ = options_.every - 1;
    Frame frame;
    if (!reader_->read(frame)) {
        if (labels_)
            labels_->finish();
        if (track_)
            track_->finish();
        return false;
    }
    if (labels_)
        frame.label = labels_->find(frame.file, frame.index);
    if (frame.label.utime)
        frame.utime = *frame.label.utime;
    if (__builtin_add_overflow(frame.utime, options_.time_offset_us, &frame.utime))
        throw Error(frame.name + ": its time and --time-offset are beyond all dates together");
    if (track_)
        track_->label_next(frame.utime, frame.label);
    out_frame = frame;
    return true;
}

uint64_t Source::size() const
{
    return (reader_->size() - options_.skip + options_.every - 1) / options_.every;
}

std::unique_ptr<Reader> open_reader(const std::string &path, const SourceOptions &options)
{
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status))
        throw Error(path + ": not found, expected a folder of pictures, a video or an LCM log");
    if (fs::is_directory(status))
        return open_folder(path, options.rate_hz);
    return is_lcm_log(path) ? open_lcm_log(path, options.camera)
                            : open_video(path, options.rate_hz);
}

} // namespace vdna::frames
