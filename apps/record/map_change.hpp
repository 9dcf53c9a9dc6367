// New experiences of a map, which is created if it does not exist.
#pragma once

#include <filesystem>
#include <optional>

#include <vdna/cpp/map_update.hpp>

namespace vdna::record
{

class MapChange
{
  public:
    // Creates the directory if it does not exist, and removes it again unless commit() succeeds.
    // Throws Error.
    explicit MapChange(const std::filesystem::path &map);
    ~MapChange();
    MapChange(const MapChange &) = delete;
    MapChange &operator=(const MapChange &) = delete;

    void add(const vdna_experience &experience) { update_->add(experience); } // throws Error
    void commit();                                                            // throws Error

  private:
    std::filesystem::path map_;
    bool made_;
    std::optional<MapUpdate> update_;
};

} // namespace vdna::record
