/** @file vdna/cpp/experience.hpp
 *  @brief One open experience file; it closes itself.
 */
#ifndef VDNA_CPP_EXPERIENCE_HPP
#define VDNA_CPP_EXPERIENCE_HPP

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>

namespace vdna
{

/** The JPEG file of a frame's thumbnail, borrowed from the experience; "" if there is none or no
 * such frame. Nobody has decoded it: its content may be anything. */
inline std::string_view thumbnail_of(const vdna_experience &experience, uint32_t frame)
{
    const uint8_t *jpeg = nullptr;
    size_t size = 0;
    if (vdna_experience_thumbnail(&experience, frame, &jpeg, &size) != VDNA_OK)
        return {};
    return {reinterpret_cast<const char *>(jpeg), size};
}

/** What the header of an experience file says: vdna_experience_read_header(). Throws Error. */
inline vdna_experience header_of(const std::filesystem::path &path)
{
    vdna_error error{};
    vdna_experience header{};
    require(vdna_experience_read_header(path.c_str(), &error, &header), error);
    return header;
}

class Experience
{
  public:
    /** Throws Error. */
    explicit Experience(const std::filesystem::path &path) : path_(path)
    {
        vdna_error error{};
        require(vdna_experience_open(path.c_str(), &error, &experience_), error);
    }
    /** The bytes of a file, as vdna_experience_open_memory() opens them: they stay where they are,
     * and must outlive this. Its path is "". Throws Error. */
    static Experience of_memory(const void *bytes, size_t size)
    {
        Experience opened;
        vdna_error error{};
        require(vdna_experience_open_memory(bytes, size, &error, &opened.experience_), error);
        return opened;
    }
    ~Experience() { vdna_experience_close(&experience_); }
    Experience(Experience &&other) noexcept
        : path_(std::move(other.path_)), experience_(std::exchange(other.experience_, {}))
    {
    }
    Experience &operator=(Experience &&) = delete;

    const vdna_experience *operator->() const { return &experience_; }
    const vdna_experience *get() const { return &experience_; }
    const std::filesystem::path &path() const { return path_; }

  private:
    Experience() = default;

    std::filesystem::path path_;
    vdna_experience experience_{};
};

} // namespace vdna

#endif
