// Decompression of the chunks of MCAP files.
#pragma once

#include <cstdint>
#include <memory>

#include "frames/byte_reader.hpp"

namespace vdna::frames
{

// Most bytes of a decompressed chunk: writers make them of 1 to 16 MiB.
constexpr uint64_t mcap_chunk_bytes_max = uint64_t{1} << 29;

// Exactly `size` bytes, at most mcap_chunk_bytes_max; NULL if the bytes give others.
std::unique_ptr<uint8_t[]> unpack_lz4(Stretch packed, uint64_t size);
std::unique_ptr<uint8_t[]> unpack_zstd(Stretch packed, uint64_t size);

// CRC-32 as zlib has it.
uint32_t crc32_of(Stretch bytes);

} // namespace vdna::frames
