#include "eval/cache.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <sha2.h>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"
#include "program/replaced_file.hpp"

namespace vdna::eval
{

namespace
{

namespace fs = std::filesystem;

constexpr size_t digest_size = SHA256_DIGEST_STRING_LENGTH - 1;

fs::path default_directory()
{
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache && *cache)
        return fs::path(cache) / "vdna";
    if (home && *home)
        return fs::path(home) / ".cache" / "vdna";
    throw program::UsageError(
        "neither XDG_CACHE_HOME nor HOME says where to keep activations; set --cache");
}

} // namespace

std::string sha256_of(const void *bytes, size_t size)
{
    char text[SHA256_DIGEST_STRING_LENGTH];
    SHA256Data(static_cast<const uint8_t *>(bytes), size, text);
    return text;
}

Cache::Cache(const std::string &directory)
    : directory_(directory.empty() ? default_directory() : fs::path(directory))
{
    std::error_code failure;
    fs::create_directories(directory_, failure);
    if (failure)
        throw Error(directory_.string() + ": cannot make this directory: " + failure.message() +
                    "; set --cache");
}

std::optional<std::string> Cache::find(const std::string &key) const
{
    std::ifstream stream(file_of(key), std::ios::binary);
    std::ostringstream text;
    if (!stream || !(text << stream.rdbuf()))
        return {};
    std::string bytes = text.str();
    if (bytes.size() < digest_size)
        return {};
    const std::string digest = bytes.substr(bytes.size() - digest_size);
    bytes.resize(bytes.size() - digest_size);
    if (digest != sha256_of(bytes.data(), bytes.size()))
        return {};
    return bytes;
}

void Cache::store(const std::string &key, std::string bytes) const
{
    bytes += sha256_of(bytes.data(), bytes.size());
    std::error_code failure;
    fs::create_directories(file_of(key).parent_path(), failure); // reported by the write
    program::replace_file(file_of(key).string(), bytes, program::Durability::quick);
}

fs::path Cache::file_of(const std::string &key) const
{
    return directory_ / key.substr(0, 2) / key.substr(2);
}

} // namespace vdna::eval
