#include "record/map_change.hpp"

namespace vdna::record
{

namespace fs = std::filesystem;

MapChange::MapChange(const fs::path &map) : map_(map)
{
    std::error_code failure;
    made_ = fs::create_directories(map, failure);
    if (failure)
        throw Error(map.string() + ": cannot make this directory: " + failure.message());
    update_.emplace(map.string());
}

MapChange::~MapChange()
{
    update_.reset();
    if (!made_)
        return;
    try {
        const MapUpdate alone(map_.string()); // or another program is filling the directory
        std::error_code unused;
        fs::remove(map_, unused);
    } catch (const Error &) {
    }
}

void MapChange::commit()
{
    update_->commit();
    made_ = false;
}

} // namespace vdna::record
