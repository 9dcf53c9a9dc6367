#include "selectord/map_session.hpp"

#include <cstdio>
#include <utility>

#include <vdna/cpp/error.hpp>

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

vdna_trust_config trust_config_of(const Config &config)
{
    vdna_trust_config trust = trust_defaults();
    trust.min_recall = config.min_recall;
    trust.switch_cost = config.switch_cost;
    return trust;
}

Trusting trusting_of(Trust &trust, const Config &config)
{
    Trusting trusting;
    trusting.trust = trust.get();
    trusting.runs = trust.runs().data();
    if (config.rank == "transfer")
        trusting.rank = VDNA_SELECT_BY_TRANSFER;
    trusting.stop_early = config.stop_early;
    trusting.reselect = config.reselect && config.place_filter;
    return trusting;
}

// "DIRECTORY/summer.vdna: ...": how many serve without it.
std::string left_out_text(const Map &map, const std::string &reason)
{
    const size_t serving = map.experiences().size();
    return reason + "; left out, " + std::to_string(serving) + " of " +
           std::to_string(serving + map.left_out().size()) + " experiences serve";
}

// The first reason; "" if all serve.
std::string left_out_text(const Map &map)
{
    return map.left_out().empty() ? "" : left_out_text(map, map.left_out().front());
}

OpenedMap open_once(const Config &config)
{
    MapFiles files(config.map_directory, !config.copy_map);
    return {std::make_unique<const Map>(
                config.map_directory, MapOpening{config.copy_map, config.leave_out_damaged, false}),
            std::move(files),
            {}};
}

// The path that begins a reason for which a file is left out.
std::string path_of(const std::string &reason)
{
    return reason.substr(0, reason.find(VDNA_MAP_EXTENSION ": ") + sizeof VDNA_MAP_EXTENSION - 1);
}

} // namespace

// Until nothing changes between the listing and its end: then what is watched is what was opened.
OpenedMap open_map(const Config &config)
{
    constexpr int attempts = 10;
    for (int attempt = 0; attempt < attempts; attempt++) {
        OpenedMap opened = open_once(config);
        for (const std::string &reason : opened.map->left_out())
            opened.files.forget(path_of(reason));
        if (opened.files.is_directory_changed() || !opened.files.changed_in_place().empty())
            continue;
        for (const std::string &reason : opened.map->left_out())
            std::fprintf(stderr, "vdna_selectord: %s\n",
                         left_out_text(*opened.map, reason).c_str());
        opened.localisers = localisers_in(*opened.map, config);
        return opened;
    }
    throw Error(config.map_directory + ": changed each of the " + std::to_string(attempts) +
                " times that it was opened; wait until whatever changes it has ended, then try "
                "again");
}

bool stays_in_memory(const Config &config)
{
    return config.copy_map || config.lock_memory;
}

MapSession::MapSession(const Config &config, OpenedMap opened, const vdna_backbone_info &backbone)
    : map_(std::move(opened.map)), files_(std::move(opened.files)),
      left_out_text_(vdna::selectord::left_out_text(*map_)),
      localisers_(std::move(opened.localisers)), trust_(*map_, trust_config_of(config)),
      selector_(map_->candidates(), experiences().front().identity.dim, warmup_of(config),
                config.map_directory, {static_cast<int64_t>(config.late_seconds * 1e6)},
                localising_of(localisers_, config.top), trusting_of(trust_, config),
                config.exact_distances),
      projected_(experiences().front().identity.dim), map_hash_(map_->hash()),
      ranking_(*map_, backbone, map_hash_, trust_, config.warmup_frames)
{
}

// One experience alone has nothing to find out.
void MapSession::say_no_trust() const
{
    if (experiences().size() > 1 && !trust_.why_no_tables().empty())
        std::fprintf(stderr, "vdna_selectord: no recall is predicted: %s\n",
                     trust_.why_no_tables().c_str());
}

const char *MapSession::fault()
{
    if (fault_.empty())
        if (const std::string path = files_.changed_in_place(); !path.empty())
            fault_ = path + ": changed in place while the map was in use; open it again by SIGHUP "
                            "(`systemctl reload vdna_selectord`), and replace files by renaming";
    return fault_.c_str();
}

FrameCounts MapSession::counts() const
{
    FrameCounts counts = counts_before_;
    counts.accepted += vdna_select_accepted(select());
    counts.late += vdna_select_time(select())->late;
    counts.restarts += vdna_select_restarts(select());
    counts.switches += vdna_select_switches(select());
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
    return sizeof *this + ranking_.memory_size() + selector_.memory_size() +
           projected_.size() * sizeof(float);
}

uint64_t MapSession::held_bytes(bool files_stay) const
{
    return decoded_bytes() + localisers_size() + trust_size() + size() +
           (files_stay ? file_bytes() : 0);
}

} // namespace vdna::selectord
