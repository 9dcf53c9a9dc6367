// Each event is a 28-byte big-endian header (magic u32, number i64, time i64 in microseconds,
// channel length u32, data length u32), the channel and the data. liblcm's own reader is not used
// because it crashes on a damaged length and stops at the first damage.
#include "frames/log_events.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include <vdna/cpp/error.hpp>

namespace vdna::frames
{

namespace
{

constexpr uint32_t magic = 0xEDA1DA01;
constexpr std::array<char, 4> magic_bytes = {'\xED', '\xA1', '\xDA', '\x01'};
constexpr size_t header_size = 28;
constexpr uint32_t channel_max = 1000;  // bytes, as liblcm allows
constexpr size_t stamp_end = 16;        // bytes of a message up to the end of its utime
constexpr size_t chunk_size = 1u << 16; // bytes searched at once

uint32_t u32_at(const uint8_t *bytes)
{
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

uint64_t u64_at(const uint8_t *bytes)
{
    return uint64_t{u32_at(bytes)} << 32 | u32_at(bytes + 4);
}

// Reads a file by position.
class File
{
  public:
    explicit File(const std::string &path)
        : path_(path), stream_(path, std::ios::binary), size_(std::filesystem::file_size(path))
    {
    }

    uint64_t size() const { return size_; }

    // As many bytes as there are, at most `wanted`.
    size_t read(uint64_t at, void *out_bytes, size_t wanted)
    {
        const size_t there = static_cast<size_t>(std::min<uint64_t>(wanted, size_ - at));
        stream_.clear();
        stream_.seekg(static_cast<std::streamoff>(at));
        if (!stream_.read(static_cast<char *>(out_bytes), static_cast<std::streamsize>(there)))
            throw Error(path_ + ": cannot read at byte " + std::to_string(at) +
                        "; did the file change?");
        return there;
    }

    // Position of the first magic number from `at` on; the end if there is none.
    uint64_t find_magic(uint64_t at)
    {
        std::vector<char> chunk(chunk_size);
        while (at + magic_bytes.size() <= size_) {
            const size_t there = read(at, chunk.data(), chunk.size());
            const auto end = chunk.begin() + static_cast<std::ptrdiff_t>(there);
            const auto found =
                std::search(chunk.begin(), end, magic_bytes.begin(), magic_bytes.end());
            if (found != end)
                return at + static_cast<uint64_t>(found - chunk.begin());
            // A magic number may span two chunks.
            at += there - (magic_bytes.size() - 1);
        }
        return size_;
    }

    bool is_zero_from(uint64_t at)
    {
        std::vector<char> chunk(chunk_size);
        while (at < size_) {
            const size_t there = read(at, chunk.data(), chunk.size());
            const auto end = chunk.begin() + static_cast<std::ptrdiff_t>(there);
            if (std::any_of(chunk.begin(), end, [](char byte) { return byte != 0; }))
                return false;
            at += there;
        }
        return true;
    }

  private:
    std::string path_;
    std::ifstream stream_;
    uint64_t size_;
};

// An event as its header describes it.
struct Header {
    uint64_t number;
    uint32_t channel_size, data_size; // bytes
    uint64_t end(uint64_t at) const { return at + header_size + channel_size + data_size; }
};

class LogReading
{
  public:
    LogReading(const std::string &path, const std::string &channel) : file_(path), channel_(channel)
    {
    }

    LogContents read()
    {
        for (uint64_t at = 0; at < file_.size();)
            at = next(at);
        return std::move(contents_);
    }

  private:
    // Take in what begins at `at`; returns where the next event is expected.
    uint64_t next(uint64_t at)
    {
        const std::optional<Header> header = header_at(at);
        if (is_half_event(at, header)) {
            contents_.half_event = file_.size() - at;
            return file_.size();
        }
        if (header && is_followed_well(header->end(at))) {
            take(at, *header);
            return header->end(at);
        }
        if (file_.is_zero_from(at)) {
            contents_.zeros = file_.size() - at;
            return file_.size();
        }
        return pass_over_damage(at);
    }

    // Also fills `front_`.
    std::optional<Header> header_at(uint64_t at)
    {
        if (file_.read(at, front_.data(), front_.size()) < header_size)
            return {};
        const Header header = {u64_at(&front_[4]), u32_at(&front_[20]), u32_at(&front_[24])};
        if (u32_at(front_.data()) != magic || header.channel_size == 0 ||
            header.channel_size > channel_max)
            return {};
        return header;
    }

    // Whether an event begins here that the end of the file cuts off, as a logger that is killed
    // leaves it. In an event that was cut in the middle of a log, others follow.
    bool is_half_event(uint64_t at, const std::optional<Header> &header)
    {
        if (header)
            return header->end(at) > file_.size() && file_.find_magic(at + 1) == file_.size();
        return file_.size() - at < header_size && is_magic_at(at);
    }

    // Whether the magic number is here, or as much of it as the file has left.
    bool is_magic_at(uint64_t at)
    {
        std::array<char, 4> bytes{};
        const size_t there = file_.read(at, bytes.data(), bytes.size());
        return std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(there),
                          magic_bytes.begin());
    }

    // An event counts if another one begins where it ends, or the log ends there. Otherwise it was
    // cut, or its last bytes may be anything.
    bool is_followed_well(uint64_t end)
    {
        if (end >= file_.size())
            return end == file_.size();
        return is_magic_at(end) || file_.is_zero_from(end);
    }

    void take(uint64_t at, const Header &header)
    {
        const auto name_begin = front_.begin() + header_size;
        const std::string name(name_begin, name_begin + header.channel_size);
        contents_.channels.insert(name);
        count_loss(header.number);
        if (name != channel_)
            return;
        const size_t data = header_size + header.channel_size;
        const uint64_t stamp = header.data_size >= stamp_end ? u64_at(&front_[data + 8]) : 0;
        contents_.events.push_back({at + data, header.data_size, static_cast<int64_t>(stamp)});
    }

    // Numbers of events follow one another, so after damage they tell how many are lost.
    void count_loss(uint64_t number)
    {
        if (after_damage_ && has_number_ && number > expected_number_)
            contents_.damages.back().lost_events = number - expected_number_;
        after_damage_ = false;
        has_number_ = true;
        expected_number_ = number + 1;
    }

    uint64_t pass_over_damage(uint64_t at)
    {
        const uint64_t found = file_.find_magic(at + 1);
        if (after_damage_) // bytes that only looked like an event
            contents_.damages.back().size += found - at;
        else
            contents_.damages.push_back({at, found - at, contents_.events.size(), 0});
        after_damage_ = true;
        return found;
    }

    File file_;
    std::string channel_;
    std::array<uint8_t, header_size + channel_max + stamp_end> front_{}; // of the event at hand
    LogContents contents_;
    bool after_damage_ = false;
    bool has_number_ = false;
    uint64_t expected_number_ = 0;
};

} // namespace

LogContents read_log(const std::string &path, const std::string &channel)
{
    return LogReading(path, channel).read();
}

bool is_lcm_log(const std::string &path)
{
    std::ifstream stream(path, std::ios::binary);
    std::array<char, 4> bytes;
    return stream.read(bytes.data(), bytes.size()) && bytes == magic_bytes;
}

} // namespace vdna::frames
