// Figures as PDF (ISO 32000-1): one page of vectors, pictures, and text in Helvetica, which every
// reader of PDF has.
#include <algorithm>

#include "program/print.hpp"
#include "report/figure.hpp"

namespace vdna::report
{

namespace
{

std::string number(double value)
{
    return program::fixed(value, 2) + " ";
}

std::string colour_of(const Colour &colour, const char *operation)
{
    return number(colour.red / 255.0) + number(colour.green / 255.0) + number(colour.blue / 255.0) +
           operation + "\n";
}

// The code point that begins at `at`, which moves on; 0xfffd for what is not UTF-8.
uint32_t next_code_point(const std::string &text, size_t &at)
{
    const auto byte = [&](size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const uint32_t first = byte(at++);
    const size_t more = first < 0x80 ? 0 : first >> 5 == 6 ? 1 : first >> 4 == 14 ? 2 : 3;
    uint32_t point = more == 0 ? first : first & (0x3fu >> more);
    if (first >> 6 == 2 || first >= 0xf8)
        return 0xfffd;
    for (size_t i = 0; i < more; i++) {
        if (byte(at) >> 6 != 2)
            return 0xfffd;
        point = point << 6 | (byte(at++) & 0x3f);
    }
    return point;
}

// A byte of Windows-1252, PDF's WinAnsiEncoding.
char win_ansi(uint32_t point)
{
    if ((point >= ' ' && point <= '~') || (point >= 0xa0 && point <= 0xff))
        return static_cast<char>(point);
    switch (point) {
    case 0x2013:
        return '\x96'; // en dash
    case 0x2014:
        return '\x97'; // em dash
    case 0x2026:
        return '\x85'; // ellipsis
    default:
        return '?';
    }
}

// A literal string.
std::string literal(const std::string &text)
{
    std::string bytes = "(";
    for (size_t at = 0; at < text.size();) {
        const char c = win_ansi(next_code_point(text, at));
        if (c == '(' || c == ')' || c == '\\')
            bytes += '\\';
        bytes += c;
    }
    return bytes + ")";
}

uint32_t big_endian(const std::vector<uint8_t> &bytes, size_t at)
{
    return uint32_t{bytes[at]} << 24 | uint32_t{bytes[at + 1]} << 16 |
           uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

// The compressed pixels of a PNG, which PDF takes as they are.
std::string compressed_pixels(const std::vector<uint8_t> &png)
{
    std::string pixels;
    for (size_t at = 8; at + 12 <= png.size();) {
        const uint32_t length = big_endian(png, at);
        if (std::equal(png.begin() + static_cast<std::ptrdiff_t>(at) + 4,
                       png.begin() + static_cast<std::ptrdiff_t>(at) + 8, "IDAT"))
            pixels.append(reinterpret_cast<const char *>(&png[at + 8]), length);
        at += size_t{12} + length;
    }
    return pixels;
}

// The numbered objects of a file, from 1.
class PdfObjects
{
  public:
    size_t add(const std::string &body)
    {
        offsets_.push_back(bytes_.size());
        bytes_ += std::to_string(offsets_.size()) + " 0 obj\n" + body + "\nendobj\n";
        return offsets_.size();
    }

    size_t add_stream(const std::string &entries, const std::string &data)
    {
        return add("<<" + entries + "/Length " + std::to_string(data.size()) + ">>\nstream\n" +
                   data + "\nendstream");
    }

    std::string file(size_t catalog) const
    {
        std::string bytes = bytes_;
        const std::string size = std::to_string(offsets_.size() + 1);
        bytes += "xref\n0 " + size + "\n0000000000 65535 f \n";
        for (const size_t offset : offsets_) {
            const std::string digits = std::to_string(offset);
            bytes += std::string(10 - digits.size(), '0') + digits + " 00000 n \n";
        }
        return bytes + "trailer\n<</Size " + size + "/Root " + std::to_string(catalog) +
               " 0 R>>\nstartxref\n" + std::to_string(bytes_.size()) + "\n%%EOF\n";
    }

  private:
    std::string bytes_ = "%PDF-1.4\n%\xe2\xe3\xcf\xd3\n"; // the second line says that it is binary
    std::vector<size_t> offsets_;
};

// Draws items into a page's content, and puts pictures into objects.
class PdfDrawer
{
  public:
    PdfDrawer(double height, PdfObjects &objects) : height_(height), objects_(objects) {}

    void operator()(const Line &line)
    {
        content_ += colour_of(line.colour, "RG") + number(line.width) + "w 0 J " +
                    (line.dashed ? "[4] 0 d\n" : "[] 0 d\n");
        for (size_t i = 0; i < line.spots.size(); i++)
            content_ += spot(line.spots[i].x, line.spots[i].y) + (i == 0 ? "m\n" : "l\n");
        content_ += "S\n";
    }

    void operator()(const Box &box)
    {
        content_ += colour_of(box.colour, box.filled ? "rg" : "RG") + "1 w [] 0 d " +
                    spot(box.x, box.y + box.height) + number(box.width) + number(box.height) +
                    (box.filled ? "re f\n" : "re S\n");
    }

    void operator()(const Marks &marks)
    {
        const double width = marks.shape == Shape::dot ? 2 * marks.radius : 0.6 * marks.radius;
        std::string drawn;
        for (const Spot &at : marks.spots)
            drawn += mark(marks, at);
        if (marks.halo)
            content_ += colour_of({255, 255, 255}, "RG") + number(width + 1.2) + "w 1 J [] 0 d\n" +
                        drawn + "S\n";
        content_ +=
            colour_of(marks.colour, "RG") + number(width) + "w 1 J [] 0 d\n" + drawn + "S\n";
    }

    void operator()(const Text &text)
    {
        const double shift = text.anchor == Anchor::start    ? 0
                             : text.anchor == Anchor::middle ? text_width(text) / 2
                                                             : text_width(text);
        const double x = text.upwards ? text.x : text.x - shift;
        const double y = text.upwards ? text.y + shift : text.y;
        content_ += "BT " + colour_of(text.colour, "rg") + (text.bold ? "/B " : "/F ") +
                    number(text.size) + "Tf " + (text.upwards ? "0 1 -1 0 " : "1 0 0 1 ") +
                    spot(x, y) + "Tm " + literal(text.text) + " Tj ET\n";
    }

    void operator()(const Raster &raster)
    {
        const std::string entries = "/Type/XObject/Subtype/Image/BitsPerComponent 8/Width " +
                                    std::to_string(raster.columns) + "/Height " +
                                    std::to_string(raster.rows);
        const size_t object =
            raster.is_jpeg
                ? objects_.add_stream(entries + "/ColorSpace/DeviceRGB/Filter/DCTDecode",
                                      {raster.bytes.begin(), raster.bytes.end()})
                : objects_.add_stream(
                      entries +
                          "/ColorSpace/DeviceGray/Filter/FlateDecode/DecodeParms<</Predictor "
                          "15/Colors 1/BitsPerComponent 8/Columns " +
                          std::to_string(raster.columns) + ">>",
                      compressed_pixels(raster.bytes));
        const std::string name = "/I" + std::to_string(object);
        pictures_ += name + " " + std::to_string(object) + " 0 R";
        content_ += "q " + number(raster.width) + "0 0 " + number(raster.height) +
                    spot(raster.x, raster.y + raster.height) + "cm " + name + " Do Q\n";
    }

    const std::string &content() const { return content_; }
    const std::string &pictures() const { return pictures_; }

  private:
    // PDF's y goes upwards.
    std::string spot(double x, double y) const { return number(x) + number(height_ - y); }

    std::string mark(const Marks &marks, const Spot &at) const
    {
        const double r = marks.radius;
        const auto stroke = [&](double x1, double y1, double x2, double y2) {
            return spot(at.x + x1, at.y + y1) + "m " + spot(at.x + x2, at.y + y2) + "l\n";
        };
        if (marks.shape == Shape::dot)
            return stroke(0, 0, 0, 0);
        if (marks.shape == Shape::cross)
            return stroke(-r, -r, r, r) + stroke(-r, r, r, -r);
        constexpr double quarter = 0.5523; // of a circle, as a Bezier curve
        std::string ring = spot(at.x + r, at.y) + "m ";
        double x = r, y = 0;
        for (size_t i = 0; i < 4; i++) {
            const double next_x = -y, next_y = x;
            ring += spot(at.x + x + quarter * next_x, at.y + y + quarter * next_y) +
                    spot(at.x + next_x + quarter * x, at.y + next_y + quarter * y) +
                    spot(at.x + next_x, at.y + next_y) + "c\n";
            x = next_x;
            y = next_y;
        }
        return ring;
    }

    double height_;
    PdfObjects &objects_;
    std::string content_, pictures_;
};

size_t add_font(PdfObjects &objects, const char *name)
{
    return objects.add(std::string("<</Type/Font/Subtype/Type1/BaseFont/") + name +
                       "/Encoding/WinAnsiEncoding>>");
}

std::string reference(size_t object)
{
    return " " + std::to_string(object) + " 0 R";
}

} // namespace

std::string pdf_file(const Figure &figure)
{
    PdfObjects objects;
    PdfDrawer drawer(figure.height, objects);
    for (const Item &item : figure.items)
        std::visit([&](const auto &drawn) { drawer(drawn); }, item);
    const size_t font = add_font(objects, "Helvetica"), bold = add_font(objects, "Helvetica-Bold");
    const size_t content = objects.add_stream("", drawer.content());
    // The page names its parent, which is the next object but one.
    const size_t page = content + 1, pages = page + 1;
    objects.add("<</Type/Page/Parent" + reference(pages) + "/MediaBox[0 0 " + number(figure.width) +
                number(figure.height) + "]/Contents" + reference(content) +
                "/Resources<</Font<</F" + reference(font) + "/B" + reference(bold) +
                ">>/XObject<<" + drawer.pictures() + ">>>>>>");
    objects.add("<</Type/Pages/Count 1/Kids[" + reference(page) + "]>>");
    return objects.file(objects.add("<</Type/Catalog/Pages" + reference(pages) + ">>"));
}

} // namespace vdna::report
