/** @file vdna/cpp/trust.hpp
 *  @brief What a map knows about itself, and trust in the choice among its experiences.
 */
#ifndef VDNA_CPP_TRUST_HPP
#define VDNA_CPP_TRUST_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/knn.h>
#include <vdna/map_trust.h>
#include <vdna/trust.h>

namespace vdna
{

/** The file of what a map knows about itself, if it is there and good; it closes itself. */
class MapTrust
{
  public:
    /** Never throws: see why_not().
     *  @param experiences  [count], open ones of this map; needed for this call only */
    MapTrust(const std::string &directory, const vdna_experience *experiences, size_t count)
    {
        vdna_error error{};
        // What is no uint32_t is too many for the file, too.
        const auto runs = static_cast<uint32_t>(std::min<size_t>(count, UINT32_MAX));
        if (vdna_map_trust_open(directory.c_str(), experiences, runs, &error, &trust_) != VDNA_OK)
            why_not_ = error.text;
    }
    /** The same of those experiences that the file knows as they are now.
     *  @param out_known  [experiences], whether it knows each; all 0 if it is not open */
    MapTrust(const std::string &directory, const std::vector<vdna_experience> &experiences,
             std::vector<uint8_t> &out_known)
    {
        vdna_error error{};
        const auto runs = static_cast<uint32_t>(std::min<size_t>(experiences.size(), UINT32_MAX));
        out_known.assign(experiences.size(), 0);
        if (vdna_map_trust_open_known(directory.c_str(), experiences.data(), runs, &error,
                                      out_known.data(), &trust_) == VDNA_OK)
            return;
        why_not_ = error.text;
        out_known.assign(experiences.size(), 0);
    }
    ~MapTrust() { vdna_map_trust_close(&trust_); }
    MapTrust(const MapTrust &) = delete;
    MapTrust &operator=(const MapTrust &) = delete;

    /** Whether it is open. */
    explicit operator bool() const { return why_not_.empty(); }

    /** The reason why it is not, and what to do; "" if it is. */
    const std::string &why_not() const { return why_not_; }

    /** Of the experiences, in their order; zero if it is not open. */
    const vdna_map_trust *operator->() const { return &trust_; }

  private:
    vdna_map_trust trust_{};
    std::string why_not_;
};

/** Whose recall the tables of an experience's map have: VDNA_TRUST_CENTRED or _EUCLIDEAN. */
inline uint32_t trust_localiser_of(const vdna_experience &experience)
{
    return vdna_identity_is_centred(&experience.identity) != 0 ? VDNA_TRUST_CENTRED
                                                               : VDNA_TRUST_EUCLIDEAN;
}

/** An experience as a run: its frames, and its places but not its positions, which would have to be
 *  put on the ground first. Borrowed from the experience. */
inline vdna_trust_run trust_run_of(const vdna_experience &experience)
{
    vdna_trust_run run{};
    run.embeddings = experience.embeddings;
    run.last_layer = experience.last_layer;
    run.last_layer_scale = experience.last_layer_scale;
    run.place = experience.frame_place;
    run.frames = experience.frames;
    run.dim = experience.identity.dim;
    run.last_layer_dim = experience.last_layer_dim;
    return run;
}

/** The defaults of vdna_trust_config_init(). */
inline vdna_trust_config trust_defaults()
{
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    return config;
}

/** The word that ranking_t has for a verdict, VDNA_TRUST_UNLIKE and others; "" if it fits. */
inline const char *name_of_verdict(uint32_t verdict)
{
    switch (verdict) {
    case VDNA_TRUST_UNLIKE:
        return "unlike";
    case VDNA_TRUST_POOR:
        return "poor";
    case VDNA_TRUST_BLANK:
        return "blank";
    default:
        return "";
    }
}

/** Whether the looks of the live run are those of no candidate, so that nothing is predicted. */
inline bool looks_like_none(uint32_t verdict)
{
    return verdict == VDNA_TRUST_UNLIKE || verdict == VDNA_TRUST_BLANK;
}

/** A vdna_trust and its memory. */
class TrustBlock
{
  public:
    /** Throws Error for a setting beyond its range, or too many runs.
     *  @param config  needed for this call only
     *  @param where   for the error */
    TrustBlock(const vdna_trust_config &config, const std::string &where)
        : memory_(vdna_trust_mem_size(&config) / sizeof(int64_t) + 1)
    {
        require(vdna_trust_init(&config, memory_.data(), memory_.size() * sizeof(int64_t), &trust_),
                where);
    }
    TrustBlock(const TrustBlock &) = delete;
    TrustBlock &operator=(const TrustBlock &) = delete;

    vdna_trust *get() { return trust_; }
    const vdna_trust_fit &fit() const { return *vdna_trust_fitted(trust_); }
    /** Bytes that it holds. */
    size_t memory_size() const { return memory_.size() * sizeof memory_[0]; }

