#include "eval/localisers.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>
#include <vdna/knn.h>

#include "eval/filter.hpp"
#include "eval/seqslam.hpp"
#include "program/interrupt.hpp"

namespace vdna::eval
{

const std::vector<Localiser> localisers = {
    {"nn", "Nearest frame", MapKind::each, 0, nearest},
    {"centred", "Nearest frame about the means", MapKind::each, 0, centred},
    {"filter", "Place filter", MapKind::each, 0, filter},
    {"filter_top2", "Place filter in the 2 best references", MapKind::top, 2, filter},
    {"filter_top3", "Place filter in the 3 best references", MapKind::top, 3, filter},
    {"filter_all", "Place filter in all references", MapKind::top, 0, filter},
    {"seqslam", "SeqSLAM", MapKind::each, 0, seqslam},
    {"fused", "Nearest frame of the fused map", MapKind::fused, 0, nearest},
    {"fused_centred", "Nearest frame about the means of the fused map", MapKind::fused_centred, 0,
     centred},
    {"fused_filter", "Place filter in the fused map", MapKind::fused_centred, 0, filter},
    {"bayesian", "Place most likely by all references", MapKind::likelihood, 0, nullptr},
    {"all", "Nearest frame of all references", MapKind::all, 0, nearest},
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

std::vector<Answer> most_confident(const std::vector<std::vector<Answer>> &answers,
                                   const std::vector<uint32_t> &frames)
{
    std::vector<Answer> best = answers.front();
    uint32_t before = 0;
    for (size_t k = 1; k < answers.size(); k++) {
        before += frames[k - 1];
        for (size_t i = 0; i < best.size(); i++)
            if (answers[k][i].confidence > best[i].confidence)
                best[i] = {before + answers[k][i].frame, answers[k][i].confidence};
    }
    return best;
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
