// A figure as data, and the ways to draw it. Lengths are in units of 1/72 inch, y downwards.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace vdna::report
{

// role: name of the page's colour that is shown instead in the page, in light or dark; "" = none.
struct Colour {
    uint8_t red, green, blue;
    const char *role = "";
};

// Okabe and Ito's green and vermilion: colour-blind people can tell them apart, and the shapes
// differ as well.
constexpr Colour ink = {28, 33, 39, "ink"}, faint = {91, 101, 112, "faint"},
                 grid = {212, 217, 223, "line"}, paper = {255, 255, 255, "paper"},
                 right_colour = {0, 158, 115}, wrong_colour = {213, 94, 0},
                 unknown_colour = {140, 140, 140}, chosen_colour = {0, 114, 178},
                 best_colour = {86, 60, 140};

// "#1c2127"
std::string hex_of(const Colour &colour);

struct Spot {
    double x, y;
};

// A polyline.
struct Line {
    std::vector<Spot> spots;
    Colour colour;
    double width = 1;
    bool dashed = false;
    std::string label{}; // tooltip
};

struct Box {
    double x, y, width, height;
    Colour colour;
    bool filled = true;
};

enum class Shape { dot, ring, cross };

// Marks of one kind. halo: with a light edge, to be seen on any background.
struct Marks {
    Shape shape;
    double radius;
    Colour colour;
    std::vector<Spot> spots;
    bool halo = false;
    std::string label{}; // tooltip
};

enum class Anchor { start, middle, end };

struct Text {
    double x, y; // of the baseline
    std::string text;
    Anchor anchor = Anchor::start;
    Colour colour = faint;
    bool bold = false;
    bool upwards = false; // turned to be read from below
    double size = 11;
};

// A picture file scaled into a box.
struct Raster {
    double x, y, width, height;
    std::vector<uint8_t> bytes; // a JPEG with three colours, or a PNG with one
    bool is_jpeg;
    int columns, rows; // pixels
};

using Item = std::variant<Line, Box, Marks, Text, Raster>;

struct Figure {
    std::string name;  // of its files, before it is made portable: "difference-winter"
    std::string title; // what it shows, for those who cannot see it
    double width, height;
    std::vector<Item> items{}; // later ones over earlier ones
    std::string caption{};     // "" = none
};

// The items of one figure in another, moved by x and y.
void place(const Figure &part, double x, double y, Figure &whole);

// Parts in rows of at most `width`, one below another; a part wider than that has a row of its own.
Figure arranged(const std::string &name, const std::string &title, const std::vector<Figure> &parts,
                double width);

// Width of a text in units, as PDF and SVG show it, roughly.
double text_width(const Text &text);
// What to leave for it, as other fonts are wider.
double text_room(const Text &text);

// At most `most` characters of UTF-8, the last of them "…" if there were more.
std::string shortened(const std::string &text, size_t most);

// An <svg> element for the page.
std::string svg_element(const Figure &figure);

// An SVG file.
std::string svg_file(const Figure &figure);

// A PDF file of one page. Characters beyond Windows-1252 are shown as '?'.
std::string pdf_file(const Figure &figure);

// A PNG file. Characters beyond ASCII are shown as '?'. scale: pixels per unit.
std::string png_file(const Figure &figure, double scale);

// Base64, as in data: addresses.
std::string base64(const std::vector<uint8_t> &bytes);

} // namespace vdna::report
