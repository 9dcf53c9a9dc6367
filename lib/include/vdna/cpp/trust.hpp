/** @file vdna/cpp/trust.hpp
 *  @brief What a map knows about itself, and trust in the choice among its experiences.
 */
#ifndef VDNA_CPP_TRUST_HPP
#define VDNA_CPP_TRUST_HPP

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/map.hpp>
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
        memory_.resize(vdna_trust_mem_size(&config) / sizeof(int64_t) + 1);
        require(vdna_trust_init(&config, memory_.data(), memory_.size() * sizeof(int64_t), &trust_),
                directory + ": trust");
        for (const vdna_experience &experience : experiences)
            runs_.push_back(trust_run_of(experience));
    }

    /** The same of an open map, which must outlive runs(). */
    explicit Trust(const Map &map, vdna_trust_config config = trust_defaults())
        : Trust(map.directory(), map.experiences(), config)
    {
    }
    Trust(const Trust &) = delete;
    Trust &operator=(const Trust &) = delete;

    vdna_trust *get() { return trust_; }
    const vdna_trust_fit &fit() const { return *vdna_trust_fitted(trust_); }

    /** Why the map knows nothing about itself, and what to do; "" if it does. */
    const std::string &why_no_tables() const { return why_no_tables_; }

    /** The experiences, by which live frames are compared with them: see vdna_trust_nearest(). */
    const std::vector<vdna_trust_run> &runs() const { return runs_; }

  private:
    std::string why_no_tables_;
    std::vector<int64_t> memory_;
    vdna_trust *trust_ = nullptr; // within the memory
    std::vector<vdna_trust_run> runs_;
};

} // namespace vdna

#endif
