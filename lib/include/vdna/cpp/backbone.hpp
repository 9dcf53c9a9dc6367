/** @file vdna/cpp/backbone.hpp
 *  @brief An open network that closes itself.
 */
#ifndef VDNA_CPP_BACKBONE_HPP
#define VDNA_CPP_BACKBONE_HPP

#include <cstdint>
#include <string>

#include <vdna/backbone.h>
#include <vdna/cpp/error.hpp>

namespace vdna
{

class Backbone
{
  public:
    /** Open a network; throws Error.
     *  @param manifest, max_pixels  as in vdna_backbone_config; a plug-in is a path to a .so
     *  @param threads  compute threads, >= 1
     *  @param runtime  path of libonnxruntime.so; "" = the library finds one */
    Backbone(const std::string &manifest, uint32_t threads, const std::string &runtime = "",
             uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX)
    {
        vdna_backbone_config config;
        vdna_backbone_config_init(&config);
        config.manifest = manifest.c_str();
        config.threads = threads;
        config.max_pixels = max_pixels;
        config.runtime = runtime.empty() ? nullptr : runtime.c_str();
        vdna_error error{};
        require(vdna_backbone_open(&config, &error, &handle_), error);
        vdna_backbone_describe(handle_, &info_);
    }
    /** Open a network by a table of the caller's, with the default configuration; throws Error.
     *  @param manifest  handed to the table's `open` as it is; NULL is allowed */
    explicit Backbone(const vdna_backbone_operations &operations, const char *manifest = nullptr)
    {
        vdna_backbone_config config;
        vdna_backbone_config_init(&config);
        config.manifest = manifest;
        vdna_error error{};
        require(vdna_backbone_open_with(&operations, &config, &error, &handle_), error);
        vdna_backbone_describe(handle_, &info_);
    }
    ~Backbone() { vdna_backbone_close(handle_); }
    Backbone(const Backbone &) = delete;
    Backbone &operator=(const Backbone &) = delete;

    vdna_backbone *get() const { return handle_; }
    const vdna_backbone_info &info() const { return info_; }

  private:
    vdna_backbone *handle_ = nullptr;
    vdna_backbone_info info_{};
};

} // namespace vdna

#endif
