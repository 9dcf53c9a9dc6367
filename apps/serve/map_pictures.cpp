#include "serve/map_pictures.hpp"

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/experience.hpp>

namespace vdna::serve
{

namespace
{

namespace fs = std::filesystem;

// An update of a map renames files, which changes the time of its directory.
fs::file_time_type modified(const std::string &directory)
{
    std::error_code none;
    return fs::last_write_time(directory, none);
}

} // namespace

MapPictures::MapPictures(const std::string &directory)
    : directory_(directory), modified_(modified(directory)),
      map_(std::make_unique<const Map>(directory, MapOpening{false, true})),
      looked_(std::chrono::steady_clock::now())
{
}

void MapPictures::renew()
{
    const auto now = std::chrono::steady_clock::now();
    if (now - looked_ < std::chrono::seconds(1))
        return;
    looked_ = now;
    const fs::file_time_type changed = modified(directory_);
    if (changed == modified_)
        return;
    modified_ = changed;
    try {
        map_ = std::make_unique<const Map>(directory_, MapOpening{false, true});
    } catch (const Error &) {
        return; // the map as it was still has pictures
    }
}

std::optional<std::string> MapPictures::jpeg(const std::string &experience, uint32_t frame)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    renew();
    for (const vdna_experience &e : map_->experiences())
        if (e.name == experience && !thumbnail_of(e, frame).empty())
            return std::string(thumbnail_of(e, frame));
    return {};
}

} // namespace vdna::serve
