#include "record/recording.hpp"

namespace vdna::record
{

void Recording::add(const Pass &pass)
{
    add(pass.frame(), pass.output());
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
    if (frame.label.place)
        place.push_back(*frame.label.place);
    if (frame.label.position)
        position.insert(position.end(), frame.label.position->begin(), frame.label.position->end());
    grey.push_back(output.grey);
    embeddings.insert(embeddings.end(), output.embedding, output.embedding + output.dim);
}

} // namespace vdna::record
