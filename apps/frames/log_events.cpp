#include "frames/log_events.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <vdna/cpp/error.hpp>

#include "transport/log_file.h"

namespace vdna::frames
{

namespace
{

constexpr size_t fingerprint_size = 8; // bytes, before the utime of a message
constexpr size_t stamp_size = 8;

struct Close {
    void operator()(FILE *file) const { std::fclose(file); }
};
using File = std::unique_ptr<FILE, Close>;

uint64_t big_endian(const uint8_t *bytes, size_t size)
{
    uint64_t number = 0;
    for (size_t i = 0; i < size; i++)
        number = number << 8 | bytes[i];
    return number;
}

// The stamp of a message; 0 if it is too short to have one.
int64_t stamp_of(vdna_log_file &log, const vdna_log_entry &entry)
{
    std::array<uint8_t, stamp_size> bytes{};
    if (entry.data_size >= fingerprint_size + stamp_size)
        vdna_log_file_read(&log, entry.offset + fingerprint_size, bytes.data(), bytes.size());
    return static_cast<int64_t>(big_endian(bytes.data(), bytes.size()));
}

// Note the damage before an event, or at the end. Numbers of events follow one another, so they
// tell how many are lost.
void note_damage(const vdna_log_entry &entry, uint64_t lost_events, LogContents &contents)
{
    if (entry.damage_size > 0)
        contents.damages.push_back(
            {entry.damage_at, entry.damage_size, contents.events.size(), lost_events});
}

} // namespace

LogContents read_log(const std::string &path, const std::string &channel)
{
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file)
        throw Error(path + ": cannot open this log");
    LogContents contents;
    vdna_log_file log = {file.get(), std::filesystem::file_size(path), 0};
    vdna_log_entry entry{};
    uint64_t expected_number = 0;
    while (vdna_log_file_next(&log, &entry)) {
        const bool has_gap = expected_number > 0 && entry.number > expected_number;
        note_damage(entry, has_gap ? entry.number - expected_number : 0, contents);
        expected_number = entry.number + 1;
        contents.channels.insert(entry.channel);
        if (entry.channel == channel)
            contents.events.push_back({entry.offset, entry.data_size, stamp_of(log, entry)});
    }
    note_damage(entry, 0, contents);
    contents.end_bytes = entry.end_size;
    return contents;
}

void read_message(std::istream &stream, const LogEvent &event, const std::string &name,
                  std::vector<uint8_t> &out_message)
{
    out_message.resize(event.size);
    stream.seekg(static_cast<std::streamoff>(event.offset));
    if (!stream.read(reinterpret_cast<char *>(out_message.data()), event.size))
        throw Error(name + ": cannot read; the log changed while it was open");
}

uint64_t fingerprint_of(const std::vector<uint8_t> &message)
{
    return big_endian(message.data(), std::min(message.size(), fingerprint_size));
}

std::string fingerprint_text(uint64_t fingerprint)
{
    char text[17];
    std::snprintf(text, sizeof text, "%016" PRIx64, fingerprint);
    return text;
}

std::string listed(const std::set<std::string> &channels)
{
    std::string text;
    for (const std::string &channel : channels)
        text += " " + channel;
    return text;
}

bool is_lcm_log(const std::string &path)
{
    const File file(std::fopen(path.c_str(), "rb"));
    return file && std::filesystem::is_regular_file(path) && vdna_log_file_is_log(file.get()) != 0;
}

} // namespace vdna::frames
