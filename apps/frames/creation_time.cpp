#include "frames/creation_time.hpp"

#include <array>
#include <cstring>
#include <fstream>

namespace vdna::frames
{

namespace
{

// The boxes of an MP4 file: 4 bytes size, 4 bytes name, contents. Numbers are big-endian.
class Boxes
{
  public:
    explicit Boxes(const std::filesystem::path &path) : stream_(path, std::ios::binary) {}

    // Go into the next box of this name, passing over others. False if there is none.
    bool enter(const char *name)
    {
        for (;;) {
            const uint64_t size = number(4);
            std::array<char, 4> found{};
            stream_.read(found.data(), found.size());
            const bool is_long = size == 1;
            const uint64_t whole = is_long ? number(8) : size, header = is_long ? 16 : 8;
            if (!stream_ || whole < header)
                return false;
            if (std::memcmp(found.data(), name, found.size()) == 0)
                return true;
            stream_.seekg(static_cast<std::streamoff>(whole - header), std::ios::cur);
        }
    }

    uint64_t number(int bytes)
    {
        uint64_t value = 0;
        for (int i = 0; i < bytes; i++)
            value = value << 8 | (static_cast<uint64_t>(stream_.get()) & 0xff);
        return value;
    }

    bool is_good() const { return static_cast<bool>(stream_); }

  private:
    std::ifstream stream_;
};

} // namespace

std::optional<int64_t> creation_time_of(const std::filesystem::path &video)
{
    constexpr uint64_t from_1904_to_1970_s = 2082844800, longest_s = 0xffffffff;
    Boxes boxes(video);
    if (!boxes.enter("moov") || !boxes.enter("mvhd"))
        return {};
    const uint64_t version = boxes.number(4) >> 24;
    const uint64_t seconds = boxes.number(version == 1 ? 8 : 4);
    if (!boxes.is_good() || seconds <= from_1904_to_1970_s || seconds > longest_s)
        return {};
    return static_cast<int64_t>(seconds - from_1904_to_1970_s) * 1000000;
}

} // namespace vdna::frames
