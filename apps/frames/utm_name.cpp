#include "frames/utm_name.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include <time.h>

namespace vdna::frames
{

namespace
{

constexpr size_t time_field = 12;

// The texts between the '@' of a name.
std::vector<std::string> fields_of(const std::filesystem::path &file)
{
    const std::string name = file.filename().string();
    // Without a last '@' the last field ends where the ending begins.
    const bool closed = !file.stem().empty() && file.stem().string().back() == '@';
    const std::string text = closed ? name : file.stem().string() + '@';
    std::vector<std::string> fields;
    for (size_t at = 0, next; (next = text.find('@', at + 1)) != std::string::npos; at = next)
        fields.push_back(text.substr(at + 1, next - at - 1));
    return fields;
}

// 123 for digits 4..6 of "2024061230".
int part(const std::string &digits, size_t at, size_t length)
{
    return std::stoi(digits.substr(at, length));
}

std::optional<int64_t> calendar_stamp(const std::string &digits)
{
    tm date{};
    date.tm_year = part(digits, 0, 4) - 1900;
    date.tm_mon = part(digits, 4, 2) - 1;
    date.tm_mday = part(digits, 6, 2);
    date.tm_hour = part(digits, 8, 2);
    date.tm_min = part(digits, 10, 2);
    date.tm_sec = part(digits, 12, 2);
    if (date.tm_year < 70 || date.tm_mon < 0 || date.tm_mon > 11 || date.tm_mday < 1 ||
        date.tm_mday > 31 || date.tm_hour > 23 || date.tm_min > 59 || date.tm_sec > 60)
        return {};
    return int64_t{timegm(&date)} * 1000000;
}

} // namespace

bool is_utm_name(const std::filesystem::path &file)
{
    return file.filename().string().front() == '@';
}

UtmName utm_name_of(const std::filesystem::path &file)
{
    std::vector<std::string> fields = fields_of(file);
    fields.resize(std::max(fields.size(), time_field + 1));
    return {fields[0], fields[1], fields[2], fields[time_field]};
}

std::optional<int64_t> stamp_of(const std::string &time)
{
    if (time.size() < 9 || time.find_first_not_of("0123456789") != std::string::npos)
        return {};
    if (time.size() == 14)
        return calendar_stamp(time);
    int64_t stamp = 0;
    if (std::from_chars(time.data(), time.data() + time.size(), stamp).ec != std::errc())
        return {};
    return stamp;
}

} // namespace vdna::frames
