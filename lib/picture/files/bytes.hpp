// Bounds-checked numbers out of the bytes of a picture file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "failure.hpp"
#include "picture/levels.hpp"

namespace vdna::picture
{

[[noreturn]] inline void damaged(const std::string &what)
{
    throw fail::Failure(VDNA_ERR_FORMAT, "encoded picture: " + what);
}

[[noreturn]] inline void unsupported(const std::string &what)
{
    throw fail::Failure(VDNA_ERR_UNSUPPORTED, "encoded picture: " + what);
}

// Refuse a file of 16 bits that uses fewer. used: the bits that any value has set
inline void require_depth(uint32_t used)
{
    if (const uint32_t bits = fewer_than_16_bits(used))
        unsupported(fewer_bits_text(bits) + "scale its values to 0..65535, or save it as PGM or " +
                    "PPM, whose header gives the value of white");
}

// Borrows the file. Throws Failure, VDNA_ERR_FORMAT, for a number beyond its end.
class Bytes
{
  public:
    Bytes(const uint8_t *data, size_t size) : data_(data), size_(size) {}

    const uint8_t *data() const { return data_; }
    size_t size() const { return size_; }

    bool has(size_t offset, std::string_view text) const
    {
        return offset <= size_ && text.size() <= size_ - offset &&
               std::memcmp(data_ + offset, text.data(), text.size()) == 0;
    }
    uint32_t byte(size_t offset) const
    {
        if (offset >= size_)
            damaged("it is cut short");
        return data_[offset];
    }
    uint32_t le16(size_t at) const { return byte(at) | byte(at + 1) << 8; }
    uint32_t le24(size_t at) const { return le16(at) | byte(at + 2) << 16; }
    uint32_t le32(size_t at) const { return le16(at) | le16(at + 2) << 16; }
    uint32_t be16(size_t at) const { return byte(at) << 8 | byte(at + 1); }
    uint32_t be32(size_t at) const { return be16(at) << 16 | be16(at + 2); }

  private:
    const uint8_t *data_;
    size_t size_;
};

} // namespace vdna::picture
