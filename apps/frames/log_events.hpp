// The events of an LCM log file written by lcm-logger, damaged ones left out.
#pragma once

#include <cstdint>
#include <istream>
#include <set>
#include <string>
#include <vector>

namespace vdna::frames
{

// The place of a message in the log.
struct LogEvent {
    uint64_t offset; // of its data in the file
    uint32_t size;   // bytes of data
    int64_t stamp;   // first 8 bytes after the fingerprint, where messages have their utime
};

// A stretch of the log that holds no events.
struct LogDamage {
    uint64_t offset;      // of its first byte
    uint64_t size;        // bytes
    size_t next;          // index of the first event of the channel after it
    uint64_t lost_events; // of all channels, by their numbers; 0 = unknown
};

struct LogContents {
    std::vector<LogEvent> events; // of one channel
    std::vector<LogDamage> damages;
    std::set<std::string> channels; // all of them
    uint64_t end_bytes = 0;         // of half an event or of zeros at the end
};

// Read the headers of all events. Where bytes are no event, the next one is looked for. Throws
// Error if the file cannot be read.
LogContents read_log(const std::string &path, const std::string &channel);

// The bytes of a message. stream: the open log; name: of the message or the log, for complaints.
// Throws Error.
void read_message(std::istream &stream, const LogEvent &event, const std::string &name,
                  std::vector<uint8_t> &out_message);

// The first 8 bytes of a message, which tell its type; of a shorter one, those that there are.
uint64_t fingerprint_of(const std::vector<uint8_t> &message);
std::string fingerprint_text(uint64_t fingerprint);

// " CAMERA POSE", to end a complaint.
std::string listed(const std::set<std::string> &channels);

// True if the file begins like an LCM log.
bool is_lcm_log(const std::string &path);

} // namespace vdna::frames
