#include "frames/mcap_file.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include <vdna/cpp/error.hpp>

#include "frames/mcap_chunk.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

constexpr uint8_t magic[] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr uint64_t head_size = 9; // kind and length of a record
constexpr uint64_t body_bytes_max = uint64_t{1} << 31;

enum Kind : uint8_t { footer = 2, schema = 3, channel = 4, message = 5, chunk = 6, data_end = 15 };

bool is_read(uint8_t kind)
{
    return kind == schema || kind == channel || kind == message || kind == chunk;
}

bool begins_as_mcap(std::istream &stream)
{
    char bytes[sizeof magic];
    return stream.read(bytes, sizeof bytes) &&
           std::equal(std::begin(magic), std::end(magic), bytes,
                      [](uint8_t a, char b) { return a == static_cast<uint8_t>(b); });
}

} // namespace

McapFile::McapFile(const std::string &path) : path_(path), stream_(path, std::ios::binary)
{
    if (!stream_)
        throw Error(path + ": cannot open this file");
    if (!begins_as_mcap(stream_))
        throw Error(path + ": not an MCAP file, expected one that begins with its magic bytes");
    size_ = std::filesystem::file_size(path);
    at_ = sizeof magic;
}

bool McapFile::next(McapMessage &out_message)
{
    for (Record record{};;) {
        if (!take_of_chunk(record) && !read_record(record))
            return false;
        if (take(record, out_message))
            return true;
    }
}

// The next record outside chunks; false at the end. Only those that take() uses have a body.
bool McapFile::read_record(Record &out_record)
{
    uint8_t head[head_size];
    record_at_ = at_;
    const uint64_t rest = size_ - at_;
    end_bytes_ = rest;
    if (rest < head_size)
        return false;
    stream_.seekg(static_cast<std::streamoff>(at_));
    if (!stream_.read(reinterpret_cast<char *>(head), sizeof head))
        throw Error(path_ + ": cannot read; the file changed while it was open");
    ByteReader reader({head, sizeof head});
    out_record = {static_cast<uint8_t>(reader.number(1)), {}};
    const uint64_t size = reader.number(8);
    if (size > rest - head_size)
        return false;
    end_bytes_ = 0;
    at_ += head_size + size;
    if (out_record.kind == footer || out_record.kind == data_end)
        at_ = size_; // what follows is an index
    if (!is_read(out_record.kind))
        return true;
    require(size <= body_bytes_max, "a record of " + std::to_string(size) + " bytes, expected " +
                                        std::to_string(body_bytes_max) + " at most");
    record_.reset(new uint8_t[size]);
    if (!stream_.read(reinterpret_cast<char *>(record_.get()), static_cast<std::streamsize>(size)))
        throw Error(path_ + ": cannot read; the file changed while it was open");
    out_record.body = {record_.get(), static_cast<size_t>(size)};
    return true;
}

// The next record of the open chunk; false if there is none.
bool McapFile::take_of_chunk(Record &out_record)
{
    if (in_chunk_.rest() == 0)
        return false;
    ByteReader reader = in_chunk_;
    out_record.kind = static_cast<uint8_t>(reader.number(1));
    out_record.body = reader.take(reader.number(8));
    in_chunk_ = reader.broken() ? ByteReader({}) : reader;
    require(!reader.broken(), "a record of a chunk is longer than the chunk, whose rest is lost");
    require(out_record.kind != chunk, "a chunk within a chunk");
    return true;
}

// Use a record; true if it is a message.
bool McapFile::take(const Record &record, McapMessage &out_message)
{
    const ByteReader body(record.body);
    if (record.kind == schema)
        take_schema(body);
    else if (record.kind == channel)
        take_channel(body);
    else if (record.kind == chunk)
        open_chunk(body);
    else if (record.kind == message)
        take_message(body, out_message);
    return record.kind == message;
}

void McapFile::take_schema(ByteReader body)
{
    const uint64_t number = body.number(2);
    const std::string name = text_of(body.counted());
    require(!body.broken(), "a schema that is cut");
    schemas_[number] = name;
}

void McapFile::take_channel(ByteReader body)
{
    const uint64_t number = body.number(2), schema_number = body.number(2);
    const std::string topic = text_of(body.counted()), encoding = text_of(body.counted());
    require(!body.broken(), "a channel that is cut");
    const auto found = schemas_.find(schema_number);
    channels_[number] = {topic, found == schemas_.end() ? "" : found->second, encoding};
}

void McapFile::take_message(ByteReader body, McapMessage &out_message) const
{
    const auto found = channels_.find(body.number(2));
    body.number(4); // its number in the channel
    out_message.log_us = static_cast<int64_t>(body.number(8) / 1000);
    body.number(8); // when it was published
    require(!body.broken(), "a message that is cut");
    require(found != channels_.end(), "a message of a channel that is not described before it");
    out_message.channel = &found->second;
    out_message.data = body.take(body.rest());
}

void McapFile::open_chunk(ByteReader body)
{
    body.take(16); // times of its first and last message
    const uint64_t size = body.number(8), crc = body.number(4);
    const std::string compression = text_of(body.counted());
    const Stretch packed = body.take(body.number(8));
    require(!body.broken(), "a chunk that is cut");
    require(size <= mcap_chunk_bytes_max, "a chunk of " + std::to_string(size) +
                                              " bytes, expected " +
                                              std::to_string(mcap_chunk_bytes_max) + " at most");
    if (compression.empty())
        chunk_ = std::move(record_);
    else if (compression == "zstd")
        chunk_ = unpack_zstd(packed, size);
    else if (compression == "lz4")
        chunk_ = unpack_lz4(packed, size);
    else
        throw Error(path_ + ": its chunks are compressed with '" + compression +
                    "', expected zstd, lz4 or nothing");
    const Stretch records = {compression.empty() ? packed.data : chunk_.get(),
                             static_cast<size_t>(size)};
    require(chunk_ != nullptr && (!compression.empty() || packed.size == size),
            "a chunk that cannot be decompressed");
    require(crc == 0 || crc == crc32_of(records), "a chunk whose checksum is false");
    in_chunk_ = ByteReader(records);
}

void McapFile::require(bool holds, const std::string &what) const
{
    if (!holds)
        throw BadFrame(path_ + ": damaged at byte " + std::to_string(record_at_) + ": " + what);
}

bool is_mcap(const std::string &path)
{
    std::ifstream stream(path, std::ios::binary);
    return std::filesystem::is_regular_file(path) && begins_as_mcap(stream);
}

} // namespace vdna::frames
