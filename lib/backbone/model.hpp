// ONNX files: read once, and only the very bytes that were pinned.
#pragma once

#include <filesystem>
#include <string>

namespace vdna
{

// The bytes of a model whose SHA-256 is `sha256` and which needs no other file.
// Throws Failure (VDNA_ERR_IO, VDNA_ERR_CHECKSUM, VDNA_ERR_UNSUPPORTED).
std::string read_model(const std::filesystem::path &file, const std::string &sha256);

} // namespace vdna
