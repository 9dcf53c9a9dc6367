#include "selectord/map_reload.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <sys/resource.h>

#include <vdna/cpp/error.hpp>

namespace vdna::selectord
{

namespace
{

constexpr uint64_t mib = uint64_t{1} << 20;

// Opening a map reads all of it, and must not take the processors from the frames.
void give_way_to_frames()
{
    constexpr int nice = 10;
    setpriority(PRIO_PROCESS, 0, nice); // of this thread alone; refused if it is nicer already
}

} // namespace

MapReload::MapReload(const Config &config, const vdna_backbone_info &backbone,
                     std::atomic<bool> &requested, Room room)
    : config_(config), backbone_(backbone), requested_(requested), room_(room)
{
}

bool MapReload::request(int64_t utime)
{
    if (waiting_)
        return false;
    waiting_ = utime;
    return true;
}

bool MapReload::begin(const MapSession &serving)
{
    if (opening_.valid())
        return false;
    const bool by_signal = requested_.exchange(false); // one reload does for both
    if (!by_signal && !waiting_)
        return false;
    utime_ = waiting_.value_or(0);
    waiting_.reset();
    opening_ = std::async(std::launch::async,
                          [this, bytes = serving.held_bytes(stays_in_memory(config_))] {
                              give_way_to_frames();
                              return open(bytes);
                          });
    return true;
}

std::unique_ptr<MapSession> MapReload::take()
{
    constexpr std::chrono::seconds no_time(0);
    if (!opening_.valid() || opening_.wait_for(no_time) != std::future_status::ready)
        return nullptr;
    return opening_.get();
}

std::unique_ptr<MapSession> MapReload::open(uint64_t serving_bytes) const
{
    OpenedMap opened = open_map(config_);
    opened.map->require_backbone(backbone_);
    auto session = std::make_unique<MapSession>(config_, std::move(opened), backbone_);

    const uint32_t message = session->ranking().encoded_size();
    if (message > room_.message_bytes)
        throw Error(config_.map_directory + ": a ranking of " +
                    std::to_string(session->experiences().size()) + " experiences takes " +
                    std::to_string(message) + " bytes, expected at most " +
                    std::to_string(room_.message_bytes) +
                    ", twice that of the map at the start; start the daemon again");

    const uint64_t held =
        room_.held_bytes + serving_bytes + session->held_bytes(stays_in_memory(config_));
    if (config_.budget_mb > 0 && held > config_.budget_mb * mib)
        throw Error("memory.budget_mb is " + std::to_string(config_.budget_mb) + ", but " +
                    std::to_string((held + mib - 1) / mib) +
                    " MiB would be held with two maps; raise it, or start the daemon again, which "
                    "needs one map");
    return session;
}

} // namespace vdna::selectord
