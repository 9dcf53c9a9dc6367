#include "eval/reference_maps.hpp"

#include <algorithm>

#include "record/truth.hpp"

namespace vdna::eval
{

namespace
{

// The frame of a part that is nearest to a place and within tolerance of it; part.frames if none
// is. truth: of the part, in the map that has the place.
uint32_t frame_at(uint32_t place, const record::Recording &part, const record::Truth &truth,
                  double tolerance)
{
    uint32_t nearest = part.frames;
    for (uint32_t frame = 0; frame < part.frames; frame++)
        if (truth.apart(frame, place) <= tolerance && // not if unknown, either
            (nearest == part.frames || truth.apart(frame, place) < truth.apart(nearest, place)))
            nearest = frame;
    return nearest;
}

// The fused map while its parts come in.
class Fusion
{
  public:
    Fusion(uint32_t dim, double tolerance, bool with_altitude)
        : dim_(dim), tolerance_(tolerance), with_altitude_(with_altitude)
    {
    }

    void add(const record::Recording &part)
    {
        const record::Truth truth(part, map_of(map_, dim_), with_altitude_);
        const uint32_t known = map_.frames;
        std::vector<bool> is_far(part.frames, true);
        for (uint32_t place = 0; place < known; place++)
            add_nearest(place, part, truth, is_far);
        const record::Truth labels(part, map_of(part, dim_), with_altitude_);
        for (uint32_t frame = 0; frame < part.frames; frame++)
            if (is_far[frame] && labels.knows(frame))
                open_place(part, frame);
    }

    record::Recording means()
    {
        for (size_t i = 0; i < sums_.size(); i++)
            map_.embeddings[i] = static_cast<float>(sums_[i] / parts_[i / dim_]);
        return std::move(map_);
    }

  private:
    // Also marks the frames that are within tolerance of the place.
    void add_nearest(uint32_t place, const record::Recording &part, const record::Truth &truth,
                     std::vector<bool> &is_far)
    {
        for (uint32_t frame = 0; frame < part.frames; frame++)
            if (truth.apart(frame, place) <= tolerance_)
                is_far[frame] = false;
        const uint32_t nearest = frame_at(place, part, truth, tolerance_);
        if (nearest == part.frames)
            return;
        parts_[place]++;
        for (uint32_t i = 0; i < dim_; i++)
            sums_[size_t{dim_} * place + i] += part.embeddings[size_t{dim_} * nearest + i];
    }

    void open_place(const record::Recording &part, uint32_t frame)
    {
        append(map_, part, frame, dim_);
        parts_.push_back(1);
        sums_.insert(sums_.end(), &part.embeddings[size_t{dim_} * frame],
                     &part.embeddings[size_t{dim_} * frame] + dim_);
    }

    uint32_t dim_;
    double tolerance_;
    bool with_altitude_;
    record::Recording map_;
    std::vector<double> sums_;    // [places][dim], of embeddings
    std::vector<uint32_t> parts_; // [places], in the sum
};

// Of the embeddings, [dim].
std::vector<double> mean_of(const record::Recording &recording, uint32_t dim)
{
    std::vector<double> mean(dim);
    for (size_t i = 0; i < recording.embeddings.size(); i++)
        // NOLINTNEXTLINE(*DivideZero): embeddings have numbers
        mean[i % dim] += double{recording.embeddings[i]} / recording.frames;
    return mean;
}

} // namespace

vdna_experience map_of(const record::Recording &recording, uint32_t dim)
{
    vdna_experience map{};
    map.frames = recording.frames;
    map.identity.dim = dim;
    map.embeddings = recording.embeddings.data();
    map.frame_place = recording.place.empty() ? nullptr : recording.place.data();
    map.frame_position = recording.position.empty() ? nullptr : recording.position.data();
    recording.position_frame.copy(map.position_frame, sizeof map.position_frame - 1);
    return map;
}

void append(record::Recording &to, const record::Recording &from, uint32_t frame, uint32_t dim)
{
    to.frames++;
    to.position_frame = from.position_frame;
    if (!from.place.empty())
        to.place.push_back(from.place[frame]);
    if (!from.position.empty())
        to.position.insert(to.position.end(), &from.position[size_t{3} * frame],
                           &from.position[size_t{3} * frame] + 3);
    to.embeddings.insert(to.embeddings.end(), &from.embeddings[size_t{dim} * frame],
                         &from.embeddings[size_t{dim} * frame] + dim);
}

record::Recording joined(const std::vector<const record::Recording *> &parts, uint32_t dim)
{
    record::Recording all;
    for (const record::Recording *part : parts)
        for (uint32_t i = 0; i < part->frames; i++)
            append(all, *part, i, dim);
    return all;
}

void give_one_mean(std::vector<record::Recording> &parts, uint32_t dim)
{
    std::vector<std::vector<double>> means;
    std::vector<double> common(dim);
    for (const record::Recording &part : parts) {
        means.push_back(mean_of(part, dim));
        for (uint32_t i = 0; i < dim; i++)
            common[i] += means.back()[i] / static_cast<double>(parts.size());
    }
    for (size_t p = 0; p < parts.size(); p++)
        for (size_t i = 0; i < parts[p].embeddings.size(); i++) {
            float &number = parts[p].embeddings[i];
            // NOLINTNEXTLINE(*DivideZero): embeddings have numbers
            number = static_cast<float>(number + common[i % dim] - means[p][i % dim]);
        }
}

record::Recording fused(const std::vector<const record::Recording *> &parts, uint32_t dim,
                        double tolerance, bool with_altitude)
{
    Fusion fusion(dim, tolerance, with_altitude);
    for (const record::Recording *part : parts)
        fusion.add(*part);
    return fusion.means();
}

std::vector<uint32_t> frames_at(const record::Recording &places, const record::Recording &part,
                                double tolerance, bool with_altitude)
{
    const record::Truth truth(part, map_of(places, 0), with_altitude);
    std::vector<uint32_t> frames;
    for (uint32_t place = 0; place < places.frames; place++)
        frames.push_back(frame_at(place, part, truth, tolerance));
    return frames;
}

} // namespace vdna::eval
