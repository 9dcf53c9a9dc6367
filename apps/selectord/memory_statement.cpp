#include "selectord/memory_statement.hpp"

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <ostream>
#include <utility>

#include <malloc.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "selectord/glance.hpp"

namespace vdna::selectord
{

namespace
{

constexpr uint64_t mib = uint64_t{1} << 20;

// Memory that cannot be itemised beforehand: code not run yet, stacks of threads, and rounding by
// the allocator.
constexpr uint64_t margin = 16 * mib;

std::string mib_text(uint64_t bytes)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / mib);
    return text;
}

// The system may drop pages of the map while the network loads, so take at least the heap's growth.
uint64_t growth(const Resident &before, const Resident &after)
{
    return static_cast<uint64_t>(
        std::max({after.now - before.now, after.anonymous - before.anonymous, int64_t{0}}));
}

// One sum per name, in order of first appearance.
std::vector<std::pair<std::string, uint64_t>> held_by_name(const std::vector<MemoryPart> &parts)
{
    std::vector<std::pair<std::string, uint64_t>> sums;
    for (const MemoryPart &part : parts) {
        if (part.evictable)
            continue;
        if (sums.empty() || sums.back().first != part.name)
            sums.emplace_back(part.name, 0);
        sums.back().second += part.bytes;
    }
    return sums;
}

} // namespace

MemoryStatement::MemoryStatement(const Config &config, const StartUp &start_up,
                                 const Backbone &backbone, const Daemon &daemon,
                                 const vdna_transport_memory &transport)
    : config_(config), map_held_(daemon.session().held_bytes(stays_in_memory(config))),
      loading_(static_cast<uint64_t>(start_up.backbone.most + start_up.process.most))
{
    const MapSession &map = daemon.session();
    const std::string experiences = std::to_string(map.experiences().size());
    const std::string pixels = std::to_string(config.max_image_pixels);
    const size_t histogram = map.histogram_size();
    const uint64_t picture = config.max_image_bytes;
    const bool pinned = config.lock_memory;
    const std::string backbone_name = backbone.info().identity.backbone;
    parts_ = {
        {"program", "code, libraries and heap before the map is opened",
         static_cast<uint64_t>(start_up.program.now), true, false},
        {"map",
         experiences + (config.copy_map ? " experience files, copied (map.copy)"
                                        : " experience files, mapped and shared"),
         map.file_bytes(), false, !pinned && !config.copy_map},
        {"map", "embeddings decoded from 8-bit codes", map.decoded_bytes(), false, false},
        {"backbone", backbone_name + ": runtime, network and arena",
         growth(start_up.map, start_up.backbone) + static_cast<uint64_t>(start_up.process.now),
         true, false},
        {"backbone", "picture and numbers on their way between two processes", start_up.mailbox,
         false, false},
        {"localise", "frames of the map as directions, place filters", map.localisers_size(), false,
         false},
        {"trust", "what is known about the choice among " + experiences, map.trust_size(), false,
         false},
        {"core", "live histogram", histogram, false, false},
        {"core", "selector, ranking and stage times", daemon.size() - histogram, false, false},
        {"frames", "newest picture (lcm.max_image_bytes)", picture, false, false},
        {"frames", "decoding one of " + pixels + " pixels (lcm.max_image_pixels)",
         backbone.info().decode_bytes, false, false},
        {"frames", "looking whether one shows anything new (camera.parked)",
         config.parked > 0 ? Glance::bytes_max(config.max_image_pixels) : 0, false, false},
        {"lcm", "message to publish", transport.own_bytes - picture, false, false},
        {"lcm", "queued and half received messages, inside LCM", transport.lcm_bytes, false, false},
        {"margin", "code not run yet, stacks, rounding", margin, false, false},
    };
}

uint64_t MemoryStatement::sum(bool with_evictable) const
{
    uint64_t total = 0;
    for (const MemoryPart &part : parts_)
        if (with_evictable || !part.evictable)
            total += part.bytes;
    return total;
}

uint64_t MemoryStatement::resident_max() const
{
    return std::max(sum(true), loading_);
}

