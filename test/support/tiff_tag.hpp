// Entries of TIFF files for tests.
#pragma once

#include <cstdint>
#include <vector>

// A little-endian TIFF file, as OpenCV writes it, with one more entry, or another value of one that
// there is: a single number of 16 bits. Its directory moves to the end.
inline std::vector<uint8_t> tiff_with(std::vector<uint8_t> file, uint16_t tag, uint16_t value)
{
    const auto u16 = [&](size_t at) { return static_cast<uint16_t>(file[at] | file[at + 1] << 8); };
    const auto put = [&](uint32_t number, size_t bytes) {
        for (size_t i = 0; i < bytes; i++)
            file.push_back(static_cast<uint8_t>(number >> 8 * i));
    };
    const auto put_entry = [&] {
        put(tag, 2);
        put(3, 2);
        put(1, 4);
        put(value, 4);
    };
    file.resize(file.size() + file.size() % 2);
    const size_t old = u16(4) | static_cast<size_t>(u16(6)) << 16, entries = u16(old);
    const auto begin = static_cast<uint32_t>(file.size());
    put(0, 2);
    uint16_t written = 0;
    bool done = false;
    for (size_t i = 0; i <= entries; i++) { // tags ascend
        const size_t entry = old + 2 + 12 * i;
        if (!done && (i == entries || u16(entry) >= tag)) {
            put_entry();
            written++;
            done = true;
        }
        if (i == entries || u16(entry) == tag)
            continue;
        for (size_t byte = 0; byte < 12; byte++)
            file.push_back(static_cast<uint8_t>(file[entry + byte]));
        written++;
    }
    put(0, 4);
    for (size_t i = 0; i < 4; i++)
        file[4 + i] = static_cast<uint8_t>(begin >> 8 * i);
    file[begin] = static_cast<uint8_t>(written);
    return file;
}
