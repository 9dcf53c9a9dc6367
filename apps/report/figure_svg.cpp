// Figures as SVG.
#include "program/print.hpp"
#include "report/figure.hpp"
#include "report/html.hpp"

namespace vdna::report
{

namespace
{

std::string number(double value)
{
    std::string text = program::fixed(value, 1);
    return text.size() > 2 && text.substr(text.size() - 2) == ".0" ? text.substr(0, text.size() - 2)
                                                                   : text;
}

std::string attribute(const char *name, const std::string &value)
{
    return std::string(" ") + name + "=\"" + value + "\"";
}

// Draws items in the page's colours, or in fixed ones in a file of its own.
struct SvgDrawer {
    bool in_page;

    std::string paint(const char *name, const Colour &colour) const
    {
        if (in_page && *colour.role)
            return std::string(" style=\"") + name + ":var(--" + colour.role + ")\"";
        return attribute(name, hex_of(colour));
    }

    std::string path(const std::string &d, const Colour &colour, double width,
                     const std::string &more, const std::string &label) const
    {
        const std::string title = label.empty() ? "" : text_element("title", label);
        return "<path fill=\"none\"" + paint("stroke", colour) +
               attribute("stroke-width", number(width)) + more + attribute("d", d) + ">" + title +
               "</path>";
    }

    std::string operator()(const Line &line) const
    {
        std::string d;
        for (const Spot &spot : line.spots)
            d += (d.empty() ? "M" : "L") + number(spot.x) + " " + number(spot.y);
        return path(d, line.colour, line.width, line.dashed ? " stroke-dasharray=\"4\"" : "",
                    line.label);
    }

    std::string operator()(const Box &box) const
    {
        return "<rect" + attribute("x", number(box.x)) + attribute("y", number(box.y)) +
               attribute("width", number(box.width)) + attribute("height", number(box.height)) +
               (box.filled ? paint("fill", box.colour)
                           : " fill=\"none\"" + paint("stroke", box.colour)) +
               "/>";
    }

    std::string operator()(const Marks &marks) const
    {
        if (marks.spots.empty())
            return "";
        const std::string r = number(marks.radius), d = number(2 * marks.radius);
        const std::string arc = "a" + r + " " + r + " 0 1 0 ";
        const std::string drawn =
            marks.shape == Shape::dot ? "h0"
            : marks.shape == Shape::ring
                ? "m-" + r + " 0" + arc + d + " 0" + arc + "-" + d + " 0"
                : "m-" + r + " -" + r + "l" + d + " " + d + "m0 -" + d + "l-" + d + " " + d;
        const double width = marks.shape == Shape::dot ? 2 * marks.radius : 0.6 * marks.radius;
        std::string spots;
        for (const Spot &spot : marks.spots)
            spots += "M" + number(spot.x) + " " + number(spot.y) + drawn;
        const std::string round = " stroke-linecap=\"round\"";
        const std::string halo =
            marks.halo ? path(spots, {255, 255, 255}, width + 1.2, round, "") : "";
        return halo + path(spots, marks.colour, width, round, marks.label);
    }

    std::string operator()(const Text &text) const
    {
        const std::string x = number(text.x), y = number(text.y);
        static const char *const anchors[] = {"start", "middle", "end"};
        std::string tag = "text" + attribute("x", x) + attribute("y", y) +
                          attribute("font-size", number(text.size)) + paint("fill", text.colour);
        if (text.anchor != Anchor::start)
            tag += attribute("text-anchor", anchors[static_cast<size_t>(text.anchor)]);
        if (text.bold)
            tag += " font-weight=\"bold\"";
        if (text.upwards)
            tag += attribute("transform", "rotate(-90 " + x + " " + y + ")");
        return text_element(tag, text.text);
    }

    std::string operator()(const Raster &raster) const
    {
        return "<image" + attribute("x", number(raster.x)) + attribute("y", number(raster.y)) +
               attribute("width", number(raster.width)) +
               attribute("height", number(raster.height)) +
               " preserveAspectRatio=\"none\" style=\"image-rendering:" +
               (raster.is_jpeg ? "auto" : "pixelated") + "\" " + (in_page ? "href" : "xlink:href") +
               "=\"data:image/" + (raster.is_jpeg ? "jpeg" : "png") + ";base64," +
               base64(raster.bytes) + "\"/>";
    }
};

std::string drawn(const Figure &figure, bool in_page, const std::string &attributes)
{
    std::string svg;
    for (const Item &item : figure.items)
        svg += std::visit(SvgDrawer{in_page}, item);
    return element(
        "svg" + attributes +
            attribute("viewBox", "0 0 " + number(figure.width) + " " + number(figure.height)) +
            " role=\"img\"" + attribute("aria-label", escaped(figure.title)),
        svg);
}

} // namespace

std::string svg_element(const Figure &figure)
{
    return drawn(figure, true, "");
}

std::string svg_file(const Figure &figure)
{
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
           drawn(figure, false,
                 " xmlns=\"http://www.w3.org/2000/svg\" "
                 "xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
                 "font-family=\"Helvetica, Arial, sans-serif\"" +
                     attribute("width", number(figure.width) + "pt") +
                     attribute("height", number(figure.height) + "pt")) +
           "\n";
}

} // namespace vdna::report
