// Tracks of GPX files.
#include <charconv>

#include <pugixml.hpp>

#include <vdna/cpp/error.hpp>

#include "frames/iso_time.hpp"
#include "frames/track_file.hpp"

namespace vdna::frames
{

namespace
{

pugi::xml_document load(const std::filesystem::path &path)
{
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_file(path.c_str());
    if (result.status == pugi::status_file_not_found || result.status == pugi::status_io_error)
        throw Error(path.string() + ": cannot read this file, expected a GPX track");
    if (!result)
        throw Error(path.string() + ": damaged at byte " + std::to_string(result.offset) + ": " +
                    result.description() + "; export the track again");
    if (!document.child("gpx"))
        throw Error(path.string() + ": the outermost element is '" +
                    document.document_element().name() + "', expected a GPX file, whose is 'gpx'");
    return document;
}

std::string trimmed(const char *text)
{
    const std::string blanks = " \t\r\n", all = text;
    const size_t begin = all.find_first_not_of(blanks);
    return begin == all.npos ? "" : all.substr(begin, all.find_last_not_of(blanks) - begin + 1);
}

class GpxReader
{
  public:
    explicit GpxReader(const std::filesystem::path &path)
        : path_(path.string()), document_(load(path))
    {
    }

    TrackFile read()
    {
        const pugi::xml_node gpx = document_.child("gpx");
        for (const pugi::xml_node track : gpx.children("trk"))
            for (const pugi::xml_node segment : track.children("trkseg"))
                for (const pugi::xml_node point : segment.children("trkpt"))
                    take(point);
        if (file_.fixes.empty())
            throw Error(path_ + ": has " + std::to_string(file_.unplaced) +
                        " track points, none of them with a time; expected a track that was "
                        "recorded, not a planned route");
        return std::move(file_);
    }

  private:
    void take(const pugi::xml_node &point)
    {
        const std::string time = trimmed(point.child_value("time"));
        if (time.empty()) {
            file_.unplaced++;
            return;
        }
        const std::optional<int64_t> utime = utime_of_iso(time);
        if (!utime)
            fail(point, "time", time, "a time such as 2024-05-01T12:00:00Z");
        Fix fix{*utime,
                number(point, "lat", point.attribute("lat").value()),
                number(point, "lon", point.attribute("lon").value()),
                {}};
        if (const pugi::xml_node height = point.child("ele"))
            fix.alt = number(point, "ele", height.child_value());
        file_.fixes.push_back(fix);
    }

    double number(const pugi::xml_node &point, const char *what, const char *text) const
    {
        const std::string digits = trimmed(text);
        const char *end = digits.data() + digits.size();
        double value = 0;
        const auto result = std::from_chars(digits.data(), end, value);
        if (result.ec != std::errc() || result.ptr != end)
            fail(point, what, digits, "a decimal number");
        return value;
    }

    [[noreturn]] void fail(const pugi::xml_node &point, const char *what, const std::string &found,
                           const char *expected) const
    {
        throw Error(path_ + ": the track point at byte " + std::to_string(point.offset_debug()) +
                    ": " + what + " is '" + found + "', expected " + expected);
    }

    std::string path_;
    pugi::xml_document document_;
    TrackFile file_;
};

} // namespace

TrackFile read_gpx(const std::filesystem::path &path)
{
    return GpxReader(path).read();
}

} // namespace vdna::frames
