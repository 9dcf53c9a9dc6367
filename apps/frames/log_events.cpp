#include "frames/log_events.hpp"

#include <array>
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

// The stamp of a message; 0 if it is too short to have one.
int64_t stamp_of(vdna_log_file &log, const vdna_log_entry &entry)
{
    std::array<uint8_t, stamp_size> bytes{};
    if (entry.data_size >= fingerprint_size + stamp_size)
        vdna_log_file_read(&log, entry.offset + fingerprint_size, bytes.data(), bytes.size());
    uint64_t stamp = 0;
    for (const uint8_t byte : bytes)
        stamp = stamp << 8 | byte;
    return static_cast<int64_t>(stamp);
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

bool is_lcm_log(const std::string &path)
{
    const File file(std::fopen(path.c_str(), "rb"));
    return file && std::filesystem::is_regular_file(path) && vdna_log_file_is_log(file.get()) != 0;
}

} // namespace vdna::frames
