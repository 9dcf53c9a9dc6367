// The kinds of picture files: which we read, which we know but do not read, by content and by name.
#pragma once

#include <array>
#include <string_view>

#include "picture/files/bytes.hpp"

namespace vdna::picture
{

// Besides JPEG, which needs no conversion.
enum class Kind { png, webp, bmp, pnm, tiff };

// By the signature; the name of a file does not count. Throws Failure, VDNA_ERR_UNSUPPORTED, which
// names the kind of any other picture that we know.
Kind kind_of(const Bytes &file);

// Endings of the names of picture files that we read, and of known ones that we do not; lower case,
// with the dot. The first group of a kind is the usual one.
inline constexpr std::array<std::string_view, 14> file_endings = {
    ".jpg", ".jpeg", ".jpe",  ".jfif", ".png", ".webp", ".bmp",
    ".dib", ".tif",  ".tiff", ".ppm",  ".pgm", ".pbm",  ".pnm"};
inline constexpr std::array<std::string_view, 28> unreadable_endings = {
    ".gif", ".heic", ".heif", ".hif", ".avif", ".jxl", ".jp2", ".j2k", ".jpx", ".exr",
    ".hdr", ".pam",  ".pfm",  ".tga", ".psd",  ".ico", ".svg", ".dng", ".cr2", ".cr3",
    ".nef", ".nrw",  ".arw",  ".raf", ".orf",  ".rw2", ".pef", ".srw"};

} // namespace vdna::picture