uint64_t MemoryStatement::held_max() const
{
    const uint64_t evictable = sum(true) - sum(false);
    return std::max(sum(false), loading_ - std::min(loading_, evictable));
}

uint64_t MemoryStatement::held_beside_map() const
{
    return sum(false) - map_held_;
}

void MemoryStatement::print(std::ostream &out) const
{
    const auto line = [&](const char *name, uint64_t bytes, const std::string &what) {
        char text[256];
        std::snprintf(text, sizeof text, "%-9s %14" PRIu64 " %10s  %s\n", name, bytes,
                      mib_text(bytes).c_str(), what.c_str());
        out << text;
    };
    out << "part               bytes             what\n";
    for (const MemoryPart &part : parts_)
        line(part.name, part.bytes,
             part.what + (part.measured ? " (measured)" : "") +
                 (part.evictable ? " (evictable)" : ""));
    line("most", resident_max(),
         "resident at any time but in a reload; " + mib_text(loading_) + " so far");
    line("held", held_max(),
         config_.lock_memory ? "of that, all locked (memory.lock)"
                             : "of that, not evictable: what memory.budget_mb limits");
    line("reload", map_held_,
         "held besides while SIGHUP opens such a map again; refused beyond the budget");
    if (config_.budget_mb > 0)
        line("budget", config_.budget_mb * mib, "memory.budget_mb");
}

void MemoryStatement::print_json(std::ostream &out) const
{
    nlohmann::ordered_json parts = nlohmann::ordered_json::array();
    for (const MemoryPart &part : parts_)
        parts.push_back({{"part", part.name},
                         {"what", part.what},
                         {"bytes", part.bytes},
                         {"measured", part.measured},
                         {"evictable", part.evictable}});
    const nlohmann::ordered_json json{{"parts", parts},
                                      {"resident_bytes_max", resident_max()},
                                      {"held_bytes_max", held_max()},
                                      {"reload_bytes", map_held_},
                                      {"resident_bytes_so_far", loading_},
                                      {"budget_bytes", config_.budget_mb * mib}};
    out << json.dump(2) << '\n';
}

void MemoryStatement::require_budget() const
{
    if (config_.budget_mb == 0 || held_max() <= config_.budget_mb * mib)
        return;
    std::string list;
    for (const auto &[name, bytes] : held_by_name(parts_))
        list += (list.empty() ? "" : ", ") + name + " " + mib_text(bytes);
    throw Error("memory.budget_mb is " + std::to_string(config_.budget_mb) + ", but " +
                mib_text(held_max()) + " may be held: " + list +
                "; raise it, or lower lcm.max_image_bytes or lcm.max_image_pixels, or use a "
                "smaller backbone" +
                (config_.copy_map ? ", or set map.copy = false" : "") + "; see --print-memory");
}

std::string MemoryStatement::about_large_map() const
{
    const uint64_t machine = static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                             static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    const uint64_t memory =
        config_.budget_mb > 0 ? std::min(machine, config_.budget_mb * mib) : machine;
    const uint64_t map = sum(true) - sum(false);
    const uint64_t left = memory - std::min(memory, held_max());
    if (map <= left)
        return "";
    return "the map is " + mib_text(map) + ", of which " + mib_text(left) + " fit into " +
           mib_text(memory) + " of memory; the rest is read from the disk when it is needed";
}

void return_large_blocks()
{
#ifdef M_MMAP_THRESHOLD
    // Fix glibc's initial threshold. Otherwise it grows up to 32 MiB when large blocks are freed,
    // and glibc keeps the memory that loading a network frees: up to 200 MiB, varying from run to
    // run.
    mallopt(M_MMAP_THRESHOLD, 128 << 10);
#endif
}

void lock_memory()
{
    // Lock only touched pages: whole stacks and buffers would multiply the memory held.
    if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
        throw Error(std::string("memory.lock is true, but the memory cannot be locked: ") +
                    std::strerror(errno) +
                    "; allow it by LimitMEMLOCK=infinity in the systemd unit, by `ulimit -l "
                    "unlimited` or by CAP_IPC_LOCK, or remove memory.lock");
}

} // namespace vdna::selectord
