// Camera frames of an LCM log file written by lcm-logger.
//
// Each event is a 28-byte big-endian header (magic u32, number i64, time i64 in microseconds,
// channel length u32, data length u32), the channel and the data. liblcm's own reader is not used
// because it crashes on a damaged length.
#include <array>
#include <fstream>
#include <set>
#include <vector>

#include <vdna/transport.h>

#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

constexpr uint32_t magic = 0xEDA1DA01;
constexpr size_t header_size = 28;
constexpr uint32_t channel_max = 1000; // bytes, as liblcm allows

uint32_t u32_at(const uint8_t *bytes)
{
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

bool read_bytes(std::ifstream &stream, void *out_bytes, size_t size)
{
    return static_cast<bool>(
        stream.read(static_cast<char *>(out_bytes), static_cast<std::streamsize>(size)));
}

class LogReader : public Reader
{
  public:
    LogReader(const std::string &path, const std::string &channel)
        : path_(path), stream_(path, std::ios::binary)
    {
        std::set<std::string> others;
        uint64_t at = 0;
        const uint64_t end = std::filesystem::file_size(path);
        // Ignore half an event at the end: a logger that was killed leaves one.
        while (end - at >= header_size) {
            std::string name;
            const Event event = event_at(at, end, name);
            at = event.offset + event.size;
            if (at > end)
                break;
            if (name == channel)
                events_.push_back(event);
            else
                others.insert(name);
        }
        if (events_.empty())
            throw Error(path + ": no message on channel " + channel + ", expected camera frames; " +
                        (others.empty() ? "it holds no others" : "set --camera to one of:") +
                        joined(others));
    }

    bool read(Frame &out_frame) override
    {
        if (next_ == events_.size())
            return false;
        const Event &event = events_[next_];
        const std::string name = path_ + ": frame " + std::to_string(next_);
        out_frame.index = next_++;
        bytes_.resize(event.size);
        stream_.seekg(static_cast<std::streamoff>(event.offset));
        if (!read_bytes(stream_, bytes_.data(), event.size))
            throw Error(name + ": cannot read; the log changed while it was open");
        vdna_transport_frame camera;
        if (vdna_transport_parse_image(bytes_.data(), bytes_.size(), &camera) != VDNA_OK)
            throw BadFrame(name + ": not a well-formed camera message (bot_core.image_t)");
        out_frame.name = name;
        out_frame.utime = camera.utime;
        out_frame.image = camera.image;
        return true;
    }

    bool skip() override
    {
        if (next_ == events_.size())
            return false;
        next_++;
        return true;
    }

    uint64_t size() const override { return events_.size(); }

  private:
    // The place of an event's data in the file.
    struct Event {
        uint64_t offset;
        uint32_t size; // bytes
    };

    Event event_at(uint64_t at, uint64_t end, std::string &out_channel)
    {
        std::array<uint8_t, header_size> header;
        stream_.seekg(static_cast<std::streamoff>(at));
        const bool complete = read_bytes(stream_, header.data(), header.size());
        const uint32_t length = u32_at(&header[20]), size = u32_at(&header[24]);
        if (!complete || u32_at(header.data()) != magic || length == 0 || length > channel_max)
            throw Error(path_ + ": damaged at byte " + std::to_string(at) +
                        ", expected an event of an LCM log");
        out_channel.resize(length);
        // A channel name cut off by the end of the file is also half an event.
        if (length > end - at - header_size || !read_bytes(stream_, out_channel.data(), length))
            return {end, 1};
        return {at + header_size + length, size};
    }

    static std::string joined(const std::set<std::string> &names)
    {
        std::string text;
        for (const std::string &name : names)
            text += " " + name;
        return text;
    }

    std::string path_;
    std::ifstream stream_;
    std::vector<Event> events_;
    std::vector<uint8_t> bytes_;
    size_t next_ = 0;
};

} // namespace

std::unique_ptr<Reader> open_lcm_log(const std::string &path, const std::string &channel)
{
    return std::make_unique<LogReader>(path, channel);
}

} // namespace vdna::frames
