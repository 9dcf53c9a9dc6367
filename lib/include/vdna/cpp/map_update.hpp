/** @file vdna/cpp/map_update.hpp
 *  @brief An update of a map; it ends itself.
 */
#ifndef VDNA_CPP_MAP_UPDATE_HPP
#define VDNA_CPP_MAP_UPDATE_HPP

#include <string>

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>

namespace vdna
{

class MapUpdate
{
  public:
    /** Nobody else can change the map while this lives. Throws Error.
     *  @param directory  exists */
    explicit MapUpdate(const std::string &directory)
    {
        vdna_error error{};
        require(vdna_map_update_open(directory.c_str(), &error, &update_), error);
    }
    ~MapUpdate() { vdna_map_update_close(update_); }
    MapUpdate(const MapUpdate &) = delete;
    MapUpdate &operator=(const MapUpdate &) = delete;

    /** Write an experience that commit() will make NAME.vdna. Throws Error. */
    void add(const vdna_experience &experience)
    {
        vdna_error error{};
        require(vdna_map_update_add(update_, &experience, &error), error);
    }

    /** Put all of them in place, together or not at all. Throws Error. */
    void commit()
    {
        vdna_error error{};
        require(vdna_map_update_commit(update_, &error), error);
    }

  private:
    vdna_map_update *update_ = nullptr;
};

} // namespace vdna

#endif
