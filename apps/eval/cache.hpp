// Results kept on disk by content.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace vdna::eval
{

// A SHA-256 as 64 hexadecimal digits.
std::string sha256_of(const void *bytes, size_t size);

// A directory of entries. A key begins with a SHA-256 of everything that determines the bytes of
// the entry; an entry ends with its own SHA-256.
class Cache
{
  public:
    // directory: "" = $XDG_CACHE_HOME/vdna, else ~/.cache/vdna; made if missing. Throws Error.
    explicit Cache(const std::string &directory);

    // Nothing if it is missing or damaged.
    std::optional<std::string> find(const std::string &key) const;
    // Stores atomically. Throws Error.
    void store(const std::string &key, std::string bytes) const;

  private:
    std::filesystem::path file_of(const std::string &key) const;

    std::filesystem::path directory_;
};

} // namespace vdna::eval
