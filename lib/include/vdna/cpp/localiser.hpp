/** @file vdna/cpp/localiser.hpp
 *  @brief A localiser in one experience, and its memory.
 */
#ifndef VDNA_CPP_LOCALISER_HPP
#define VDNA_CPP_LOCALISER_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/localise.h>

namespace vdna
{

/** The prepared frames of an experience. */
class LocaliserMap
{
  public:
    /** Throws Error.
     *  @param embeddings  [frames][dim], needed for this call only
     *  @param where       names the experience in the error
     *  @param is_centred  whether distances are about the means */
    LocaliserMap(const float *embeddings, uint32_t frames, uint32_t dim, const std::string &where,
                 bool is_centred = true)
        : frames_(frames), dim_(dim)
    {
        vdna_localise_map_config config;
        vdna_localise_map_config_init(&config);
        config.frames = frames;
        config.dim = dim;
        config.centred = is_centred;
        config.embeddings = embeddings;
        const size_t size = vdna_localise_map_mem_size(&config);
        memory_.resize(size / sizeof(int64_t) + 1);
        const vdna_status status = vdna_localise_map_init(&config, memory_.data(), size, &map_);
        if (status != VDNA_OK)
            throw Error(where + ": cannot localise in " + std::to_string(frames) + " frames of " +
                        std::to_string(dim) + " numbers: " + vdna_status_text(status) +
                        "; rebuild the map with `vdna build`");
    }
    LocaliserMap(const LocaliserMap &) = delete;
    LocaliserMap &operator=(const LocaliserMap &) = delete;

    /** The C object, for every call that this class does not wrap. */
    const vdna_localise_map *get() const { return map_; }
    uint32_t frames() const { return frames_; }
    uint32_t dim() const { return dim_; }

    /** Bytes that the frames take. */
    size_t memory_size() const { return memory_.size() * sizeof memory_[0]; }

  private:
    std::vector<int64_t> memory_;      // int64_t for its alignment
    vdna_localise_map *map_ = nullptr; // in memory_
    uint32_t frames_, dim_;
};

/** Follows a robot in an experience. */
class Localiser
{
  public:
    /** Throws Error.
     *  @param map     borrowed as long as the localiser is in use
     *  @param config  its map is set here; fill the rest after vdna_localise_config_init()
     *  @param where   names the experience in the error */
    Localiser(const LocaliserMap &map, vdna_localise_config config, const std::string &where)
    {
        config.map = map.get();
        const size_t size = vdna_localise_mem_size(&config);
        memory_.resize(size / sizeof(int64_t) + 1);
        const vdna_status status = vdna_localise_init(&config, memory_.data(), size, &localise_);
        if (status != VDNA_OK)
            throw Error(where + ": cannot localise with these settings: " +
                        vdna_status_text(status) + "; vdna/localise.h has their ranges");
    }
    Localiser(const Localiser &) = delete;
    Localiser &operator=(const Localiser &) = delete;

    /** The C object, for every call that this class does not wrap. */
    vdna_localise *get() { return localise_; }
    const vdna_localise *get() const { return localise_; }

    /** Bytes that the localiser takes. */
    size_t memory_size() const { return memory_.size() * sizeof memory_[0]; }

  private:
    std::vector<int64_t> memory_;       // int64_t for its alignment
    vdna_localise *localise_ = nullptr; // in memory_
};

} // namespace vdna

#endif
