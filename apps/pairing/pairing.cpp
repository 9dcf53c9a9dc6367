#include "pairing/pairing.hpp"

#include <algorithm>

#include "error.hpp"

namespace vdna
{

Backbone::Backbone(const std::string &manifest, uint32_t threads, const std::string &runtime,
                   uint32_t max_pixels)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = manifest.c_str();
    config.threads = threads;
    config.max_pixels = max_pixels;
    config.runtime = runtime.empty() ? nullptr : runtime.c_str();
    vdna_error error{};
    require(vdna_backbone_open(&config, &error, &handle_), error);
    vdna_backbone_describe(handle_, &info_);
}

Backbone::~Backbone()
{
    vdna_backbone_close(handle_);
}

Map::Map(const std::string &directory) : directory_(directory)
{
    vdna_error error{};
    uint32_t count = 0;
    require(vdna_map_count(directory.c_str(), &error, &count), error);
    // One at least, so that vdna_map_open() is asked about an empty directory too.
    experiences_.resize(std::max(count, 1u));
    require(vdna_map_open(directory.c_str(), static_cast<uint32_t>(experiences_.size()), &error,
                          experiences_.data(), &count),
            error);
    experiences_.resize(count);
}

Map::~Map()
{
    for (vdna_experience &experience : experiences_)
        vdna_experience_close(&experience);
}

std::vector<vdna_select_candidate> Map::candidates() const
{
    std::vector<vdna_select_candidate> candidates(experiences_.size());
    for (size_t i = 0; i < candidates.size(); i++) {
        vdna_experience_view(&experiences_[i], &candidates[i].dna);
        candidates[i].embeddings = experiences_[i].embeddings;
        candidates[i].frames = experiences_[i].frames;
    }
    return candidates;
}

void Map::require_backbone(const vdna_backbone_info &backbone) const
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
                    backbone.identity.backbone + "`");
}

} // namespace vdna
