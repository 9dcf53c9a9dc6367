// What a map knows about itself (vdna/trust.h): each of its experiences plays the live run against
// every other.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <vdna/map.h>
#include <vdna/trust.h>

namespace vdna::record
{

// Experiences of one map, borrowed.
using Members = std::vector<const vdna_experience *>;

struct TrustTables {
    std::vector<uint32_t> frames;       // [runs]
    std::vector<double> own_scale;      // [runs]
    std::vector<double> correlation;    // [runs]
    std::vector<vdna_trust_cell> cells; // [runs][runs], NaN on the diagonal; `recall` is that of
                                        // played_recall(), the same in all windows

    vdna_trust_tables view() const; // borrowed
};

// Mean EMD of the Visual DNA of `frames` frames of a run, from `first` on, to that of all of a
// candidate, in bins; NaN = not known. Windows are asked for run by run, each for all candidates
// before the next.
using WindowDistance =
    std::function<double(size_t run, uint32_t first, uint32_t frames, size_t candidate)>;

// Distances by the codes that the experiences have of the network's last layer, in place of the
// activations, which no file has. NaN unless that layer is their only tap.
WindowDistance distance_of_codes(const Members &experiences);

// Tables made before, of which rows and columns can be taken.
struct KnownTables {
    vdna_trust_tables tables{};
    std::vector<size_t> runs = {}; // index, among the experiences, of each run of the tables
};

// Throw Error if a map has too many experiences for tables of them.
void require_few_for_tables(size_t experiences);

// Make the tables, but for the cells of two known runs. Correlation times of known runs stay as
// they are, although there are more candidates now; of fewer than VDNA_TRUST_RUNS_MIN runs nothing
// is taken, as they have none.
// tolerance: metres or place numbers, finite, >= 0: as far apart are frames of one place. Positions
// in different frames do not compare, and then place numbers decide, if there are any.
// Throws Error, also after Ctrl-C.
TrustTables make_trust_tables(const Members &experiences, double tolerance,
                              const WindowDistance &distance, const KnownTables &known = {});

} // namespace vdna::record
