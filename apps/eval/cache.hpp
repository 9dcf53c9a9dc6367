// What was computed once, kept on disk by content.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace vdna::eval
{

// A SHA-256 as 64 hexadecimal digits.
std::string sha256_of(const void *bytes, size_t size);

// A directory of entries. A key begins with a SHA-256 of everything that shapes the entry's bytes;
// an entry ends with a SHA-256 of its own.
class Cache
{
  public:
    // directory: "" = $XDG_CACHE_HOME/vdna, else ~/.cache/vdna; made if missing. Throws Error.
    explicit Cache(const std::string &directory);

    // Nothing if it is missing or damaged.
    std::optional<std::string> find(const std::string &key) const;
    // Whole or not at all. Throws Error.
    void store(const std::string &key, std::string bytes) const;

  private:
    std::filesystem::path file_of(const std::string &key) const;

    std::filesystem::path directory_;
};

} // namespace vdna::eval
