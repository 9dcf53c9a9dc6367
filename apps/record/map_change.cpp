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
    vdna_map_update *alone = nullptr; // or another program is filling the directory
    std::error_code unused;
    if (vdna_map_update_open(map_.c_str(), nullptr, &alone) == VDNA_OK)
        fs::remove(map_, unused);
    vdna_map_update_close(alone);
}

void MapChange::commit()
{
    update_->commit();
    made_ = false;
}

} // namespace vdna::record
