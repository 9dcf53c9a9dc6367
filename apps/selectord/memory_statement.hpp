// All the memory that the daemon will hold, stated before it runs.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <vdna/cpp/backbone.hpp>

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
    bool measured;    // by the growth of the process; otherwise computed
    bool evictable;   // pages of a file, which the system may drop and reread
};

// Memory of the daemon at each step of its start.
struct StartUp {
    Resident program;  // before the map is opened
    Resident map;      // after that
    Resident backbone; // after the network is loaded and has run
    // The process of the network, if it has one of its own, at that moment.
    Resident process;
    uint64_t mailbox = 0; // bytes that both processes share
};

class MemoryStatement
{
  public:
    MemoryStatement(const Config &config, const StartUp &start_up, const Backbone &backbone,
                    const Daemon &daemon, const vdna_transport_memory &transport);

    const std::vector<MemoryPart> &parts() const { return parts_; }
    // Upper bound of resident memory but in a reload, including the map and loading the network. Of
    // two processes, the sum: code that they share counts twice.
    uint64_t resident_max() const;
    // The part that the system cannot take back; all of it if locked.
    uint64_t held_max() const;

    // held_max() but the map, and what the loop holds because of it.
    uint64_t held_beside_map() const;

    void print(std::ostream &out) const;
    void print_json(std::ostream &out) const;

    // Throws Error, naming the parts, if held_max() exceeds memory.budget_mb.
    void require_budget() const;
    // A warning if the map does not fit into the remaining memory; "" if it does.
    std::string about_large_map() const;

  private:
    uint64_t sum(bool with_evictable) const;

    const Config &config_;
    std::vector<MemoryPart> parts_;
    uint64_t map_held_;    // a map's part of it; another as much during a reload
    uint64_t loading_ = 0; // largest resident size so far
};

// Return large blocks to the system as soon as they are freed. Call before allocating any.
void return_large_blocks();

// Lock all present and future memory. Throws Error if this is not permitted.
void lock_memory();

} // namespace vdna::selectord
