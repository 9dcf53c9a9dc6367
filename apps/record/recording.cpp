#include "record/recording.hpp"

#include <algorithm>
#include <limits>

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>

namespace vdna::record
{

void Recording::add(const Pass &pass)
{
    add(pass.frame(), pass.output());
}

void Recording::add_thumbnail(const std::string &jpeg)
{
    if (thumbnails.size() + jpeg.size() <= UINT32_MAX)
        thumbnails += jpeg;
    thumbnail_end.push_back(static_cast<uint32_t>(thumbnails.size()));
}

void Recording::require_frames(const std::string &source) const
{
    if (frames == 0)
        throw Error(source + ": none of its " + std::to_string(account.bad) +
                    " frames can be used; the first: " + account.first_bad);
}

void Recording::add(const frames::Frame &frame, const vdna_backbone_frame &output)
{
    if (frames == UINT32_MAX)
        throw Error(frame.name + ": more frames than an experience can hold");
    frames++;
    index.push_back(frame.index);
    utime.push_back(frame.utime);
    add(frame.label, frame.name);
    grey.push_back(output.grey);
    embeddings.insert(embeddings.end(), output.embedding, output.embedding + output.dim);
    last_layer.insert(last_layer.end(), output.last_layer,
                      output.last_layer + output.last_layer_dim);
}

void Recording::add(const frames::Label &label, const std::string &name)
{
    // The first label shows that the frames before it had none.
    if (label.place || !place.empty()) {
        place.resize(frames, VDNA_PLACE_NONE);
        place.back() = label.place.value_or(VDNA_PLACE_NONE);
    }
    if (label.position || !position.empty())
        position.resize(size_t{3} * frames, std::numeric_limits<double>::quiet_NaN());
    if (label.position) {
        if (position_frame.empty())
            position_frame = label.position_frame;
        if (label.position_frame != position_frame)
            throw Error(name + ": its position is in frame " + label.position_frame +
                        ", expected " + position_frame + " as before");
        std::copy(label.position->begin(), label.position->end(), position.end() - 3);
    }
    without_truth += label.lacks_truth;
}

} // namespace vdna::record
