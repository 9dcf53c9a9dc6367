// A folder of a test's own, gone with the object.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

class Folder
{
  public:
    Folder()
    {
        std::string name = std::filesystem::temp_directory_path() / "vdna-test-XXXXXX";
        path_ = mkdtemp(name.data());
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;

    const std::filesystem::path &path() const { return path_; }

    // Write a file of the folder; returns its path.
    std::filesystem::path write(const std::string &name, const std::string &bytes) const
    {
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }

  private:
    std::filesystem::path path_;
};

inline std::string file_bytes(const std::filesystem::path &file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// `text` with one passage exchanged; the passage must be there.
inline std::string with(std::string text, const std::string &passage, const std::string &other)
{
    return text.replace(text.find(passage), passage.size(), other);
}
