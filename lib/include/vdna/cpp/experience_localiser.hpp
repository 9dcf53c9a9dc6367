/** @file vdna/cpp/experience_localiser.hpp
 *  @brief The places of an experience, and a localiser in it that is set up by them.
 */
#ifndef VDNA_CPP_EXPERIENCE_LOCALISER_HPP
#define VDNA_CPP_EXPERIENCE_LOCALISER_HPP

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/cpp/localiser.hpp>
#include <vdna/experience_localise.h>

namespace vdna
{

/** Which frames of an experience show the same place; vdna/experience_localise.h defines them. */
struct Places {
    std::vector<int64_t>
        number;         /**< [frames], VDNA_PLACE_NONE = a place of its own; empty = every
                             frame's number is its index, for which localising is cheaper */
    uint32_t tolerance; /**< greatest difference of two numbers of the same place */
};

/** Choose the places of an experience. Throws Error.
 *  @param experience  its embeddings do not matter
 *  @param tolerance   within which a match is good, >= 0: metres with positions, else place
 *                     numbers */
inline Places places_of(const vdna_experience &experience, double tolerance)
{
    Places places{std::vector<int64_t>(experience.frames), 0};
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    require(vdna_experience_localise_config(&experience, tolerance, places.number.data(), &config),
            experience.name);
    places.tolerance = config.tolerance;
    if (!config.place)
        places.number.clear();
    return places;
}

/** Follows a robot in an experience, by places that fit it. */
class ExperienceLocaliser
{
  public:
    /** Distances are about the means if the experience's embeddings are made for that. Throws
     *  Error.
     *  @param experience  needed for this call only
     *  @param tolerance   as for places_of() */
    ExperienceLocaliser(const vdna_experience &experience, double tolerance)
        : ExperienceLocaliser(experience, tolerance, std::vector<int64_t>(experience.frames))
    {
    }

    /** The C object, for every call that this class does not wrap. */
    vdna_localise *get() { return localiser_.get(); }
    const vdna_localise *get() const { return localiser_.get(); }

    /** Take the frames of a warmup: the last VDNA_LOCALISE_LEAD_FRAMES lead the filter, those
     * before them count for the mean only. Throws Error.
     *  @param embedding_of  gives the embedding of frame 0 .. frames - 1, in this order
     *  @param where         names the experience in the error */
    template <typename EmbeddingOf>
    void warm_up(uint32_t frames, EmbeddingOf embedding_of, const std::string &where)
    {
        vdna_localise_answer unused;
        for (uint32_t i = 0; i < frames; i++)
            require(frames - i > VDNA_LOCALISE_LEAD_FRAMES
                        ? vdna_localise_warm_up(get(), embedding_of(i))
                        : vdna_localise_feed(get(), embedding_of(i), &unused),
                    where);
    }

    /** Bytes that the frames and the localiser take. */
    size_t memory_size() const { return map_.memory_size() + localiser_.memory_size(); }

  private:
    ExperienceLocaliser(const vdna_experience &experience, double tolerance,
                        std::vector<int64_t> &&place)
        : map_(experience.embeddings, experience.frames, experience.identity.dim, experience.name,
               vdna_identity_is_centred(&experience.identity) != 0),
          localiser_(map_, config_of(experience, tolerance, place), experience.name)
    {
    }

    // Borrows `place`.
    static vdna_localise_config config_of(const vdna_experience &experience, double tolerance,
                                          std::vector<int64_t> &place)
    {
        vdna_localise_config config;
        vdna_localise_config_init(&config);
        require(vdna_experience_localise_config(&experience, tolerance, place.data(), &config),
                experience.name);
        return config;
    }

    LocaliserMap map_;
    Localiser localiser_;
};

} // namespace vdna

#endif
