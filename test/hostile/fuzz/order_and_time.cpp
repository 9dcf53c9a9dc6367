// The bridge for test_order_and_time.py, line by line:
//
//     order NAME NAME ...          prints the names in natural order
//     time UNIT LATE STAMP ...     prints the unit at the end, and for each stamp what the time
//     axis
//                                  says and its microseconds, "2:1700000000000000"
//     name NAME                    prints the order field of a UTM name, and its stamp or "-"
#include <algorithm>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <vdna/camera_time.h>

#include "frames/natural_order.hpp"
#include "frames/utm_name.hpp"

namespace
{

std::string order(std::istringstream &words)
{
    std::vector<std::string> names;
    for (std::string name; words >> name;)
        names.push_back(name);
    std::sort(names.begin(), names.end(), vdna::frames::comes_before);
    std::string line;
    for (const std::string &name : names)
        line += name + " ";
    return line;
}

std::string time(std::istringstream &words)
{
    uint32_t unit = 0;
    int64_t late_us = 0;
    words >> unit >> late_us;
    vdna_camera_time axis;
    vdna_camera_time_init(&axis, unit, late_us);
    std::string line;
    for (int64_t stamp = 0; words >> stamp;) {
        int64_t utime = 0;
        const uint32_t what = vdna_camera_time_take(&axis, stamp, &utime);
        line += " " + std::to_string(what) + ":" + std::to_string(utime);
    }
    return std::to_string(axis.unit) + line;
}

std::string name(std::istringstream &words)
{
    std::string text;
    words >> text;
    const vdna::frames::UtmName parts = vdna::frames::utm_name_of(text);
    const std::optional<int64_t> stamp = vdna::frames::stamp_of(parts.time);
    return parts.time + " " + (stamp ? std::to_string(*stamp) : "-");
}

} // namespace

int main()
{
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string what;
        words >> what;
        std::cout << (what == "order"  ? order(words)
                      : what == "time" ? time(words)
                                       : name(words))
                  << '\n';
    }
}
