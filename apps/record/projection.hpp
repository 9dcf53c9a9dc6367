// Which numbers a map keeps of embeddings: their coordinates along directions that it learned.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "record/recording.hpp"

namespace vdna::record
{

struct Projection {
    std::vector<float> directions; // [dims][raw_dim]; empty = none, all numbers are kept
    uint32_t raw_dim = 0;          // numbers of an embedding as the network gives it

    // Numbers that are kept; 0 = all.
    uint32_t dims() const;
    // Make it the projection of an identity, which borrows it; without directions, nothing changes.
    void set_in(vdna_identity &identity) const;
};

Projection projection_of(const vdna_identity &identity);

// The principal directions of all frames, each part about its own mean, by falling variance; the
// largest number of each is positive. The frames' numbers are held once more in double precision,
// and take time with the cube of the frames or of raw_dim, whichever is less.
// dims: at most as many as the frames vary in. where: names what asks for them in the error. Throws
// Error.
Projection principal_directions(const std::vector<const Recording *> &parts, uint32_t raw_dim,
                                uint32_t dims, const std::string &where);

// Keep of the embeddings, as the network gave them, what experiences of this identity keep.
void project(Recording &recording, const vdna_identity &identity);
// The same, of a copy.
Recording projected(Recording recording, const Projection &projection);

} // namespace vdna::record
