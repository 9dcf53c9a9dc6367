#include "frame_cache.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <sha2.h>

#include "error.hpp"
#include "whole_file.hpp"

namespace vdna
{

namespace
{

namespace fs = std::filesystem;

constexpr char magic[] = "vdnaact1"; // 8 bytes; then tap count, dim, grey, the taps' shapes, the
                                     // embedding, the taps' values and the digest, as this
                                     // machine writes them

// A digest as 64 hexadecimal digits.
std::string sha256_of(const void *bytes, size_t size)
{
    char text[SHA256_DIGEST_STRING_LENGTH];
    SHA256Data(static_cast<const uint8_t *>(bytes), size, text);
    return text;
}

constexpr size_t digest_size = SHA256_DIGEST_STRING_LENGTH - 1;

fs::path default_directory()
{
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache && *cache)
        return fs::path(cache) / "vdna";
    if (home && *home)
        return fs::path(home) / ".cache" / "vdna";
    throw Error("neither XDG_CACHE_HOME nor HOME says where to keep activations; set --cache",
                exit_usage);
}

template <typename T>
void append(std::string &bytes, const T *values, size_t count)
{
    bytes.append(reinterpret_cast<const char *>(values), count * sizeof(T));
}

// Takes values from bytes until they run out.
class Cutter
{
  public:
    Cutter(const std::string &bytes, size_t size) : bytes_(bytes), size_(size) {}

    template <typename T>
    bool take(T *values, uint64_t count)
    {
        if (count > (size_ - at_) / sizeof(T))
            return false;
        std::memcpy(values, bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return true;
    }

    bool take(std::vector<float> &values, uint64_t count)
    {
        if (count > (size_ - at_) / sizeof(float))
            return false;
        values.resize(count);
        return take(values.data(), count);
    }

    bool at_end() const { return at_ == size_; }

  private:
    const std::string &bytes_;
    size_t size_;
    size_t at_ = 0;
};

// Points the taps into the values; false if they do not fill them.
bool lay_out(CachedFrame &frame)
{
    uint64_t at = 0;
    for (vdna_activations &tap : frame.taps) {
        tap.values = frame.values.data() + at;
        const uint64_t count = uint64_t{tap.neurons} * tap.samples;
        if (count > frame.values.size() - at)
            return false;
        at += count;
    }
    return at == frame.values.size();
}

std::optional<CachedFrame> parse(const std::string &bytes)
{
    if (bytes.size() < digest_size)
        return {};
    const size_t size = bytes.size() - digest_size;
    if (bytes.compare(size, digest_size, sha256_of(bytes.data(), size)) != 0)
        return {};
    Cutter cutter(bytes, size);
    char found[sizeof magic - 1];
    uint32_t tap_count = 0, dim = 0, shape[3];
    CachedFrame frame;
    if (!cutter.take(found, sizeof found) || std::memcmp(found, magic, sizeof found) != 0 ||
        !cutter.take(&tap_count, 1) || !cutter.take(&dim, 1) || !cutter.take(&frame.grey, 1))
        return {};
    uint64_t values = 0;
    for (uint32_t i = 0; i < tap_count; i++) {
        if (!cutter.take(shape, 3))
            return {};
        frame.taps.push_back({nullptr, shape[0], shape[1], shape[2]});
        values += uint64_t{shape[0]} * shape[1];
    }
    if (!cutter.take(frame.embedding, dim) || !cutter.take(frame.values, values) ||
        !cutter.at_end() || !lay_out(frame))
        return {};
    return frame;
}

} // namespace

vdna_backbone_frame CachedFrame::view() const
{
    vdna_backbone_frame frame{};
    frame.taps = taps.data();
    frame.tap_count = taps.size();
    frame.embedding = embedding.data();
    frame.dim = static_cast<uint32_t>(embedding.size());
    frame.grey = grey;
    return frame;
}

FrameCache::FrameCache(const std::string &directory, const vdna_backbone_info &backbone)
    : directory_(directory.empty() ? default_directory() : fs::path(directory)),
      network_(std::string(backbone.model_sha256) + "\n" + backbone.preprocessing + "\n" +
               backbone.taps + "\n" + backbone.runtime + "\n")
{
    std::error_code failure;
    fs::create_directories(directory_, failure);
    if (failure)
        throw Error(directory_.string() + ": cannot make this directory: " + failure.message() +
                    "; set --cache");
}

std::string FrameCache::key_of(const std::vector<uint8_t> &picture) const
{
    const std::string text = network_ + sha256_of(picture.data(), picture.size());
    return sha256_of(text.data(), text.size());
}

std::optional<CachedFrame> FrameCache::find(const std::string &key) const
{
    std::ifstream stream(file_of(key), std::ios::binary);
    std::ostringstream bytes;
    if (!stream || !(bytes << stream.rdbuf()))
        return {};
    return parse(bytes.str());
}

void FrameCache::store(const std::string &key, const vdna_backbone_frame &frame) const
{
    std::string bytes(magic);
    const uint32_t sizes[] = {static_cast<uint32_t>(frame.tap_count), frame.dim};
    append(bytes, sizes, 2);
    append(bytes, &frame.grey, 1);
    for (size_t i = 0; i < frame.tap_count; i++) {
        const uint32_t shape[] = {frame.taps[i].neurons, frame.taps[i].samples,
                                  frame.taps[i].layout};
        append(bytes, shape, 3);
    }
    append(bytes, frame.embedding, frame.dim);
    for (size_t i = 0; i < frame.tap_count; i++)
        append(bytes, frame.taps[i].values, size_t{frame.taps[i].neurons} * frame.taps[i].samples);
    bytes += sha256_of(bytes.data(), bytes.size());

    std::error_code failure;
    fs::create_directories(file_of(key).parent_path(), failure); // reported by the write
    write_whole_file(file_of(key).string(), bytes);
}

fs::path FrameCache::file_of(const std::string &key) const
{
    return directory_ / key.substr(0, 2) / (key.substr(2) + ".frame");
}

} // namespace vdna
