#include "eval/frames.hpp"

#include <cmath>

#include "frames/camera_image.hpp"
#include "frames/source.hpp"
#include "program/interrupt.hpp"
#include "program/progress.hpp"

namespace vdna::eval
{

namespace
{

frames::Frame labelled(const frames::DatasetFrame &from, uint64_t index, double rate_hz)
{
    frames::Frame frame;
    frame.index = index;
    frame.file = from.file;
    frame.name = from.file.string();
    frame.label = from.label;
    frame.utime = from.label.utime ? *from.label.utime
                                   : std::llround(static_cast<double>(index) * 1e6 / rate_hz);
    return frame;
}

[[noreturn]] void complain_of_lost_entry(const std::string &name)
{
    throw Error(name + ": its activations cannot be read back from the cache; is the disk full?");
}

} // namespace

Frames::Frames(const frames::Dataset &dataset, Backbone &backbone, const Cache &cache,
               const FramesOptions &options)
    : backbone_(backbone), cache_(cache), frame_cache_(cache, backbone.info()),
      keys_(dataset.traversals.size())
{
    for (const frames::DatasetTraversal &from : dataset.traversals) {
        Traversal &to = traversals_.emplace_back(Traversal{from.name, from.group, {}, {}});
        record(from, to, keys_[traversals_.size() - 1], options);
    }
}

void Frames::record(const frames::DatasetTraversal &from, Traversal &to,
                    std::vector<std::string> &keys, const FramesOptions &options)
{
    to.recording.account = from.account;
    program::Progress progress(from.name, from.frames.size());
    for (size_t i = 0; i < from.frames.size(); i++) {
        program::require_not_interrupted();
        progress.advance();
        const frames::Frame frame = labelled(from.frames[i], i, options.rate_hz);
        try {
            const std::vector<uint8_t> picture = frames::read_picture(frame.file);
            const std::string key = frame_cache_.key_of(picture);
            to.recording.add(frame, frame_of(picture, key, frame.name).view());
            to.files.push_back(frame.file);
            keys.push_back(key);
        } catch (const frames::BadFrame &bad) {
            if (!options.skip_bad)
                throw Error(bad.what() + std::string("; replace or remove it, or leave out "
                                                     "pictures like it with --skip-bad"));
            if (to.recording.account.bad++ == 0)
                to.recording.account.first_bad = bad.what();
        }
    }
    to.recording.require_frames(from.name);
}

void Frames::keep_labels(record::Unit unit)
{
    for (Traversal &traversal : traversals_) {
        if (unit != record::Unit::places)
            traversal.recording.place.clear();
        if (unit != record::Unit::metres) {
            traversal.recording.position.clear();
            traversal.recording.position_frame.clear();
        }
    }
}

CachedFrame Frames::frame_of(const std::vector<uint8_t> &picture, const std::string &key,
                             const std::string &name)
{
    if (std::optional<CachedFrame> found = frame_cache_.find(key)) {
        cached_++;
        return std::move(*found);
    }
    compute(picture, key, name);
    computed_++;
    std::optional<CachedFrame> stored = frame_cache_.find(key);
    if (!stored)
        complain_of_lost_entry(name);
    return std::move(*stored);
}

void Frames::compute(const std::vector<uint8_t> &picture, const std::string &key,
                     const std::string &name)
{
    const vdna_image encoded = {picture.data(), picture.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
    frame_cache_.store(key, output_of(frames::camera_image(encoded, name, converter_), name));
}

vdna_backbone_frame Frames::output_of(const vdna_image &image, const std::string &name)
{
    vdna_error error{};
    vdna_backbone_frame output;
    const vdna_status status = vdna_backbone_run(backbone_.get(), &image, &error, &output);
    const std::string sentence = name + ": " + error.text;
    if (status == VDNA_ERR_FORMAT || status == VDNA_ERR_UNSUPPORTED || status == VDNA_ERR_NONFINITE)
        throw frames::BadFrame(sentence);
    if (status != VDNA_OK)
        throw Error(sentence);
    return output;
}

const std::vector<vdna_activations> &Frames::taps(size_t traversal, uint32_t frame)
{
    const std::string &key = keys_[traversal][frame];
    std::optional<CachedTaps> found = frame_cache_.find_taps(key);
    if (!found) { // damaged, or removed since
        const std::filesystem::path &file = traversals_[traversal].files[frame];
        compute(frames::read_picture(file), key, file.string());
        found = frame_cache_.find_taps(key);
        if (!found)
            complain_of_lost_entry(file.string());
    }
    taps_ = std::move(*found);
    return taps_.taps;
}

} // namespace vdna::eval
