// Numbers and stretches out of bytes that may lie about their lengths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace vdna::frames
{

// Bytes of someone else.
struct Stretch {
    const uint8_t *data = nullptr;
    size_t size = 0;
};

std::string text_of(Stretch bytes);

// Reads from the front. Beyond the end all numbers are 0, all stretches empty, and it is broken.
class ByteReader
{
  public:
    explicit ByteReader(Stretch bytes) : rest_(bytes) {}

    // An unsigned number of 1..8 bytes, the lowest first or the highest.
    uint64_t number(size_t size);
    uint64_t big_endian(size_t size);
    // An IEEE number of 8 bytes, the lowest first.
    double real();
    Stretch take(uint64_t size);
    // As many bytes as a number of 4 bytes before them says.
    Stretch counted() { return take(number(4)); }

    size_t rest() const { return rest_.size; }
    bool broken() const { return broken_; }
    void set_broken() { broken_ = true; }

  private:
    Stretch rest_;
    bool broken_ = false;
};

double real_of(uint64_t bits);

} // namespace vdna::frames
