/** @file vdna/cpp/map.hpp
 *  @brief The open experiences of a map directory; they close themselves.
 */
#ifndef VDNA_CPP_MAP_HPP
#define VDNA_CPP_MAP_HPP

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/cpp/error.hpp>
#include <vdna/map.h>
#include <vdna/select.h>

namespace vdna
{

/** How to open a map; vdna_map_config says what that means. */
struct MapOpening {
    bool copy = false;      /**< hold copies of the files, which are mapped otherwise */
    bool leave_out = false; /**< leave out damaged experiences; otherwise they refuse the map */
    bool thumbnails = true; /**< keep the frames' thumbnails; otherwise no memory holds them */
};

/** An experience as the selector wants it; borrowed from the experience. */
inline vdna_select_candidate candidate_of(const vdna_experience &experience)
{
    vdna_select_candidate candidate{};
    vdna_experience_view(&experience, &candidate.dna);
    candidate.embeddings = experience.embeddings;
    candidate.frames = experience.frames;
    return candidate;
}

class Map
{
  public:
    /** Open all experiences; throws Error, also if two of them do not compare. */
    explicit Map(const std::string &directory, MapOpening how = {}) : directory_(directory)
    {
        vdna_error error{};
        uint32_t count = 0;
        require(vdna_map_count(directory.c_str(), &error, &count), error);
        // At least one, so that vdna_map_open_as() reports an empty directory.
        experiences_.resize(std::max(count, 1u));
        const vdna_map_config config = config_of(how);
        require(vdna_map_open_as(&config, directory.c_str(),
                                 static_cast<uint32_t>(experiences_.size()), &error,
                                 experiences_.data(), &count),
                error);
        experiences_.resize(count);
    }
    ~Map()
    {
        for (vdna_experience &experience : experiences_)
            vdna_experience_close(&experience);
    }
    Map(const Map &) = delete;
    Map &operator=(const Map &) = delete;

    /** At least one. */
    const std::vector<vdna_experience> &experiences() const { return experiences_; }

    /** As it was given. */
    const std::string &directory() const { return directory_; }

    /** Why each experience that was left out was. */
    const std::vector<std::string> &left_out() const { return left_out_; }

    /** 16 hexadecimal digits over the names and the content of the files: equal for the same map.
     */
    std::string hash() const
    {
        uint64_t hash = 14695981039346656037u; // FNV-1a
        const auto take = [&](const void *bytes, size_t size) {
            for (size_t i = 0; i < size; i++)
                hash = (hash ^ static_cast<const unsigned char *>(bytes)[i]) * 1099511628211u;
        };
        for (const vdna_experience &experience : experiences_) {
            take(experience.name, sizeof experience.name);
            take(&experience.checksum, sizeof experience.checksum);
        }
        char text[17];
        std::snprintf(text, sizeof text, "%016" PRIx64, hash);
        return text;
    }

    /** The experiences as the selector wants them; borrowed from this map. */
    std::vector<vdna_select_candidate> candidates() const
    {
        std::vector<vdna_select_candidate> candidates;
        for (const vdna_experience &experience : experiences_)
            candidates.push_back(candidate_of(experience));
        return candidates;
    }

    /** What the map keeps of a live frame's embedding, for localisers and selectors in it: see
     *  vdna_identity_project().
     *  @param frame  of a backbone that require_backbone() accepts
     *  @param room   grows once; holds the result if the map has a projection
     *  @return [dim of the map], borrowed from `frame` or `room` */
    const float *embedding_of(const vdna_backbone_frame &frame, std::vector<float> &room) const
    {
        const vdna_identity &identity = experiences_.front().identity;
        if (!identity.projection)
            return frame.embedding;
        room.resize(identity.dim);
        vdna_identity_project(&identity, frame.embedding, room.data());
        return room.data();
    }

    /** Throw Error, naming the field and the remedy, unless `backbone` made this map. */
    void require_backbone(const vdna_backbone_info &backbone) const
    {
        // All experiences of a map compare, so the first one speaks for them.
        const vdna_identity &map = experiences_.front().identity;
        vdna_error why{};
        if (vdna_identity_compare(&map, &backbone.identity, &why) != VDNA_OK)
            throw Error(directory_ + ": the map (made with backbone " + map.backbone +
                        ") does not compare with backbone " + backbone.identity.backbone + ": " +
                        why.text +
                        "; use the map's backbone, or rebuild the map with `vdna build --force "
                        "--backbone " +
                        backbone.identity.backbone + "`" + as_it_was_made(map, backbone.identity));
    }

  private:
    vdna_map_config config_of(MapOpening how)
    {
        vdna_map_config config;
        vdna_map_config_init(&config);
        config.copy = how.copy ? 1 : 0;
        config.no_thumbnails = how.thumbnails ? 0 : 1;
        if (how.leave_out)
            config.left_out = [](void *reasons, const char *reason) {
                static_cast<std::vector<std::string> *>(reasons)->emplace_back(reason);
            };
        config.context = &left_out_;
        return config;
    }

    // A map of one layer for both is all that a manifest of the paper's protocol gives.
    static const char *as_it_was_made(const vdna_identity &map, const vdna_identity &backbone)
    {
        return map.embedding[0] == '\0' && backbone.embedding[0] != '\0'
                   ? ", or localise in it as it was made: protocol = \"paper\" in the backbone's "
                     "manifest"
                   : "";
    }

    std::string directory_;
    std::vector<vdna_experience> experiences_;
    std::vector<std::string> left_out_;
};

} // namespace vdna

#endif
