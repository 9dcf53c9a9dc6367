// MCAP files for tests, record by record, as https://mcap.dev/spec has them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include <lz4frame.h>
#include <zstd.h>

namespace mcap
{

inline std::string number(uint64_t value, int size)
{
    std::string bytes;
    for (int i = 0; i < size; i++)
        bytes += static_cast<char>(i < 8 ? value >> 8 * i & 0xff : 0);
    return bytes;
}

inline std::string real(double value)
{
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return number(bits, 8);
}

inline std::string counted(const std::string &text)
{
    return number(text.size(), 4) + text;
}

inline std::string record(uint8_t kind, const std::string &body)
{
    return std::string(1, static_cast<char>(kind)) + number(body.size(), 8) + body;
}

inline const std::string magic = "\x89MCAP0\r\n";

inline std::string header()
{
    return magic + record(1, counted("") + counted("test"));
}

inline std::string schema(uint16_t id, const std::string &name)
{
    return record(3, number(id, 2) + counted(name) + counted("any") + counted("data"));
}

inline std::string channel(uint16_t id, uint16_t schema_id, const std::string &topic,
                           const std::string &encoding)
{
    return record(4, number(id, 2) + number(schema_id, 2) + counted(topic) + counted(encoding) +
                         number(0, 4));
}

inline std::string message(uint16_t channel_id, uint64_t log_us, const std::string &data)
{
    return record(5, number(channel_id, 2) + number(0, 4) + number(log_us * 1000, 8) +
                         number(log_us * 1000, 8) + data);
}

inline std::string packed(const std::string &bytes, const std::string &compression)
{
    if (compression.empty())
        return bytes;
    const bool is_lz4 = compression == "lz4";
    std::string out(is_lz4 ? LZ4F_compressFrameBound(bytes.size(), nullptr)
                           : ZSTD_compressBound(bytes.size()),
                    '\0');
    out.resize(is_lz4 ? LZ4F_compressFrame(&out[0], out.size(), bytes.data(), bytes.size(), nullptr)
                      : ZSTD_compress(&out[0], out.size(), bytes.data(), bytes.size(), 1));
    return out;
}

// crc: 0 = not given.
inline std::string chunk(const std::string &records, const std::string &compression,
                         uint32_t crc = 0)
{
    const std::string bytes = packed(records, compression);
    return record(6, number(0, 16) + number(records.size(), 8) + number(crc, 4) +
                         counted(compression) + number(bytes.size(), 8) + bytes);
}

inline std::string end()
{
    return record(15, number(0, 4)) + record(2, number(0, 20)) + magic;
}

// Messages of ROS 1 or of CDR, member by member.
class Ros
{
  public:
    explicit Ros(bool is_cdr) : is_cdr_(is_cdr), bytes_(is_cdr ? std::string("\0\1\0\0", 4) : "") {}

    // CDR aligns numbers to their size, from after its first four bytes.
    Ros &add(uint64_t value, size_t size)
    {
        while (is_cdr_ && (bytes_.size() - 4) % size != 0)
            bytes_ += '\x55';
        bytes_ += number(value, static_cast<int>(size));
        return *this;
    }
    Ros &add(double value)
    {
        uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        return add(bits, sizeof bits);
    }
    Ros &bytes(const std::string &bytes)
    {
        add(bytes.size(), 4);
        bytes_ += bytes;
        return *this;
    }
    // CDR ends texts with a NUL, which counts.
    Ros &text(const std::string &text) { return bytes(text + (is_cdr_ ? std::string(1, 0) : "")); }
    Ros &time(uint64_t us) { return add(us / 1000000, 4).add(us % 1000000 * 1000, 4); }
    Ros &header(uint64_t us)
    {
        if (!is_cdr_)
            add(7, 4);
        return time(us).text("camera");
    }
    const std::string &done() const { return bytes_; }

