#include "eval/localisers.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>
#include <vdna/knn.h>

#include "eval/seqslam.hpp"
#include "program/interrupt.hpp"

namespace vdna::eval
{

const std::vector<Localiser> localisers = {
    {"nn", "Nearest frame", MapKind::each, nearest},
    {"seqslam", "SeqSLAM", MapKind::each, seqslam},
    {"fused", "Nearest frame of the fused map", MapKind::fused, nearest},
    {"all", "Nearest frame of all references", MapKind::all, nearest},
};

const std::vector<std::string> usual_localisers = {"nn", "all"};

std::vector<std::string> localiser_keys()
{
    std::vector<std::string> keys;
    for (const Localiser &localiser : localisers)
        keys.push_back(localiser.key);
    return keys;
}

const Localiser &localiser_of(const std::string &key)
{
    const auto found = std::find_if(localisers.begin(), localisers.end(),
                                    [&](const Localiser &l) { return l.key == key; });
    if (found == localisers.end())
        throw Error("'" + key + "' is no localiser");
    return *found;
}

std::vector<Answer> nearest(const Drive &drive, const vdna_experience &map)
{
    std::vector<Answer> answers;
    for (const uint32_t frame : drive.live) {
        program::require_not_interrupted();
        vdna_knn_match match;
        require(vdna_knn(drive.embedding(frame), drive.dim, map.embeddings, map.frames, 1, &match),
                "nearest frame");
        answers.push_back({match.index, {}});
    }
    return answers;
}

} // namespace vdna::eval
