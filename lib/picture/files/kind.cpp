#include "picture/files/kind.hpp"

#include <cctype>

namespace vdna::picture
{

namespace
{

using namespace std::string_view_literals;

struct Signature {
    size_t offset;
    std::string_view bytes;
    const char *kind;
};

// Of files that people have in folders of pictures. The box "ftyp" of the MP4 family begins at 4.
constexpr Signature unreadable[] = {
    {0, "GIF8"sv, "GIF"},
    {4, "ftypheic"sv, "HEIC"},
    {4, "ftypheix"sv, "HEIC"},
    {4, "ftyphevc"sv, "HEIC"},
    {4, "ftypheim"sv, "HEIC"},
    {4, "ftypheis"sv, "HEIC"},
    {4, "ftypmif1"sv, "HEIF"},
    {4, "ftypmsf1"sv, "HEIF"},
    {4, "ftypavif"sv, "AVIF"},
    {4, "ftypavis"sv, "AVIF"},
    {4, "ftypcrx "sv, "CR3 raw"},
    {0, "\xff\x0a"sv, "JPEG XL"},
    {0, "\0\0\0\x0cJXL \r\n\x87\n"sv, "JPEG XL"},
    {0, "\0\0\0\x0cjP  \r\n\x87\n"sv, "JPEG 2000"},
    {0, "\xff\x4f\xff\x51"sv, "JPEG 2000"},
    {0, "v/1\x01"sv, "OpenEXR"},
    {0, "#?RADIANCE"sv, "Radiance HDR"},
    {0, "#?RGBE"sv, "Radiance HDR"},
    {0, "P7\n"sv, "PAM"},
    {0, "PF\n"sv, "PFM"},
    {0, "Pf\n"sv, "PFM"},
    {0, "8BPS"sv, "Photoshop"},
    {0, "II+\0"sv, "BigTIFF"},
    {0, "MM\0+"sv, "BigTIFF"},
    {8, "CR\x02"sv, "CR2 raw"},
    {0, "FUJIFILMCCD-RAW"sv, "RAF raw"},
    {0, "IIRO"sv, "ORF raw"},
    {0, "IIRS"sv, "ORF raw"},
    {0, "IIU\0"sv, "RW2 raw"},
};

bool is_pnm(const Bytes &file)
{
    return file.size() > 2 && file.byte(0) == 'P' && file.byte(1) >= '1' && file.byte(1) <= '6' &&
           std::isspace(static_cast<int>(file.byte(2)));
}

} // namespace

Kind kind_of(const Bytes &file)
{
    // First, because raw pictures may look like TIFF.
    for (const Signature &signature : unreadable)
        if (file.has(signature.offset, signature.bytes))
            unsupported(std::string("is a ") + signature.kind +
                        " picture, which cannot be read; convert it to JPEG or PNG");
    if (file.has(0, "\x89PNG\r\n\x1a\n"))
        return Kind::png;
    if (file.has(0, "RIFF") && file.has(8, "WEBP"))
        return Kind::webp;
    if (file.has(0, "BM"))
        return Kind::bmp;
    if (is_pnm(file))
        return Kind::pnm;
    if (file.has(0, "II*\0"sv) || file.has(0, "MM\0*"sv))
        return Kind::tiff;
    unsupported("is no JPEG, PNG, WebP, BMP, PNM or TIFF file");
}

} // namespace vdna::picture
