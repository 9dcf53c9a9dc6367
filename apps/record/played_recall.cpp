#include "record/played_recall.hpp"

#include <algorithm>

#include "record/localisation.hpp"

namespace vdna::record
{

namespace
{

constexpr uint32_t longest_warmup = 100;

// What localising needs of the frames [begin, end).
Recording part_of(const vdna_experience &run, uint32_t begin, uint32_t end)
{
    const size_t dim = run.identity.dim;
    Recording part;
    part.frames = end - begin;
    part.position_frame = run.position_frame;
    part.embeddings.assign(run.embeddings + dim * begin, run.embeddings + dim * end);
    if (run.frame_place)
        part.place.assign(run.frame_place + begin, run.frame_place + end);
    if (run.frame_position)
        part.position.assign(run.frame_position + size_t{3} * begin,
                             run.frame_position + size_t{3} * end);
    return part;
}

} // namespace

double played_recall(const vdna_experience &run, const vdna_experience &candidate, double tolerance)
{
    const uint32_t warmup = std::min(longest_warmup, 2 * run.frames / 5);
    return follow_in(candidate, part_of(run, 0, warmup), part_of(run, warmup, run.frames),
                     tolerance)
               .nearest.recall_percent() /
           100;
}

} // namespace vdna::record
