#include "frames/mcap_chunk.hpp"

#include <array>

#include <lz4frame.h>
#include <zstd.h>

namespace vdna::frames
{

namespace
{

struct Free {
    void operator()(LZ4F_dctx *context) const { LZ4F_freeDecompressionContext(context); }
};

std::unique_ptr<LZ4F_dctx, Free> lz4_context()
{
    LZ4F_dctx *context = nullptr;
    LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
    return std::unique_ptr<LZ4F_dctx, Free>(context);
}

// Memory that costs nothing until it is written: sizes may be lies.
std::unique_ptr<uint8_t[]> unwritten(uint64_t size)
{
    return std::unique_ptr<uint8_t[]>(new uint8_t[size]);
}

std::array<uint32_t, 256> crc32_table()
{
    std::array<uint32_t, 256> table{};
    for (uint32_t i = 0; i < table.size(); i++) {
        uint32_t rest = i;
        for (int bit = 0; bit < 8; bit++)
            rest = (rest & 1) != 0 ? rest >> 1 ^ 0xEDB88320u : rest >> 1;
        table[i] = rest;
    }
    return table;
}

} // namespace

std::unique_ptr<uint8_t[]> unpack_lz4(Stretch packed, uint64_t size)
{
    const auto context = lz4_context();
    std::unique_ptr<uint8_t[]> bytes = unwritten(size);
    size_t made = size, taken = packed.size;
    // One call does all: the memory for all of it is there.
    if (!context ||
        LZ4F_decompress(context.get(), bytes.get(), &made, packed.data, &taken, nullptr) != 0)
        return nullptr;
    return made == size && taken == packed.size ? std::move(bytes) : nullptr;
}

std::unique_ptr<uint8_t[]> unpack_zstd(Stretch packed, uint64_t size)
{
    std::unique_ptr<uint8_t[]> bytes = unwritten(size);
    const size_t made = ZSTD_decompress(bytes.get(), size, packed.data, packed.size);
    return made == size ? std::move(bytes) : nullptr;
}

uint32_t crc32_of(Stretch bytes)
{
    static const std::array<uint32_t, 256> table = crc32_table();
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < bytes.size; i++)
        crc = crc >> 8 ^ table[(crc ^ bytes.data[i]) & 0xFF];
    return ~crc;
}

} // namespace vdna::frames
