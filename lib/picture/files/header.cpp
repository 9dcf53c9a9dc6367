#include "picture/files/header.hpp"

#include <cctype>
#include <cstring>
#include <string_view>

#include <vdna/image.h>

#include "failure.hpp"

namespace vdna::picture
{

namespace
{

[[noreturn]] void damaged(const char *what)
{
    throw fail::Failure(VDNA_ERR_FORMAT, std::string("encoded picture: ") + what);
}

// Bounds-checked numbers out of a header.
class Header
{
  public:
    Header(const uint8_t *data, size_t size) : data_(data), size_(size) {}

    bool has(size_t offset, std::string_view text) const
    {
        return offset <= size_ && text.size() <= size_ - offset &&
               std::memcmp(data_ + offset, text.data(), text.size()) == 0;
    }
    uint32_t byte(size_t offset) const
    {
        if (offset >= size_)
            damaged("its header is cut short");
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

Sides png(const Header &header)
{
    if (!header.has(12, "IHDR"))
        damaged("a PNG file must begin with IHDR");
    return {header.be32(16), header.be32(20)};
}

Sides webp(const Header &header)
{
    if (header.has(12, "VP8X"))
        return {header.le24(24) + 1, header.le24(27) + 1};
    if (header.has(12, "VP8L")) {
        const uint32_t bits = header.le32(21); // two 14-bit numbers, each less 1
        return {(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1};
    }
    if (!header.has(12, "VP8 ") || !header.has(23, "\x9d\x01\x2a"))
        damaged("a WebP file must hold VP8, VP8L or VP8X");
    return {header.le16(26) & 0x3fff, header.le16(28) & 0x3fff};
}

Sides bmp(const Header &header)
{
    constexpr uint32_t oldest = 12; // bytes of the OS/2 header, with 16-bit sides
    if (header.le32(14) == oldest)
        return {header.le16(18), header.le16(20)};
    const uint32_t height = header.le32(22); // negative: top row first
    return {header.le32(18), height >> 31 ? 0u - height : height};
}

// The number at `at`, after white space and comments; `at` moves behind it.
uint32_t pnm_number(const Header &header, size_t &at)
{
    for (; std::isspace(static_cast<int>(header.byte(at))) || header.byte(at) == '#'; at++)
        if (header.byte(at) == '#')
            while (header.byte(at) != '\n')
                at++;
    uint32_t number = 0;
    for (; std::isdigit(static_cast<int>(header.byte(at))); at++) {
        number = number * 10 + header.byte(at) - '0';
        if (number > INT32_MAX / 10)
            damaged("a PNM file with a side of too many digits");
    }
    return number;
}

Sides pnm(const Header &header)
{
    size_t at = 2;
    const uint32_t width = pnm_number(header, at);
    return {width, pnm_number(header, at)};
}

// The first directory of a TIFF file. Tiles are allocated whole, so they count as the picture does.
Sides tiff(const Header &header)
{
    const bool little = header.has(0, "II");
    const auto u16 = [&](size_t at) { return little ? header.le16(at) : header.be16(at); };
    const auto u32 = [&](size_t at) { return little ? header.le32(at) : header.be32(at); };

    Sides picture{0, 0};
    uint32_t tile_width = 0, tile_height = 0;
    const size_t directory = u32(4);
    const uint32_t entries = u16(directory);
    for (uint32_t i = 0; i < entries; i++) {
        constexpr uint32_t type_short = 3;
        const size_t entry = directory + 2 + size_t{12} * i;
        const uint32_t value = u16(entry + 2) == type_short ? u16(entry + 8) : u32(entry + 8);
        switch (u16(entry)) {
        case 256:
            picture.width = value;
            break;
        case 257:
            picture.height = value;
            break;
        case 322:
            tile_width = value;
            break;
        case 323:
            tile_height = value;
            break;
        default:
            break;
        }
    }
    if (tile_width > VDNA_IMAGE_SIDE_MAX || tile_height > VDNA_IMAGE_SIDE_MAX ||
        tile_width * tile_height > VDNA_IMAGE_PIXELS_MAX)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            "encoded picture: a TIFF file with tiles too large");
    return picture;
}

} // namespace

Sides read_sides(const uint8_t *data, size_t size)
{
    const Header header(data, size);
    if (header.has(0, "\x89PNG\r\n\x1a\n"))
        return png(header);
    if (header.has(0, "RIFF") && header.has(8, "WEBP"))
        return webp(header);
    if (header.has(0, "BM"))
        return bmp(header);
    if (size > 2 && data[0] == 'P' && data[1] >= '1' && data[1] <= '6' && std::isspace(data[2]))
        return pnm(header);
    using namespace std::string_view_literals;
    if (header.has(0, "II*\0"sv) || header.has(0, "MM\0*"sv))
        return tiff(header);
    throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                        "encoded picture: is no JPEG, PNG, WebP, BMP, PNM or TIFF file");
}

} // namespace vdna::picture
