// The messages of an MCAP file (https://mcap.dev/spec), in the order of the file.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "frames/byte_reader.hpp"

namespace vdna::frames
{

struct McapChannel {
    std::string topic;
    std::string schema;   // name of the type, such as "sensor_msgs/msg/CompressedImage"
    std::string encoding; // of the messages: "protobuf", "cdr" ...
};

struct McapMessage {
    const McapChannel *channel; // of the file
    int64_t log_us;             // when it was logged, microseconds
    Stretch data;               // borrowed until the next message
};

// Reads a file from its beginning to the end of its data. The index at its end is not needed, so
// that the file of a killed recorder is read as far as it goes.
class McapFile
{
  public:
    // Throws Error if it cannot be read or is no MCAP file.
    explicit McapFile(const std::string &path);

    // The next message; false at the end. Throws BadFrame where bytes are damaged, once: the next
    // call goes on behind them. Throws Error if the file cannot be read further.
    bool next(McapMessage &out_message);
    // At the end: bytes of half a record, which a killed recorder leaves.
    uint64_t end_bytes() const { return end_bytes_; }

  private:
    struct Record {
        uint8_t kind;
        Stretch body;
    };

    bool read_record(Record &out_record);
    bool take_of_chunk(Record &out_record);
    bool take(const Record &record, McapMessage &out_message);
    void take_schema(ByteReader body);
    void take_channel(ByteReader body);
    void take_message(ByteReader body, McapMessage &out_message) const;
    void open_chunk(ByteReader body);
    void require(bool holds, const std::string &what) const;

    std::string path_;
    std::ifstream stream_;
    uint64_t size_ = 0;      // bytes of the file
    uint64_t at_ = 0;        // of the next record
    uint64_t record_at_ = 0; // of the newest one outside chunks
    uint64_t end_bytes_ = 0;
    std::unique_ptr<uint8_t[]> record_, chunk_; // what bodies lie in
    ByteReader in_chunk_{{}};                   // records of the chunk that are still to come
    std::map<uint64_t, std::string> schemas_;   // names by number
    std::map<uint64_t, McapChannel> channels_;  // by number
};

// True if the file begins like an MCAP file.
bool is_mcap(const std::string &path);

} // namespace vdna::frames
