#include "picture/files/header.hpp"

#include "picture/exif.h"

namespace vdna::picture
{

namespace
{

// Some programs keep the beginning that the block has in a JPEG file.
uint32_t orientation_in(const Bytes &file, size_t at, size_t size)
{
    using namespace std::string_view_literals;
    constexpr std::string_view beginning = "Exif\0\0"sv;
    const size_t skip = size >= beginning.size() && file.has(at, beginning) ? beginning.size() : 0;
    return vdna_exif_orientation(file.data() + at + skip, size - skip);
}

uint32_t png_orientation(const Bytes &file)
{
    constexpr size_t around = 12; // bytes of length, type and checksum
    for (size_t at = 8; file.size() >= around && at <= file.size() - around;) {
        const size_t size = file.be32(at);
        if (size > file.size() - around - at)
            break;
        if (file.has(at + 4, "eXIf"))
            return orientation_in(file, at + 8, size);
        at += around + size;
    }
    return VDNA_UPRIGHT;
}

uint32_t webp_orientation(const Bytes &file)
{
    constexpr size_t head = 8; // bytes of type and size
    for (size_t at = 12; file.size() >= head && at <= file.size() - head;) {
        const size_t size = file.le32(at + 4);
        if (size > file.size() - head - at)
            break;
        if (file.has(at, "EXIF"))
            return orientation_in(file, at + head, size);
        at += head + size + size % 2;
    }
    return VDNA_UPRIGHT;
}

} // namespace

Header png_header(const Bytes &file)
{
    if (!file.has(12, "IHDR"))
        damaged("a PNG file must begin with IHDR");
    return {file.be32(16), file.be32(20), png_orientation(file)};
}

Header webp_header(const Bytes &file)
{
    if (file.has(12, "VP8X")) {
        constexpr uint32_t animation = 2;
        if (file.byte(20) & animation)
            unsupported("is an animated WebP picture; save each of its frames as a file");
        return {file.le24(24) + 1, file.le24(27) + 1, webp_orientation(file)};
    }
    // Only VP8X has room for EXIF.
    if (file.has(12, "VP8L")) {
        const uint32_t bits = file.le32(21); // two 14-bit numbers, each less 1
        return {(bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1, VDNA_UPRIGHT};
    }
    if (!file.has(12, "VP8 ") || !file.has(23, "\x9d\x01\x2a"))
        damaged("a WebP file must hold VP8, VP8L or VP8X");
    return {file.le16(26) & 0x3fff, file.le16(28) & 0x3fff, VDNA_UPRIGHT};
}

Header bmp_header(const Bytes &file)
{
    constexpr uint32_t oldest = 12; // bytes of the OS/2 header, with 16-bit sides
    if (file.le32(14) == oldest)
        return {file.le16(18), file.le16(20), VDNA_UPRIGHT};
    const uint32_t height = file.le32(22); // negative: top row first
    return {file.le32(18), height >> 31 ? 0u - height : height, VDNA_UPRIGHT};
}

} // namespace vdna::picture
