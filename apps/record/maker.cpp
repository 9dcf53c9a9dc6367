#include "record/maker.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include <vdna/int8.h>

namespace vdna::record
{

namespace
{

namespace fs = std::filesystem;

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

// Of finite numbers, as a backbone gives them.
Codes encoded(const std::vector<float> &values, size_t rows)
{
    const size_t dim = values.size() / rows;
    Codes to{std::vector<int8_t>(values.size()), std::vector<float>(values.empty() ? 0 : rows)};
    for (size_t i = 0; i < to.scales.size(); i++)
        vdna_int8_encode(&values[dim * i], dim, &to.codes[dim * i], &to.scales[i]);
    return to;
}

// The numbers as a file has them, NULL for those that it does not have.
template <class Number>
const Number *stored(const std::vector<Number> &numbers)
{
    return numbers.empty() ? nullptr : numbers.data();
}

// The names of the source's files without their folders, which are nobody's business: "drive.mp4",
// "a.mp4+b.mp4".
std::string source_text(const std::string &source)
{
    std::string text;
    for (const std::string &part : frames::parts_of(source))
        text += (text.empty() ? "" : "+") + fs::weakly_canonical(part).filename().string();
    std::replace_if(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text;
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
    project(drafts);
    for (Draft &draft : drafts)
        encode(draft);
}

void Maker::keep_as(const vdna_experience &there)
{
    const uint32_t asked = backbone_.info().embedding_dims;
    if (asked != 0 && asked != there.identity.dim)
        throw Error(std::string("backbone ") + backbone_.info().identity.backbone + ": keeps " +
                    std::to_string(asked) +
                    " numbers of each embedding ('dims' of its manifest), " + there.name + " has " +
                    std::to_string(there.identity.dim) +
                    "; leave 'dims' out, or rebuild all experiences of the map with --force");
    projection_ = projection_of(there.identity);
}

void Maker::project(std::vector<Draft> &drafts)
{
    const vdna_backbone_info &network = backbone_.info();
    if (!projection_ && network.embedding_dims > 0) {
        std::vector<const Recording *> parts;
        for (const Draft &draft : drafts)
            parts.push_back(&draft.recording);
        projection_ = principal_directions(parts, network.identity.dim, network.embedding_dims,
                                           std::string("backbone ") + network.identity.backbone);
    }
    for (Draft &draft : drafts)
        record::project(draft.recording, blank().identity);
}

void Maker::encode(Draft &draft) const
{
    const Recording &r = draft.recording;
    if (backbone_.info().embedding_int8 != 0)
        draft.embedding = encoded(r.embeddings, r.frames);
    draft.last_layer = encoded(r.last_layer, r.frames);
}

void Maker::record(Draft &draft, const Pass &pass)
{
    draft.recording.add(pass);
    if (thumbnails_)
        draft.recording.add_thumbnail(thumbnails_->of(pass.frame()));
}

void Maker::record_and_count(Draft &draft)
{
    draft.histogram.emplace(ranges_.values, bins_);
    Pass pass(draft.source, options_, backbone_);
    while (pass.next()) {
        record(draft, pass);
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
            record(draft, pass);
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
    if (projection_)
        projection_->set_in(e.identity);
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
    e.embedding_codes = stored(draft.embedding.codes);
    e.embedding_scale = stored(draft.embedding.scales);
    e.last_layer = stored(draft.last_layer.codes);
    e.last_layer_scale = stored(draft.last_layer.scales);
    e.last_layer_dim = backbone_.info().last_layer_dim;
    e.frame_utime = r.utime.data();
    e.frame_place = stored(r.place);
    e.frame_position = stored(r.position);
    e.frame_grey = r.grey.data();
    r.position_frame.copy(e.position_frame, sizeof e.position_frame - 1);
    r.account.order.copy(e.order, sizeof e.order - 1);
    vdna_name_replace(e.order);
    source_text(draft.source).copy(e.source, sizeof e.source - 1);
    if (r.thumbnails.empty())
        return e;
    e.thumbnails = reinterpret_cast<const uint8_t *>(r.thumbnails.data());
    e.thumbnail_end = r.thumbnail_end.data();
    e.thumbnail_bytes = r.thumbnail_end.back();
    return e;
}

} // namespace vdna::record