  private:
    bool is_cdr_;
    std::string bytes_;
};

// A member of protobuf that is a number, or has a length of less than 128.
inline std::string varint(int field, uint64_t value)
{
    std::string bytes(1, static_cast<char>(field << 3));
    for (; value >= 0x80; value >>= 7)
        bytes += static_cast<char>(value | 0x80);
    return bytes + static_cast<char>(value);
}
inline std::string nested(int field, const std::string &body)
{
    return std::string(1, static_cast<char>(field << 3 | 2)) + static_cast<char>(body.size()) +
           body;
}

inline std::string timestamp(int field, uint64_t us)
{
    return nested(field, varint(1, us / 1000000) + varint(2, us % 1000000 * 1000));
}

inline std::string real_field(int field, double value)
{
    return std::string(1, static_cast<char>(field << 3 | 1)) + real(value);
}

// A type that is read, and how it looks with a picture "JPEG" or the position 51.5, -1.25, 70.
struct Sample {
    const char *schema, *encoding;
    std::string (*of)(uint64_t utime);
};

inline std::string ros_picture(bool is_cdr, uint64_t us)
{
    return Ros(is_cdr).header(us).text("jpeg").bytes("JPEG").done();
}
inline std::string foxglove_ros_picture(bool is_cdr, uint64_t us)
{
    return Ros(is_cdr).time(us).text("camera").bytes("JPEG").text("jpeg").done();
}
// status: -1 = no fix.
inline std::string ros_fix(bool is_cdr, uint64_t us, int8_t status = 0)
{
    return Ros(is_cdr)
        .header(us)
        .add(static_cast<uint8_t>(status), 1)
        .add(1, 2)
        .add(51.5)
        .add(-1.25)
        .add(70.0)
        .done();
}
inline std::string foxglove_ros_fix(bool is_cdr, uint64_t us)
{
    return Ros(is_cdr).time(us).text("gps").add(51.5).add(-1.25).add(70.0).done();
}
inline std::string json_time(uint64_t us)
{
    return R"("timestamp":{"sec":)" + std::to_string(us / 1000000) + R"(,"nsec":)" +
           std::to_string(us % 1000000 * 1000) + "}";
}

inline const Sample pictures[] = {
    {"foxglove.CompressedImage", "protobuf",
     [](uint64_t us) {
         return timestamp(1, us) + nested(4, "camera") + nested(2, "JPEG") + nested(3, "jpeg");
     }},
    {"foxglove.CompressedImage", "json",
     [](uint64_t us) {
         return "{" + json_time(us) + R"(,"frame_id":"c","data":"SlBFRw==","format":"jpeg"})";
     }},
    {"foxglove_msgs/msg/CompressedImage", "cdr",
     [](uint64_t us) { return foxglove_ros_picture(true, us); }},
    {"foxglove_msgs/CompressedImage", "ros1",
     [](uint64_t us) { return foxglove_ros_picture(false, us); }},
    {"sensor_msgs/msg/CompressedImage", "cdr", [](uint64_t us) { return ros_picture(true, us); }},
    {"sensor_msgs/CompressedImage", "ros1", [](uint64_t us) { return ros_picture(false, us); }},
};

inline const Sample fixes[] = {
    {"foxglove.LocationFix", "protobuf",
     [](uint64_t us) {
         return real_field(1, 51.5) + real_field(2, -1.25) + real_field(3, 70) + varint(5, 2) +
                timestamp(6, us) + nested(7, "gps");
     }},
    {"foxglove.LocationFix", "json",
     [](uint64_t us) {
         return "{" + json_time(us) + R"(,"latitude":51.5,"longitude":-1.25,"altitude":70})";
     }},
    {"foxglove_msgs/msg/LocationFix", "cdr",
     [](uint64_t us) { return foxglove_ros_fix(true, us); }},
    {"foxglove_msgs/LocationFix", "ros1", [](uint64_t us) { return foxglove_ros_fix(false, us); }},
    {"sensor_msgs/msg/NavSatFix", "cdr", [](uint64_t us) { return ros_fix(true, us); }},
    {"sensor_msgs/NavSatFix", "ros1", [](uint64_t us) { return ros_fix(false, us); }},
};

} // namespace mcap
