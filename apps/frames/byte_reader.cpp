#include "frames/byte_reader.hpp"

#include <cstring>

namespace vdna::frames
{

std::string text_of(Stretch bytes)
{
    return {reinterpret_cast<const char *>(bytes.data), bytes.size};
}

double real_of(uint64_t bits)
{
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

Stretch ByteReader::take(uint64_t size)
{
    broken_ = broken_ || size > rest_.size;
    if (broken_)
        return {};
    const Stretch taken = {rest_.data, static_cast<size_t>(size)};
    rest_ = {rest_.data + taken.size, rest_.size - taken.size};
    return taken;
}

uint64_t ByteReader::number(size_t size)
{
    const Stretch bytes = take(size);
    uint64_t number = 0;
    for (size_t i = bytes.size; i-- > 0;)
        number = number << 8 | bytes.data[i];
    return number;
}

uint64_t ByteReader::big_endian(size_t size)
{
    const Stretch bytes = take(size);
    uint64_t number = 0;
    for (size_t i = 0; i < bytes.size; i++)
        number = number << 8 | bytes.data[i];
    return number;
}

double ByteReader::real()
{
    return real_of(number(8));
}

} // namespace vdna::frames
