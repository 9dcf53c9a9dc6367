#include "report/figure.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace vdna::report
{

namespace
{

constexpr double gap = 12; // between parts

// Of Helvetica, in thousandths of the size, from ' ' to '~'.
constexpr std::array<uint16_t, 95> widths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};
constexpr uint16_t usual_width = 556;
constexpr double bold_factor = 1.07;

bool begins_character(char c)
{
    return (static_cast<unsigned char>(c) & 0xc0u) != 0x80;
}

struct Mover {
    double x, y;

    void move(std::vector<Spot> &spots) const
    {
        for (Spot &spot : spots)
            spot = {spot.x + x, spot.y + y};
    }
    void operator()(Line &line) const { move(line.spots); }
    void operator()(Marks &marks) const { move(marks.spots); }
    template <typename Placed>
    void operator()(Placed &item) const
    {
        item.x += x;
        item.y += y;
    }
};

} // namespace

std::string hex_of(const Colour &colour)
{
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
    return text;
}

void place(const Figure &part, double x, double y, Figure &whole)
{
    for (Item item : part.items) {
        std::visit(Mover{x, y}, item);
        whole.items.push_back(std::move(item));
    }
}

Figure arranged(const std::string &name, const std::string &title, const std::vector<Figure> &parts,
                double width)
{
    Figure whole{name, title, 0, 0};
    double x = 0, y = 0, row_height = 0;
    for (const Figure &part : parts) {
        if (x > 0 && x + part.width > width) {
            x = 0;
            y += row_height + gap;
            row_height = 0;
        }
        place(part, x, y, whole);
        row_height = std::max(row_height, part.height);
        whole.width = std::max(whole.width, x + part.width);
        whole.height = y + row_height;
        x += part.width + gap;
    }
    return whole;
}

double text_width(const Text &text)
{
    double width = 0;
    for (const char c : text.text)
        if (c >= ' ' && c <= '~')
            width += widths[static_cast<size_t>(c - ' ')];
        else if (begins_character(c))
            width += usual_width;
    return width / 1000 * text.size * (text.bold ? bold_factor : 1);
}

double text_room(const Text &text)
{
    return 1.15 * text_width(text);
}

std::string shortened(const std::string &text, size_t most)
{
    size_t characters = 0, keep = 0;
    for (size_t i = 0; i < text.size(); i++) {
        if (!begins_character(text[i]))
            continue;
        characters++;
        if (characters == most)
            keep = i;
        if (characters > most)
            return text.substr(0, keep) + "\u2026";
    }
    return text;
}

std::string base64(const std::vector<uint8_t> &bytes)
{
    const char *digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = std::min<size_t>(bytes.size() - i, 3);
        uint32_t three = 0;
        for (size_t j = 0; j < 3; j++)
            three = three << 8 | (j < left ? bytes[i + j] : 0u);
        for (size_t j = 0; j < 4; j++)
            text += j <= left ? digits[three >> (18 - 6 * j) & 63] : '=';
    }
    return text;
}

} // namespace vdna::report
