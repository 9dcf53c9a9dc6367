// What the network made of pictures, kept on disk by content, so that it runs once per picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <vdna/backbone.h>

namespace vdna
{

// A frame of the cache, in memory. Moving it keeps what view() returned.
struct CachedFrame {
    float grey = 0; // 0..255
    std::vector<float> embedding;
    std::vector<vdna_activations> taps; // point into `values`
    std::vector<float> values;

    vdna_backbone_frame view() const; // borrowed
};

// A directory of frames. Each is one file, named after a SHA-256 of the picture's bytes and of
// everything about the network that shapes the numbers; it ends with a SHA-256 of its own bytes.
class FrameCache
{
  public:
    // directory: "" = $XDG_CACHE_HOME/vdna, else ~/.cache/vdna; made if missing. Throws Error.
    FrameCache(const std::string &directory, const vdna_backbone_info &backbone);

    std::string key_of(const std::vector<uint8_t> &picture) const;
    // Nothing if it is missing or damaged.
    std::optional<CachedFrame> find(const std::string &key) const;
    // Whole or not at all. Throws Error.
    void store(const std::string &key, const vdna_backbone_frame &frame) const;

  private:
    std::filesystem::path file_of(const std::string &key) const;

    std::filesystem::path directory_;
    std::string network_;
};

} // namespace vdna
