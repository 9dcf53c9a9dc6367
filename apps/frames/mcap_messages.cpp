#include "frames/mcap_messages.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <optional>

#include <nlohmann/json.hpp>

namespace vdna::frames
{

namespace
{

constexpr int64_t seconds_max = 4000000000000; // as microseconds, differences fit

// False if the time is one that no camera has.
bool set_time(int64_t seconds, int64_t nanoseconds, McapContent &content)
{
    if (seconds < -seconds_max || seconds > seconds_max || nanoseconds < 0 ||
        nanoseconds > 999999999)
        return false;
    content.utime = seconds * 1000000 + nanoseconds / 1000;
    return true;
}

void set_encoded(Stretch bytes, McapContent &content)
{
    content.encoded.assign(bytes.data, bytes.data + bytes.size);
}

// Members one after the other, as ROS 1 and CDR (ROS 2) write them.
class RosReader
{
  public:
    RosReader(Stretch message, bool is_cdr) : bytes_(message), is_cdr_(is_cdr)
    {
        if (!is_cdr)
            return;
        // Only plain CDR: members in their order.
        const uint64_t kind = bytes_.big_endian(2);
        bytes_.number(2);
        big_endian_ = kind == 0;
        begin_ = bytes_.rest();
        if (kind > 1)
            bytes_.set_broken();
    }

    uint64_t number(size_t size)
    {
        if (is_cdr_)
            bytes_.take((size - (begin_ - bytes_.rest()) % size) % size);
        return big_endian_ ? bytes_.big_endian(size) : bytes_.number(size);
    }
    double real() { return real_of(number(8)); }
    Stretch counted() { return bytes_.take(number(4)); }
    bool broken() const { return bytes_.broken(); }

    bool time(McapContent &content)
    {
        const uint64_t seconds = number(4), nanoseconds = number(4);
        // ROS 1 counts without a sign, ROS 2 with one.
        return set_time(is_cdr_ ? static_cast<int32_t>(seconds) : static_cast<int64_t>(seconds),
                        static_cast<int64_t>(nanoseconds), content);
    }

    // std_msgs/Header
    bool header(McapContent &content)
    {
        if (!is_cdr_)
            number(4); // its number in the channel
        const bool holds = time(content);
        counted(); // name of the frame
        return holds;
    }

