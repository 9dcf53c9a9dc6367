#include "frames.hpp"

#include <cmath>

#include "interrupt/interrupt.hpp"
#include "progress/progress.hpp"
#include "source.hpp"

namespace vdna
{

namespace
{

// So much memory may be spent on not reading the cache again.
constexpr size_t activation_bytes_max = size_t{512} << 20;

Frame frame_of(const DatasetFrame &from, uint64_t index, double rate_hz)
{
    Frame frame;
    frame.index = index;
    frame.file = from.file;
    frame.name = from.file.string();
    frame.label = from.label;
    frame.utime = from.label.utime ? *from.label.utime
                                   : std::llround(static_cast<double>(index) * 1e6 / rate_hz);
    return frame;
}

} // namespace

Frames::Frames(const Dataset &dataset, Backbone &backbone, const FrameCache &cache,
               const FramesOptions &options)
    : cache_(cache), backbone_(backbone.info()), keys_(dataset.traversals.size()),
      store_(activation_bytes_max)
{
    size_t frames = 0;
    for (const DatasetTraversal &from : dataset.traversals) {
        first_.push_back(frames);
        Traversal &to = traversals_.emplace_back(Traversal{from.name, from.group, {}, {}});
        record(from, to, backbone, options);
        frames += to.recording.frames;
    }
}

void Frames::record(const DatasetTraversal &from, Traversal &to, Backbone &backbone,
                    const FramesOptions &options)
{
    Progress progress(from.name, from.frames.size());
    for (size_t i = 0; i < from.frames.size(); i++) {
        require_not_interrupted();
        progress.advance();
        const Frame frame = frame_of(from.frames[i], i, options.rate_hz);
        try {
            const std::vector<uint8_t> picture = read_picture(frame.file);
            const std::string key = cache_.key_of(picture);
            const CachedFrame output = run(picture, key, frame.name, backbone);
            to.recording.add(frame, output.view());
            to.files.push_back(frame.file);
            store_.add(output.view());
            keys_[traversals_.size() - 1].push_back(key);
        } catch (const BadFrame &bad) {
            if (!options.skip_bad)
                throw Error(bad.what() + std::string("; replace or remove it, or leave out "
                                                     "pictures like it with --skip-bad"));
            to.recording.bad++;
        }
    }
    if (to.recording.frames == 0)
        throw Error(from.name + ": none of its " + std::to_string(from.frames.size()) +
                    " pictures can be used");
}

CachedFrame Frames::run(const std::vector<uint8_t> &picture, const std::string &key,
                        const std::string &name, Backbone &backbone)
{
    if (std::optional<CachedFrame> found = cache_.find(key)) {
        cached_++;
        return std::move(*found);
    }
    const vdna_image image = {picture.data(), picture.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
    vdna_error error{};
    vdna_backbone_frame output;
    const vdna_status status = vdna_backbone_run(backbone.get(), &image, &error, &output);
    const std::string sentence = name + ": " + error.text;
    if (status == VDNA_ERR_FORMAT || status == VDNA_ERR_UNSUPPORTED || status == VDNA_ERR_NONFINITE)
        throw BadFrame(sentence);
    if (status != VDNA_OK)
        throw Error(sentence);
    cache_.store(key, output);
    computed_++;
    std::optional<CachedFrame> stored = cache_.find(key);
    if (!stored)
        throw Error(name + ": its activations cannot be read back from the cache; is the disk "
                           "full?");
    return std::move(*stored);
}

const std::vector<vdna_activations> &Frames::taps(size_t traversal, uint32_t frame)
{
    if (store_.complete()) {
        taps_ = store_.taps(first_[traversal] + frame);
        return taps_;
    }
    const std::string &key = keys_[traversal][frame];
    std::optional<CachedFrame> found = cache_.find(key);
    if (!found)
        throw Error(traversals_[traversal].files[frame].string() +
                    ": its activations are gone from the cache; run again");
    from_disk_ = std::move(*found);
    taps_ = from_disk_.taps;
    return taps_;
}

} // namespace vdna
