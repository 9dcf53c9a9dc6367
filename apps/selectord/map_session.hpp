// A map in use, with all that depends on which one it is: a reload replaces it as a whole.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <vdna/cpp/experience_localiser.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/cpp/trust.hpp>

#include "selectord/config.hpp"
#include "selectord/map_files.hpp"
#include "selectord/reports.hpp"

namespace vdna::selectord
{

// A map, the files that it was opened from, and what needs nothing but the map, so that the start
// can make it while the network opens.
struct OpenedMap {
    std::unique_ptr<const Map> map;
    MapFiles files;
    std::vector<std::unique_ptr<ExperienceLocaliser>> localisers; // one for each experience if the
                                                                  // filter is on
};

// Open the map as the settings say, and print which experiences are left out. Throws Error.
OpenedMap open_map(const Config &config);

// Whether the system cannot take back the memory of the map's files.
bool stays_in_memory(const Config &config);

class MapSession
{
  public:
    // Borrows `backbone`, which made the map. Throws Error.
    MapSession(const Config &config, OpenedMap opened, const vdna_backbone_info &backbone);
    MapSession(const MapSession &) = delete;
    MapSession &operator=(const MapSession &) = delete;

    const std::vector<vdna_experience> &experiences() const { return map_->experiences(); }
    vdna_select *select() { return selector_.get(); }
    const vdna_select *select() const { return selector_.get(); }
    RankingReport &ranking() { return ranking_; }
    const std::string &map_hash() const { return map_hash_; }

    // Experiences that could not be opened, and a sentence that names the first; "" if all could.
    size_t left_out() const { return map_->left_out().size(); }
    const std::string &left_out_text() const { return left_out_text_; }

    // Print why the map knows nothing about itself, if it should and does not.
    void say_no_trust() const;

    // Why nothing that is read from the map holds any more: a mapped file was changed in place. ""
    // if none was; asks the system each time until it is so, and then stays.
    const char *fault();
    // Whether the map's directory is no longer what was opened; asks the system.
    bool is_directory_changed() { return files_.is_directory_changed(); }

    // As Map::embedding_of(); valid until the next call.
    const float *embedding_of(const vdna_backbone_frame &seen)
    {
        return map_->embedding_of(seen, projected_);
    }

    // The network's last layer of a frame; nullptr if it is not what the map has.
    const float *last_layer_of(const vdna_backbone_frame &seen) const
    {
        return seen.last_layer_dim == experiences().front().last_layer_dim ? seen.last_layer
                                                                           : nullptr;
    }

    // Frames of this map, and of those before it.
    FrameCounts counts() const;
    // Go on counting where `before` ends.
    void count_on_from(const MapSession &before) { counts_before_ = before.counts(); }

    // Bytes of the map's files; of embeddings decoded from them; of the localisers; of what is
    // known about the choice; of the live histogram; and of everything else that is held with the
    // histogram.
    uint64_t file_bytes() const;
    uint64_t decoded_bytes() const;
    size_t localisers_size() const;
    size_t trust_size() const { return trust_.memory_size(); }
    size_t histogram_size() const;
    size_t size() const;
    // All of them that the system cannot take back: the files only if they stay in memory.
    uint64_t held_bytes(bool files_stay) const;

  private:
    const std::unique_ptr<const Map> map_;
    MapFiles files_;
    const std::string left_out_text_;
    std::string fault_;
    const std::vector<std::unique_ptr<ExperienceLocaliser>> localisers_;
    Trust trust_;
    Selector selector_;            // borrows both
    std::vector<float> projected_; // room for a live frame's embedding
    const std::string map_hash_;
    RankingReport ranking_; // borrows it
    FrameCounts counts_before_;
};

} // namespace vdna::selectord