  private:
    std::vector<int64_t> memory_; // int64_t for its alignment
    vdna_trust *trust_ = nullptr; // within the memory
};

/** Trust in the choice among the experiences of a map, and its memory. Without the map's own file,
 *  it predicts nothing and says why; everything else works. */
class Trust
{
  public:
    /** Throws Error for a setting beyond its range, or too many experiences.
     *  @param experiences  of the map that `directory` has; borrowed for runs()
     *  @param config  its runs, tables and localiser are set here */
    Trust(const std::string &directory, const std::vector<vdna_experience> &experiences,
          vdna_trust_config config = trust_defaults())
    {
        const MapTrust known(directory, experiences.data(), experiences.size());
        why_no_tables_ = known.why_not();
        config.runs = static_cast<uint32_t>(experiences.size());
        config.tables = known ? &known->tables : nullptr;
        config.localiser = known ? known->localiser : trust_localiser_of(experiences.front());
        block_.emplace(config, directory + ": trust");
        for (const vdna_experience &experience : experiences) {
            runs_.push_back(trust_run_of(experience));
            encode(runs_.back());
        }
        why_no_predictions_ = known ? why_not_by(known->tables) : why_no_tables_;
    }

    /** The same of an open map, which must outlive runs(). */
    explicit Trust(const Map &map, const vdna_trust_config &config = trust_defaults())
        : Trust(map.directory(), map.experiences(), config)
    {
    }
    Trust(const Trust &) = delete;
    Trust &operator=(const Trust &) = delete;

    vdna_trust *get() { return block_->get(); }
    const vdna_trust_fit &fit() const { return block_->fit(); }

    /** `skill` of the fit; NaN of fewer than VDNA_TRUST_SKILL_RUNS_MIN labelled runs, by which it
     *  is not to be judged. */
    double skill() const
    {
        return fit().labelled < VDNA_TRUST_SKILL_RUNS_MIN ? std::nan("") : fit().skill;
    }

    /** Why the map knows nothing about itself, and what to do; "" if it does. */
    const std::string &why_no_tables() const { return why_no_tables_; }

    /** Why nothing is predicted for any run, and what to do; "" if something is. */
    const std::string &why_no_predictions() const { return why_no_predictions_; }

    /** Why a candidate has no prediction, to follow "no prediction: ".
     *  @param reason  of vdna_trust_prediction
     *  @return borrowed; "" for VDNA_TRUST_REASON_NONE */
    const char *text_of(uint32_t reason) const
    {
        const bool is_of_map =
            reason == VDNA_TRUST_REASON_NO_TABLES || reason == VDNA_TRUST_REASON_FEW_RUNS;
        return is_of_map ? why_no_predictions_.c_str() : vdna_trust_reason_text(reason);
    }

    /** Bytes that it holds, but for the reasons. */
    size_t memory_size() const
    {
        size_t size = block_->memory_size() + runs_.size() * sizeof runs_[0];
        for (const std::vector<double> &codes : codes_)
            size += codes.size() * sizeof(double);
        return size;
    }

    /** The experiences, by which live frames are compared with them: see vdna_trust_nearest(). */
    const std::vector<vdna_trust_run> &runs() const { return runs_; }

  private:
    // Give a run codes. One that can have none is searched without.
    void encode(vdna_trust_run &run)
    {
        const size_t size = vdna_knn_codes_size(run.dim, run.frames);
        std::vector<double> codes((size + sizeof(double) - 1) / sizeof(double));
        if (vdna_knn_encode(run.embeddings, run.dim, run.frames, codes.data(), size) != VDNA_OK)
            return;
        run.codes = codes.data();
        codes_.push_back(std::move(codes));
    }

    static bool has_distances(const vdna_trust_tables &tables, size_t runs)
    {
        for (size_t i = 0; i < runs * runs; i++)
            if (i % (runs + 1) != 0 && std::isnan(tables.cells[i].distance[0]))
                return false;
        return true;
    }

    std::string why_not_by(const vdna_trust_tables &tables) const
    {
        const size_t runs = runs_.size(), labelled = fit().labelled;
        const std::string needed =
            std::to_string(VDNA_TRUST_RUNS_MIN) + " labelled experiences are needed, ";
        if (runs < VDNA_TRUST_RUNS_MIN)
            return needed + "the map has " + std::to_string(runs) +
                   (runs == 1 ? " experience" : " experiences") + "; record more";
        if (!has_distances(tables, runs))
            return "no file keeps the activations that it needs, and the network's last layer, "
                   "which may stand for them, is not its only tap";
        if (labelled < VDNA_TRUST_RUNS_MIN)
            return needed + std::to_string(labelled) + " of " + std::to_string(runs) +
                   " are; build them with places or positions of one frame";
        return "";
    }

    std::string why_no_tables_, why_no_predictions_;
    std::optional<TrustBlock> block_; // there once it is constructed
    std::vector<vdna_trust_run> runs_;
    std::vector<std::vector<double>> codes_; // of the runs, aligned as they are to be
};

} // namespace vdna

#endif
