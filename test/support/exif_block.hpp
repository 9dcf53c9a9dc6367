// EXIF blocks for tests, and files that hold them.
#pragma once

#include <cstdint>
#include <iterator>
#include <vector>

// A block that states one orientation, as a TIFF file of either byte order.
inline std::vector<uint8_t> exif_block(uint8_t orientation, bool little = false)
{
    if (little)
        return {'I', 'I', 42, 0, 8, 0,           0, 0, 1, 0, 0x12, 1, 3,
                0,   1,   0,  0, 0, orientation, 0, 0, 0, 0, 0,    0, 0};
    return {'M', 'M', 0, 42, 0, 0, 0,           8, 0, 1, 1, 0x12, 0,
            3,   0,   0, 0,  1, 0, orientation, 0, 0, 0, 0, 0,    0};
}

// A JPEG picture with a segment APP1 of that block right at its beginning.
inline std::vector<uint8_t> jpeg_with_exif(std::vector<uint8_t> jpeg,
                                           const std::vector<uint8_t> &block)
{
    const size_t length = 2 + 6 + block.size();
    const uint8_t head[] = {0xFF,
                            0xE1,
                            static_cast<uint8_t>(length >> 8),
                            static_cast<uint8_t>(length),
                            'E',
                            'x',
                            'i',
                            'f',
                            0,
                            0};
    jpeg.insert(jpeg.begin() + 2, block.begin(), block.end());
    jpeg.insert(jpeg.begin() + 2, std::begin(head), std::end(head));
    return jpeg;
}
