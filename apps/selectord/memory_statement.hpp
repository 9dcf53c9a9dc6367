// All the memory that the daemon will hold, stated before it runs.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/map.hpp>

#include "selectord/config.hpp"
#include "selectord/daemon.hpp"
#include "selectord/resident_memory.hpp"

namespace vdna::selectord
{

// One reason for holding memory.
struct MemoryPart {
    const char *name; // "frames"
    std::string what; // a phrase for people
    uint64_t bytes;   // at most
    bool measured;    // by what the process grew; otherwise known by rule
    bool evictable;   // the file's own pages: the system may drop them and read them again
};

// What the process held at the moments of its start.
struct StartUp {
    Resident program;  // before the map is opened
    Resident map;      // after that
    Resident backbone; // after the network is loaded and has run
};

class MemoryStatement
{
  public:
    MemoryStatement(const Config &config, const StartUp &start_up, const Map &map,
                    const Backbone &backbone, const Daemon &daemon,
                    const vdna_transport_memory &transport);

    const std::vector<MemoryPart> &parts() const { return parts_; }
    // No more than this is ever resident, the map and the loading of the network included.
    uint64_t resident_max() const;
    // Of that, what the system cannot take back when it needs memory; all of it if it is locked.
    uint64_t held_max() const;

    void print(std::ostream &out) const;
    void print_json(std::ostream &out) const;

    // Throws Error, naming the parts, if more is held than memory.budget_mb.
    void require_budget() const;
    // A sentence if the map does not fit into what is left of the memory; "" if it does.
    std::string about_large_map() const;

  private:
    uint64_t sum(bool with_evictable) const;

    const Config &config_;
    std::vector<MemoryPart> parts_;
    uint64_t loading_ = 0; // most that was resident so far
};

// Give each large block back to the system as soon as it is freed. Call before any is allocated.
void return_large_blocks();

// Keep in memory what is there and all that will be. Throws Error if it is not permitted.
void lock_memory();

} // namespace vdna::selectord
