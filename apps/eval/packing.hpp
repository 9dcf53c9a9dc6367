// Numbers as the bytes of a cache entry, in this machine's representation.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "eval/counts.hpp"

namespace vdna::eval
{

template <typename T>
void pack(std::string &bytes, const T *values, size_t count)
{
    bytes.append(reinterpret_cast<const char *>(values), count * sizeof(T));
}

// Counts, most of them small: seven bits a byte, lowest first; the eighth bit means that more
// follow.
inline void pack_counts(std::string &bytes, const std::vector<uint32_t> &counts)
{
    for (uint32_t count : counts) {
        for (; count >= 0x80; count >>= 7)
            bytes += static_cast<char>(count | 0x80);
        bytes += static_cast<char>(count);
    }
}

// The counts of a histogram, mass first.
inline void pack_counts(std::string &bytes, const Counts &counts)
{
    pack_counts(bytes, counts.mass);
    pack_counts(bytes, counts.counts);
}

// Reads values from bytes until they run out.
class Unpacker
{
  public:
    explicit Unpacker(const std::string &bytes) : bytes_(bytes) {}

    // False if fewer are left.
    template <typename T>
    bool take(T *values, uint64_t count)
    {
        if (count > (bytes_.size() - at_) / sizeof(T))
            return false;
        if (count > 0) // none have no address
            std::memcpy(values, bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return true;
    }

    template <typename T>
    bool take(std::vector<T> &values, uint64_t count)
    {
        if (count > (bytes_.size() - at_) / sizeof(T))
            return false;
        values.resize(count);
        return take(values.data(), count);
    }

    bool take_counts(std::vector<uint32_t> &counts, uint64_t count)
    {
        if (count > bytes_.size() - at_) // each takes at least a byte
            return false;
        counts.assign(count, 0);
        for (uint32_t &value : counts) {
            uint8_t byte = 0x80;
            for (int shift = 0; byte & 0x80; shift += 7) {
                if (shift > 28 || !take(&byte, 1))
                    return false;
                value |= (byte & 0x7fu) << shift;
            }
        }
        return true;
    }

    bool take_counts(Counts &counts, uint32_t neurons, uint32_t bins)
    {
        counts.bins = bins;
        return take_counts(counts.mass, neurons) &&
               take_counts(counts.counts, uint64_t{neurons} * bins);
    }

    bool at_end() const { return at_ == bytes_.size(); }

  private:
    const std::string &bytes_;
    size_t at_ = 0;
};

} // namespace vdna::eval
