// Opening the map's directory again, in the background, while the map from before serves.
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "selectord/config.hpp"
#include "selectord/map_session.hpp"

namespace vdna::selectord
{

class MapReload
{
  public:
    // What the daemon has room for besides the map that serves.
    struct Room {
        uint64_t message_bytes; // of a ranking
        uint64_t held_bytes;    // held by everything but maps, of memory.budget_mb
    };

    // Borrows all but `room`. Whoever wants a reload sets `requested`, in any thread; requests
    // during a reload become one, which follows it.
    MapReload(const Config &config, const vdna_backbone_info &backbone,
              std::atomic<bool> &requested, Room room);

    // As if `requested` were set, by a command. Returns whether one may wait: not if another does.
    bool request(int64_t utime);

    // Begin if that is requested and none is running; returns whether one began. `serving` is the
    // map from before.
    bool begin(const MapSession &serving);

    // Of the command that wanted the newest one; 0 = `requested`.
    int64_t utime() const { return utime_; }

    // What has been opened; nullptr if nothing has. Ends the reload. Throws Error if the map cannot
    // be used, or another std::exception.
    std::unique_ptr<MapSession> take();

  private:
    std::unique_ptr<MapSession> open(uint64_t serving_bytes) const;

    const Config &config_;
    const vdna_backbone_info &backbone_;
    std::atomic<bool> &requested_;
    const Room room_;
    std::optional<int64_t> waiting_; // of a command
    int64_t utime_ = 0;
    std::future<std::unique_ptr<MapSession>> opening_; // valid while a reload is running
};

} // namespace vdna::selectord
