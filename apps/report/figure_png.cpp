// Figures as PNG.
#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "report/figure.hpp"

namespace vdna::report
{

namespace
{

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr int fraction_bits = 4; // of coordinates, which OpenCV takes as integers

cv::Scalar bgr(const Colour &colour)
{
    return {static_cast<double>(colour.blue), static_cast<double>(colour.green),
            static_cast<double>(colour.red)};
}

class PngDrawer
{
  public:
    PngDrawer(cv::Mat &picture, double scale) : picture_(picture), scale_(scale) {}

    void operator()(const Line &line)
    {
        for (size_t i = 1; i < line.spots.size(); i++)
            stroke(line.spots[i - 1], line.spots[i], line.colour, line.width);
    }

    void operator()(const Box &box)
    {
        cv::rectangle(picture_, rectangle(box), bgr(box.colour),
                      box.filled ? static_cast<int>(cv::FILLED) : thickness(1), cv::LINE_8);
    }

    void operator()(const Marks &marks)
    {
        for (const Spot &at : marks.spots) {
            if (marks.halo)
                draw(marks, at, {255, 255, 255}, 0.6);
            draw(marks, at, marks.colour, 0);
        }
    }

    void operator()(const Text &text)
    {
        std::string ascii;
        for (const char c : text.text)
            if ((static_cast<unsigned char>(c) & 0xc0u) != 0x80)
                ascii += c >= ' ' && c <= '~' ? c : '?';
        int baseline = 0;
        double size = text.size * scale_ / 30;
        const int thick = text.bold ? thickness(0.8) : thickness(0.4);
        cv::Size box = cv::getTextSize(ascii, font, size, thick, &baseline);
        // Its letters are wider than those that the figure was laid out for.
        size *= std::min(1.0, text_width(text) * scale_ / std::max(box.width, 1));
        box = cv::getTextSize(ascii, font, size, thick, &baseline);
        cv::Mat written(box.height + 2 * baseline, box.width + 2, CV_8UC1, cv::Scalar(0));
        cv::putText(written, ascii, {0, box.height + baseline / 2}, font, size, cv::Scalar(255),
                    thick, cv::LINE_AA);
        const int shift = text.anchor == Anchor::start    ? 0
                          : text.anchor == Anchor::middle ? box.width / 2
                                                          : box.width;
        const int rise = box.height + baseline / 2; // above the baseline
        cv::Point at(static_cast<int>(text.x * scale_), static_cast<int>(text.y * scale_));
        if (text.upwards) {
            cv::rotate(written, written, cv::ROTATE_90_COUNTERCLOCKWISE);
            at -= cv::Point(rise, written.rows - shift);
        } else {
            at -= cv::Point(shift, rise);
        }
        const cv::Rect inside = cv::Rect(at, written.size()) & cv::Rect({0, 0}, picture_.size());
        if (!inside.empty())
            picture_(inside).setTo(bgr(text.colour), written(inside - at) > 90);
    }

    void operator()(const Raster &raster)
    {
        cv::Mat pixels = cv::imdecode(raster.bytes, cv::IMREAD_COLOR);
        const cv::Rect box = rectangle(raster);
        cv::resize(pixels, pixels, box.size(), 0, 0,
                   pixels.cols > box.width ? cv::INTER_AREA : cv::INTER_NEAREST);
        pixels.copyTo(picture_(box));
    }

  private:
    int thickness(double width) const
    {
        return std::max(1, static_cast<int>(std::lround(width * scale_)));
    }

    cv::Point fine(const Spot &at) const
    {
        const double unit = scale_ * (1 << fraction_bits);
        return {static_cast<int>(at.x * unit), static_cast<int>(at.y * unit)};
    }

    template <typename Placed>
    cv::Rect rectangle(const Placed &placed) const
    {
        const auto pixel = [&](double length) {
            return static_cast<int>(std::lround(length * scale_));
        };
        return cv::Rect(pixel(placed.x), pixel(placed.y), std::max(1, pixel(placed.width)),
                        std::max(1, pixel(placed.height))) &
               cv::Rect({0, 0}, picture_.size());
    }

    void stroke(const Spot &from, const Spot &to, const Colour &colour, double width)
    {
        cv::line(picture_, fine(from), fine(to), bgr(colour), thickness(width), cv::LINE_AA,
                 fraction_bits);
    }

    // edge: by how much larger than the mark.
    void draw(const Marks &marks, const Spot &at, const Colour &colour, double edge)
    {
        const double r = marks.radius;
        const double width = 0.6 * r + 2 * edge;
        if (marks.shape == Shape::cross) {
            stroke({at.x - r, at.y - r}, {at.x + r, at.y + r}, colour, width);
            stroke({at.x - r, at.y + r}, {at.x + r, at.y - r}, colour, width);
            return;
        }
        const bool is_dot = marks.shape == Shape::dot;
        const auto radius =
            static_cast<int>((r + (is_dot ? edge : 0)) * scale_ * (1 << fraction_bits));
        cv::circle(picture_, fine(at), radius, bgr(colour),
                   is_dot ? static_cast<int>(cv::FILLED) : thickness(width), cv::LINE_AA,
                   fraction_bits);
    }

    cv::Mat &picture_;
    double scale_;
};

} // namespace

std::string png_file(const Figure &figure, double scale)
{
    cv::Mat picture(static_cast<int>(std::ceil(figure.height * scale)),
                    static_cast<int>(std::ceil(figure.width * scale)), CV_8UC3,
                    cv::Scalar::all(255));
    PngDrawer drawer(picture, scale);
    for (const Item &item : figure.items)
        std::visit([&](const auto &drawn) { drawer(drawn); }, item);
    std::vector<uint8_t> bytes;
    cv::imencode(".png", picture, bytes);
    return {bytes.begin(), bytes.end()};
}

} // namespace vdna::report
