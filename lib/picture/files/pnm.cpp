#include "picture/files/pnm.hpp"

#include <cctype>

#include "picture/levels.hpp"

namespace vdna::picture
{

namespace
{

bool is_space(uint32_t byte)
{
    return std::isspace(static_cast<int>(byte));
}

bool is_digit(uint32_t byte)
{
    return byte >= '0' && byte <= '9';
}

void skip_space(const Bytes &file, size_t &at)
{
    for (; is_space(file.byte(at)) || file.byte(at) == '#'; at++)
        if (file.byte(at) == '#')
            while (file.byte(at) != '\n')
                at++;
}

// The number at `at`, after white space and comments; `at` moves behind it.
uint32_t number(const Bytes &file, size_t &at)
{
    skip_space(file, at);
    if (!is_digit(file.byte(at)))
        damaged("a PNM file must hold numbers");
    uint32_t value = 0;
    for (; at < file.size() && is_digit(file.byte(at)); at++) {
        value = value * 10 + file.byte(at) - '0';
        if (value > INT32_MAX / 10)
            damaged("a PNM file with a number of too many digits");
    }
    return value;
}

// Reads pixel after pixel.
class Pixels
{
  public:
    Pixels(const Bytes &file, const PnmHeader &header)
        : file_(file), header_(header), at_(header.pixels_at)
    {
    }

    // The next channel.
    uint32_t next(uint32_t x)
    {
        const uint32_t value = header_.text ? next_text() : next_byte(x);
        if (value > header_.white)
            damaged("a PNM file with a value of " + std::to_string(value) + ", beyond its white, " +
                    std::to_string(header_.white));
        return header_.bits ? 1 - value : value;
    }

  private:
    // A bit may follow the one before it without a space.
    uint32_t next_text()
    {
        if (!header_.bits)
            return number(file_, at_);
        skip_space(file_, at_);
        return file_.byte(at_++) - '0';
    }

    // Each row of bits begins with a byte.
    uint32_t next_byte(uint32_t x)
    {
        if (header_.bits)
            return file_.byte(x % 8 == 0 ? at_++ : at_ - 1) >> (7 - x % 8) & 1;
        const size_t at = at_;
        const bool wide = header_.white > UINT8_MAX;
        at_ += wide ? 2 : 1;
        return wide ? file_.be16(at) : file_.byte(at);
    }

    const Bytes &file_;
    const PnmHeader &header_;
    size_t at_;
};

} // namespace

PnmHeader pnm_header(const Bytes &file)
{
    const uint32_t digit =
        file.byte(1) - '0'; // 1, 2, 3: bits, grey, colour as text; 4, 5, 6: as bytes
    const uint32_t kind = (digit - 1) % 3;
    PnmHeader header{};
    header.text = digit <= 3;
    header.bits = kind == 0;
    header.channels = kind == 2 ? 3 : 1;
    size_t at = 2;
    header.width = number(file, at);
    header.height = number(file, at);
    header.white = header.bits ? 1 : number(file, at);
    if (header.white < 1 || header.white > white_of_16_bits)
        damaged("a PNM file whose white is " + std::to_string(header.white) +
                ", expected 1 to 65535");
    header.pixels_at = at + 1; // one white space
    return header;
}

void decode_pnm(const Bytes &file, const PnmHeader &header, cv::Mat &bgr)
{
    Pixels pixels(file, header);
    uint32_t used = 0;
    bgr.create(static_cast<int>(header.height), static_cast<int>(header.width), CV_8UC3);
    for (uint32_t y = 0; y < header.height; y++) {
        uint8_t *out = bgr.ptr(static_cast<int>(y));
        for (uint32_t x = 0; x < header.width; x++, out += 3)
            for (uint32_t channel = 0; channel < 3; channel++) {
                const bool grey = channel > 0 && header.channels == 1;
                const uint32_t value = grey ? 0 : pixels.next(x);
                used |= value;
                out[2 - channel] = grey ? out[2] : level_of(value, header.white);
            }
    }
    if (header.white == white_of_16_bits)
        require_depth(used);
}

} // namespace vdna::picture
