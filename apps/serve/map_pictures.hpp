// The thumbnails of a map's frames, for the page beside the live picture.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <vdna/cpp/map.hpp>

namespace vdna::serve
{

// May be used from several threads. The files are mapped, so that the system can take their memory
// back, and must only be replaced by renames, as `vdna build` does.
class MapPictures
{
  public:
    // Throws Error if the map cannot be opened.
    explicit MapPictures(const std::string &directory);

    // The JPEG of a frame; nothing if the map has no such experience, frame or thumbnail. Names are
    // compared with those of the map only: none becomes a path. A map that changed is opened again,
    // once a second at most; one that cannot be opened leaves the one before it.
    std::optional<std::string> jpeg(const std::string &experience, uint32_t frame);

  private:
    void renew();

    const std::string directory_;
    std::mutex mutex_;
    std::filesystem::file_time_type modified_; // before the map was opened
    std::unique_ptr<const Map> map_;
    std::chrono::steady_clock::time_point looked_;
};

} // namespace vdna::serve