  private:
    ByteReader bytes_;
    bool is_cdr_, big_endian_ = false;
    size_t begin_ = 0; // bytes left where alignment counts from
};

bool read_ros_picture(RosReader reader, McapContent &content)
{
    const bool holds = reader.header(content);
    reader.counted(); // format: the bytes tell it too
    set_encoded(reader.counted(), content);
    return holds && !reader.broken();
}

bool read_ros_fix(RosReader reader, McapContent &content)
{
    const bool holds = reader.header(content);
    content.has_fix = static_cast<int8_t>(reader.number(1)) >= 0;
    reader.number(2); // satellite systems
    content.lat = reader.real();
    content.lon = reader.real();
    content.alt = reader.real();
    return holds && !reader.broken();
}

bool read_foxglove_ros_picture(RosReader reader, McapContent &content)
{
    const bool holds = reader.time(content);
    reader.counted(); // name of the frame
    set_encoded(reader.counted(), content);
    reader.counted(); // format
    return holds && !reader.broken();
}

bool read_foxglove_ros_fix(RosReader reader, McapContent &content)
{
    const bool holds = reader.time(content);
    reader.counted(); // name of the frame
    content.lat = reader.real();
    content.lon = reader.real();
    content.alt = reader.real();
    return holds && !reader.broken();
}

// A member of a protobuf message.
struct ProtobufField {
    uint64_t number;
    uint64_t value; // of a number
    Stretch bytes;  // of all else
};

uint64_t varint(ByteReader &reader)
{
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
        const uint64_t byte = reader.number(1);
        value |= (byte & 0x7F) << shift;
        if (byte < 0x80)
            return value;
    }
    reader.set_broken();
    return 0;
}

// The next member; false at the end.
bool next_field(ByteReader &reader, ProtobufField &out_field)
{
    if (reader.rest() == 0 || reader.broken())
        return false;
    const uint64_t tag = varint(reader);
    out_field = {tag >> 3, 0, {}};
    switch (tag & 7) {
    case 0:
        out_field.value = varint(reader);
        break;
    case 1:
        out_field.value = reader.number(8);
        break;
    case 2:
        out_field.bytes = reader.take(varint(reader));
        break;
    case 5:
        out_field.value = reader.number(4);
        break;
    default:
        reader.set_broken();
    }
    return !reader.broken();
}

// google.protobuf.Timestamp
bool read_timestamp(Stretch message, McapContent &content)
{
    ByteReader reader(message);
    int64_t seconds = 0, nanoseconds = 0;
    for (ProtobufField field{}; next_field(reader, field);)
        if (field.number == 1)
            seconds = static_cast<int64_t>(field.value);
        else if (field.number == 2)
            nanoseconds = static_cast<int64_t>(field.value);
    return !reader.broken() && set_time(seconds, nanoseconds, content);
}

bool read_protobuf_picture(Stretch message, McapContent &content)
{
    ByteReader reader(message);
    bool holds = true;
    for (ProtobufField field{}; next_field(reader, field);)
        if (field.number == 1)
            holds = holds && read_timestamp(field.bytes, content);
        else if (field.number == 2)
            set_encoded(field.bytes, content);
    return holds && !reader.broken();
}

bool read_protobuf_fix(Stretch message, McapContent &content)
{
    ByteReader reader(message);
    bool holds = true;
    const std::array<double *, 3> places = {&content.lat, &content.lon, &content.alt};
    for (ProtobufField field{}; next_field(reader, field);)
        if (field.number >= 1 && field.number <= places.size())
            *places[field.number - 1] = real_of(field.value);
        else if (field.number == 6)
            holds = holds && read_timestamp(field.bytes, content);
    return holds && !reader.broken();
}

// The six bits that a character of base64 stands for.
std::optional<uint32_t> six_bits(char character)
{
    static const char alphabet[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *const found = std::find(std::begin(alphabet), std::end(alphabet) - 1, character);
    if (found == std::end(alphabet) - 1)
        return {};
    return static_cast<uint32_t>(found - alphabet);
}

bool read_base64(const std::string &text, std::vector<uint8_t> &out_bytes)
{
    const size_t end = std::min(text.size(), text.find_last_not_of('=') + 1);
    uint32_t bits = 0;
    for (size_t i = 0; i < end; i++) {
        const std::optional<uint32_t> six = six_bits(text[i]);
        if (!six)
            return false;
        bits = bits << 6 | *six;
        if (i % 4 != 0)
            out_bytes.push_back(static_cast<uint8_t>(bits >> (6 - 2 * (i % 4))));
    }
    return true;
}

using Json = nlohmann::json;

Json parsed(Stretch message)
{
    return Json::parse(message.data, message.data + message.size);
}

bool set_time(const Json &message, McapContent &content)
{
    if (!message.contains("timestamp"))
        return true;
    const Json &seconds = message["timestamp"].at("sec"), &rest = message["timestamp"].at("nsec");
    return seconds.is_number_integer() && rest.is_number_integer() &&
           set_time(seconds.get<int64_t>(), rest.get<int64_t>(), content);
}

bool read_json_picture(Stretch message, McapContent &content)
{
    const Json json = parsed(message);
    return set_time(json, content) &&
           read_base64(json.at("data").get_ref<const std::string &>(), content.encoded);
}

bool read_json_fix(Stretch message, McapContent &content)
{
    const Json json = parsed(message);
    content.lat = json.at("latitude").get<double>();
    content.lon = json.at("longitude").get<double>();
    content.alt = json.value("altitude", 0.0);
    return set_time(json, content);
}

// Reads JSON that may be anything.
template <bool (*read)(Stretch, McapContent &)>
bool of_json(Stretch message, McapContent &content)
{
    try {
        return read(message, content);
    } catch (const Json::exception &) {
        return false;
    }
}

template <bool (*read)(RosReader, McapContent &)>
bool of_cdr(Stretch message, McapContent &content)
{
    return read(RosReader(message, true), content);
}

template <bool (*read)(RosReader, McapContent &)>
bool of_ros1(Stretch message, McapContent &content)
{
    return read(RosReader(message, false), content);
}

struct Type {
    const char *schema, *encoding;
    McapKind kind;
    bool (*read)(Stretch message, McapContent &content);
};

const Type types[] = {
    {"foxglove.CompressedImage", "protobuf", McapKind::picture, read_protobuf_picture},
    {"foxglove.CompressedImage", "json", McapKind::picture, of_json<read_json_picture>},
    {"foxglove_msgs/msg/CompressedImage", "cdr", McapKind::picture,
     of_cdr<read_foxglove_ros_picture>},
    {"foxglove_msgs/CompressedImage", "ros1", McapKind::picture,
     of_ros1<read_foxglove_ros_picture>},
    {"sensor_msgs/msg/CompressedImage", "cdr", McapKind::picture, of_cdr<read_ros_picture>},
    {"sensor_msgs/CompressedImage", "ros1", McapKind::picture, of_ros1<read_ros_picture>},
    {"foxglove.LocationFix", "protobuf", McapKind::fix, read_protobuf_fix},
    {"foxglove.LocationFix", "json", McapKind::fix, of_json<read_json_fix>},
    {"foxglove_msgs/msg/LocationFix", "cdr", McapKind::fix, of_cdr<read_foxglove_ros_fix>},
    {"foxglove_msgs/LocationFix", "ros1", McapKind::fix, of_ros1<read_foxglove_ros_fix>},
    {"sensor_msgs/msg/NavSatFix", "cdr", McapKind::fix, of_cdr<read_ros_fix>},
    {"sensor_msgs/NavSatFix", "ros1", McapKind::fix, of_ros1<read_ros_fix>},
};

const Type *type_of(const McapChannel &channel)
{
    const auto found = std::find_if(std::begin(types), std::end(types), [&](const Type &type) {
        return channel.schema == type.schema && channel.encoding == type.encoding;
    });
    return found == std::end(types) ? nullptr : found;
}

} // namespace

McapKind kind_of(const McapChannel &channel)
{
    const Type *const type = type_of(channel);
    return type ? type->kind : McapKind::other;
}

bool read_content(const McapMessage &message, McapContent &out_content)
{
    out_content = {};
    const Type *const type = type_of(*message.channel);
    return type && type->read(message.data, out_content);
}

} // namespace vdna::frames
