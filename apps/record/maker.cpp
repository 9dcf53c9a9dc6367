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

void count(Draft &draft, const frames::Frame &frame, const vdna_backbone_frame &output)
{
    draft.histogram->add(output.taps, output.tap_count, frame.name);
}

void end_recording(Draft &draft, const Pass &pass)
{
    draft.recording.account = pass.account();
    draft.recording.require_frames(draft.source);
}

// Of finite numbers, as a backbone gives them.
void encode_into(Codes &to, const std::vector<float> &values, size_t rows)
{
    const size_t dim = values.size() / rows;
    to.codes.resize(values.size());
    to.scales.resize(values.empty() ? 0 : rows);
    for (size_t i = 0; i < to.scales.size(); i++)
        vdna_int8_encode(&values[dim * i], dim, &to.codes[dim * i], &to.scales[i]);
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
    learn_projection(drafts);
    for (Draft &draft : drafts)
        end(draft);
}

void Maker::begin(Draft &draft, uint32_t frames_max)
{
    const vdna_backbone_info &network = backbone_.info();
    const uint32_t dim = network.identity.dim, last_layer_dim = network.last_layer_dim;
    const size_t room = frames_max;
    draft.histogram.emplace(ranges_.values, bins_);
    draft.recording.reserve(frames_max, dim, last_layer_dim, thumbnails_.has_value());
    draft.embedding.codes.reserve(keeps_codes() ? room * dim : 0);
    draft.embedding.scales.reserve(keeps_codes() ? room : 0);
    draft.last_layer.codes.reserve(room * last_layer_dim);
    draft.last_layer.scales.reserve(room);
}

void Maker::add(Draft &draft, const frames::Frame &frame, const vdna_backbone_frame &output)
{
    record(draft, frame, output);
    count(draft, frame, output);
}

void Maker::end(Draft &draft)
{
    record::project(draft.recording, blank().identity);
    encode(draft);
}

size_t Maker::frame_bytes() const
{
    const vdna_backbone_info &network = backbone_.info();
    const auto codes = [](uint32_t dim) { return dim > 0 ? dim + sizeof(float) : 0; };
    return Recording::frame_bytes(network.identity.dim, network.last_layer_dim,
                                  thumbnails_.has_value()) +
           (projection_ ? projection_->dims() * sizeof(float) : 0) +
           (keeps_codes() ? codes(network.identity.dim) : 0) + codes(network.last_layer_dim);
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

void Maker::learn_projection(const std::vector<Draft> &drafts)
{
    const vdna_backbone_info &network = backbone_.info();
    if (projection_ || network.embedding_dims == 0)
        return;
    std::vector<const Recording *> parts;
    for (const Draft &draft : drafts)
        parts.push_back(&draft.recording);
    projection_ = principal_directions(parts, network.identity.dim, network.embedding_dims,
                                       std::string("backbone ") + network.identity.backbone);
}

void Maker::encode(Draft &draft) const
{
    const Recording &r = draft.recording;
    if (keeps_codes())
        encode_into(draft.embedding, r.embeddings, r.frames);
    encode_into(draft.last_layer, r.last_layer, r.frames);
}

void Maker::record(Draft &draft, const frames::Frame &frame, const vdna_backbone_frame &output)
{
    draft.recording.add(frame, output);
    if (thumbnails_)
        draft.recording.add_thumbnail(thumbnails_->of(frame));
}

void Maker::record_and_count(Draft &draft)
{
    draft.histogram.emplace(ranges_.values, bins_);
    Pass pass(draft.source, options_, backbone_);
    while (pass.next())
        add(draft, pass.frame(), pass.output());
    end_recording(draft, pass);
}

void Maker::calibrate(std::vector<Draft> &drafts, uint32_t range_rule)
{
    Calibration calibration(backbone_.info());
    for (Draft &draft : drafts) {
        Pass pass(draft.source, options_, backbone_);
        while (pass.next()) {
            record(draft, pass.frame(), pass.output());
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
        count(draft, pass.frame(), pass.output());
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
