// A map and the backbone it was made with, opened together and checked against each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/map.h>
#include <vdna/select.h>

namespace vdna
{

// An open backbone; closes itself.
class Backbone
{
  public:
    // manifest, max_pixels: as vdna_backbone_config; runtime: "" = found by itself. Throws Error.
    Backbone(const std::string &manifest, uint32_t threads, const std::string &runtime = "",
             uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX);
    ~Backbone();
    Backbone(const Backbone &) = delete;
    Backbone &operator=(const Backbone &) = delete;

    vdna_backbone *get() const { return handle_; }
    const vdna_backbone_info &info() const { return info_; }

  private:
    vdna_backbone *handle_ = nullptr;
    vdna_backbone_info info_{};
};

// The open experiences of a map directory; closes itself.
class Map
{
  public:
    // Throws Error, also if two experiences do not compare.
    explicit Map(const std::string &directory);
    ~Map();
    Map(const Map &) = delete;
    Map &operator=(const Map &) = delete;

    const std::vector<vdna_experience> &experiences() const { return experiences_; }
    // The experiences as the selector wants them; borrowed from this map.
    std::vector<vdna_select_candidate> candidates() const;
    // Throw Error, naming the field and the remedy, unless `backbone` made this map.
    void require_backbone(const vdna_backbone_info &backbone) const;

  private:
    std::string directory_;
    std::vector<vdna_experience> experiences_;
};

} // namespace vdna
