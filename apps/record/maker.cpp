#include "record/maker.hpp"

#include <cstring>

#include <vdna/cpp/error.hpp>
#include <vdna/int8.h>

namespace vdna::record
{

namespace
{

// Memory limit for activations, which save a second run of the network.
constexpr size_t activation_bytes_max = size_t{512} << 20;

void count(Draft &draft, const Pass &pass)
{
    draft.histogram->add(pass.output().taps, pass.output().tap_count, pass.frame().name);
}

void end_recording(Draft &draft, const Pass &pass)
{
    draft.recording.account = pass.account();
    draft.recording.require_frames(draft.source);
}

void encode_embeddings(Draft &draft)
{
    const std::vector<float> &values = draft.recording.embeddings;
    const size_t frames = draft.recording.frames, dim = values.size() / frames;
    draft.embedding_codes.resize(values.size());
    draft.embedding_scale.resize(frames);
    for (size_t i = 0; i < frames; i++)
        require(vdna_int8_encode(&values[dim * i], dim, &draft.embedding_codes[dim * i],
                                 &draft.embedding_scale[i]),
                draft.source);
}

} // namespace

Maker::Maker(Backbone &backbone, const frames::SourceOptions &options, uint32_t bins)
    : backbone_(backbone), options_(options), bins_(bins), ranges_{"", {}, {}},
      store_(activation_bytes_max)
{
}

void Maker::make(std::vector<Draft> &drafts, uint32_t range_rule)
{
    if (ranges_.values.empty()) {
        calibrate(drafts, range_rule);
    } else {
        for (Draft &draft : drafts)
            record_and_count(draft);
    }
    if (backbone_.info().embedding_int8 != 0)
        for (Draft &draft : drafts)
            encode_embeddings(draft);
}

void Maker::record_and_count(Draft &draft)
{
    draft.histogram.emplace(ranges_.values, bins_);
    Pass pass(draft.source, options_, backbone_);
    while (pass.next()) {
        draft.recording.add(pass);
        count(draft, pass);
    }
    end_recording(draft, pass);
}

void Maker::calibrate(std::vector<Draft> &drafts, uint32_t range_rule)
{
    Calibration calibration(backbone_.info());
    for (Draft &draft : drafts) {
        Pass pass(draft.source, options_, backbone_);
        while (pass.next()) {
            draft.recording.add(pass);
            calibration.observe(pass.output(), pass.frame().name);
            store_.add(pass.output());
        }
        end_recording(draft, pass);
    }
    ranges_ = calibration.ranges(range_rule);
    for (Draft &draft : drafts)
        draft.histogram.emplace(ranges_.values, bins_);
    if (store_.complete())
        count_stored(drafts);
    else
        for (Draft &draft : drafts)
            count_again(draft);
}

void Maker::count_stored(std::vector<Draft> &drafts) const
{
    size_t next = 0;
    for (Draft &draft : drafts)
        for (uint32_t i = 0; i < draft.recording.frames; i++) {
            const std::vector<vdna_activations> taps = store_.taps(next++);
            draft.histogram->add(taps.data(), taps.size(), draft.source);
        }
}

// The second pass through the network, needed if there were too many activations to keep.
void Maker::count_again(Draft &draft)
{
    for (Pass pass(draft.source, options_, backbone_); pass.next();)
        count(draft, pass);
    if ((*draft.histogram)->frames != draft.recording.frames)
        throw Error(draft.source + ": changed while it was read");
}

vdna_experience Maker::blank() const
{
    vdna_experience e{};
    e.identity = backbone_.info().identity;
    e.identity.bins = bins_;
    e.identity.range = ranges_.values.empty() ? nullptr : ranges_.values.data();
    return e;
}

vdna_experience Maker::experience_of(const Draft &draft) const
{
    const Recording &r = draft.recording;
    const Histogram &histogram = *draft.histogram;
    vdna_experience e = blank();
    std::memcpy(e.name, draft.name.c_str(), draft.name.size() + 1);
    e.frames = r.frames;
    e.counts = histogram->counts;
    e.mass = histogram->mass;
    e.embeddings = r.embeddings.data();
    if (!draft.embedding_codes.empty()) {
        e.embedding_codes = draft.embedding_codes.data();
        e.embedding_scale = draft.embedding_scale.data();
    }
    e.last_layer = r.last_layer.empty() ? nullptr : r.last_layer.data();
    e.last_layer_scale = r.last_layer.empty() ? nullptr : r.last_layer_scale.data();
    e.last_layer_dim = r.last_layer_dim;
    e.frame_utime = r.utime.data();
    e.frame_place = r.place.empty() ? nullptr : r.place.data();
    e.frame_position = r.position.empty() ? nullptr : r.position.data();
    e.frame_grey = r.grey.data();
    r.position_frame.copy(e.position_frame, sizeof e.position_frame - 1);
    r.account.order.copy(e.order, sizeof e.order - 1);
    vdna_name_replace(e.order);
    return e;
}

} // namespace vdna::record
