#include "selectord/map_session.hpp"

#include <cstdio>
#include <utility>

namespace vdna::selectord
{

namespace
{

Warmup warmup_of(const Config &config)
{
    return {config.warmup_frames, static_cast<int64_t>(config.warmup_seconds * 1e6),
            config.warmup_frames_min};
}

std::vector<std::unique_ptr<ExperienceLocaliser>> localisers_in(const Map &map,
                                                                const Config &config)
{
    std::vector<std::unique_ptr<ExperienceLocaliser>> localisers;
    if (config.place_filter)
        for (const vdna_experience &experience : map.experiences())
            localisers.push_back(
                std::make_unique<ExperienceLocaliser>(experience, config.tolerance));
    return localisers;
}

Localising localising_of(const std::vector<std::unique_ptr<ExperienceLocaliser>> &localisers,
                         uint32_t top)
{
    Localising localising;
    for (const std::unique_ptr<ExperienceLocaliser> &localiser : localisers)
        localising.by.push_back(localiser->get());
    localising.top = top;
    return localising;
}

} // namespace

std::unique_ptr<const Map> open_map(const Config &config)
{
    auto map = std::make_unique<const Map>(config.map_directory,
                                           MapOpening{config.copy_map, config.leave_out_damaged});
    for (const std::string &reason : map->left_out())
        std::fprintf(stderr, "vdna_selectord: %s; left out, %zu of %zu experiences serve\n",
                     reason.c_str(), map->experiences().size(),
                     map->experiences().size() + map->left_out().size());
    return map;
}

bool stays_in_memory(const Config &config)
{
    return config.copy_map || config.lock_memory;
}

MapSession::MapSession(const Config &config, std::unique_ptr<const Map> map,
                       const vdna_backbone_info &backbone)
    : map_(std::move(map)), localisers_(localisers_in(*map_, config)),
      selector_(map_->candidates(), experiences().front().identity.dim, warmup_of(config),
                config.map_directory, {static_cast<int64_t>(config.late_seconds * 1e6)},
                localising_of(localisers_, config.top)),
      projected_(experiences().front().identity.dim), map_hash_(map_->hash()),
      ranking_(*map_, backbone, map_hash_)
{
}

FrameCounts MapSession::counts() const
{
    FrameCounts counts = counts_before_;
    counts.accepted += vdna_select_accepted(select());
    counts.late += vdna_select_time(select())->late;
    counts.restarts += vdna_select_restarts(select());
    return counts;
}

uint64_t MapSession::file_bytes() const
{
    uint64_t bytes = 0;
    for (const vdna_experience &experience : experiences())
        bytes += experience.file_size;
    return bytes;
}

uint64_t MapSession::decoded_bytes() const
{
    uint64_t bytes = 0;
    for (const vdna_experience &experience : experiences())
        if (experience.embedding_codes)
            bytes += uint64_t{experience.frames} * experience.identity.dim * sizeof(float);
    return bytes;
}

size_t MapSession::localisers_size() const
{
    size_t size = 0;
    for (const std::unique_ptr<ExperienceLocaliser> &localiser : localisers_)
        size += sizeof *localiser + localiser->memory_size();
    return size;
}

size_t MapSession::histogram_size() const
{
    vdna_hist_view live;
    vdna_select_live(select(), &live);
    const size_t numbers_per_neuron = live.bins + 2; // counts, mass, saturated
    return numbers_per_neuron * live.neurons * sizeof(uint32_t);
}

size_t MapSession::size() const
{
    const size_t per_experience = sizeof(char *) + 2 * sizeof(double) + sizeof(int8_t);
    return sizeof *this + selector_.memory_size() + projected_.size() * sizeof(float) +
           experiences().size() * per_experience;
}

uint64_t MapSession::held_bytes(bool files_stay) const
{
    return decoded_bytes() + localisers_size() + size() + (files_stay ? file_bytes() : 0);
}

} // namespace vdna::selectord
