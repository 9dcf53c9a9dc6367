// Experience files, opened one by one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <vdna/map.h>

namespace vdna
{

// An open experience file; closes itself.
class Experience
{
  public:
    explicit Experience(const std::filesystem::path &path); // throws Error
    ~Experience() { vdna_experience_close(&experience_); }
    Experience(Experience &&other) noexcept;
    Experience &operator=(Experience &&) = delete;

    const vdna_experience *operator->() const { return &experience_; }
    const vdna_experience *get() const { return &experience_; }
    const std::filesystem::path &path() const { return path_; }

  private:
    std::filesystem::path path_;
    vdna_experience experience_{};
};

// The experience files of a map directory in the order of their names, unopened.
std::vector<std::filesystem::path> experience_files(const std::filesystem::path &map);

// Open files; a map directory stands for all of its files. They need not compare.
std::vector<Experience> open_experiences(const std::vector<std::string> &paths);

} // namespace vdna
