#include "picture/files/tiff.hpp"

#include <vdna/image.h>

#include "picture/exif.h"

namespace vdna::picture
{

namespace
{

namespace tag
{
constexpr uint32_t width = 256, height = 257, bits = 258, colours = 262, orientation = 274,
                   channels = 277, planes = 284, tile_width = 322, tile_height = 323, extra = 338,
                   sample_format = 339, dng_version = 50706;
}

// Values of tag::colours.
constexpr uint32_t white_is_zero = 0, black_is_zero = 1, rgb = 2, palette = 3, cmyk = 5, ycbcr = 6,
                   lab = 8, bayer = 32803;

constexpr uint32_t type_short = 3, entry_size = 12;

class Directory
{
  public:
    explicit Directory(const Bytes &file)
        : file_(file), little_(file.byte(0) == 'I'), begin_(u32(4)), entries_(u16(begin_))
    {
    }

    bool little() const { return little_; }

    // Where an entry begins; 0 if there is none.
    size_t find(uint32_t tag) const
    {
        for (uint32_t i = 0; i < entries_; i++) {
            const size_t entry = begin_ + 2 + size_t{entry_size} * i;
            if (u16(entry) == tag)
                return entry;
        }
        return 0;
    }

    // The first value of an entry; `otherwise` if there is none.
    uint32_t value(uint32_t tag, uint32_t otherwise) const
    {
        const size_t entry = find(tag);
        if (entry == 0)
            return otherwise;
        const bool is_short = u16(entry + 2) == type_short;
        const bool elsewhere = u32(entry + 4) > (is_short ? 2 : 1); // values do not fit the entry
        const size_t at = elsewhere ? u32(entry + 8) : entry + 8;
        return is_short ? u16(at) : u32(at);
    }

  private:
    uint32_t u16(size_t at) const { return little_ ? file_.le16(at) : file_.be16(at); }
    uint32_t u32(size_t at) const { return little_ ? file_.le32(at) : file_.be32(at); }

    const Bytes &file_;
    bool little_;
    size_t begin_;
    uint32_t entries_;
};

[[noreturn]] void refuse(const std::string &what)
{
    unsupported("is a TIFF picture " + what + "; convert it to 8-bit or 16-bit grey or RGB");
}

std::string name_of(uint32_t colours)
{
    switch (colours) {
    case cmyk:
        return "in CMYK, inks of print";
    case lab:
        return "in CIELab";
    case bayer:
        return "of a raw sensor";
    default:
        return "with colours of kind " + std::to_string(colours);
    }
}

void check_colours(const Directory &directory, uint32_t bits)
{
    const uint32_t colours = directory.value(tag::colours, black_is_zero);
    if (directory.find(tag::dng_version))
        refuse("of a raw sensor (DNG)");
    if (colours > palette && colours != ycbcr)
        refuse(name_of(colours));
    const uint32_t used = colours == rgb || colours == ycbcr ? 3 : 1;
    const uint32_t channels = directory.value(tag::channels, 1);
    if (channels < used || channels > used + 1)
        refuse("with " + std::to_string(channels) + " channels");

    // libtiff makes 8 bits of any pixels, but OpenCV takes those of 16 bits as they lie.
    const bool as_they_lie = (colours == rgb || (colours == black_is_zero && channels == 1)) &&
                             (channels == 1 || directory.value(tag::planes, 1) == 1);
    if (bits == 16 && !as_they_lie)
        refuse(colours == white_is_zero ? "of 16 bits where white is 0"
               : channels == 2          ? "of 16-bit grey with transparency"
                                        : "of 16 bits in planes or with a palette");
}

void check_depth(const Directory &directory, uint32_t bits)
{
    constexpr uint32_t is_unsigned = 1;
    if (directory.value(tag::sample_format, is_unsigned) != is_unsigned)
        refuse("of signed or floating-point numbers");
    if (bits != 1 && bits != 4 && bits != 8 && bits != 16)
        refuse("of " + std::to_string(bits) + " bits a channel");
}

// Tiles are allocated whole, so they count as the picture does.
void check_tiles(const Directory &directory)
{
    const uint32_t width = directory.value(tag::tile_width, 0);
    const uint32_t height = directory.value(tag::tile_height, 0);
    if (width > VDNA_IMAGE_SIDE_MAX || height > VDNA_IMAGE_SIDE_MAX ||
        width * height > VDNA_IMAGE_PIXELS_MAX)
        unsupported("a TIFF file with tiles too large");
}

// One value of 16 bits, whatever the entry held.
void set_short(std::vector<uint8_t> &file, const Directory &directory, uint32_t tag, uint8_t value)
{
    const size_t entry = directory.find(tag);
    if (entry == 0)
        return;
    const uint8_t little[] = {type_short, 0, 1, 0, 0, 0, value, 0, 0, 0};
    const uint8_t big[] = {0, type_short, 0, 0, 0, 1, 0, value, 0, 0};
    std::memcpy(&file[entry + 2], directory.little() ? little : big, sizeof little);
}

} // namespace

Header tiff_header(const Bytes &file)
{
    const Directory directory(file);
    const uint32_t bits = directory.value(tag::bits, 1);
    check_tiles(directory);
    check_depth(directory, bits);
    check_colours(directory, bits);
    return {directory.value(tag::width, 0), directory.value(tag::height, 0),
            vdna_exif_orientation(file.data(), file.size())};
}

std::vector<uint8_t> plain_tiff(const Bytes &file)
{
    // libtiff multiplies colours by a transparency of the other kind.
    constexpr uint8_t multiplied_already = 1;
    std::vector<uint8_t> plain(file.data(), file.data() + file.size());
    const Directory directory(file);
    set_short(plain, directory, tag::orientation, VDNA_UPRIGHT);
    set_short(plain, directory, tag::extra, multiplied_already);
    return plain;
}

} // namespace vdna::picture
