// The bridge for test_table.py: the labels of the pictures of a folder by many tables.
//
//     table_labels TABLE FOLDER PICTURE... <CASES
//
// CASES: for each case its length, 4 bytes little-endian, and its bytes, which become the file
// TABLE. Prints a line for each: "refused", or the note and, for each picture, a tab and its utime,
// place, position, position_frame and whether it lacks truth.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <vector>

#include <vdna/cpp/error.hpp>

#include "frames/labels.hpp"

using vdna::frames::Label;
using vdna::frames::Labels;

namespace
{

constexpr uint64_t frame_index = 5; // of every picture, for tables with the column frame

bool read_case(std::string &out_text)
{
    unsigned char length[4];
    if (std::fread(length, 1, 4, stdin) != 4)
        return false;
    out_text.resize(length[0] | static_cast<size_t>(length[1]) << 8 |
                    static_cast<size_t>(length[2]) << 16);
    return std::fread(out_text.data(), 1, out_text.size(), stdin) == out_text.size();
}

std::string text_of(const Label &label)
{
    std::string text = (label.utime ? std::to_string(*label.utime) : "-") + " " +
                       (label.place ? std::to_string(*label.place) : "-");
    for (size_t axis = 0; axis < 3; axis++) {
        char number[64] = " -";
        if (label.position)
            std::snprintf(number, sizeof number, " %.17g", (*label.position)[axis]);
        text += number;
    }
    return text + " " + (label.position ? label.position_frame : "-") + " " +
           std::to_string(label.lacks_truth);
}

std::string line_of(const std::filesystem::path &csv,
                    const std::vector<std::filesystem::path> &pictures)
{
    try {
        const Labels labels(csv);
        std::string line = labels.note();
        for (const std::filesystem::path &picture : pictures)
            line += "\t" + text_of(labels.find(picture, frame_index));
        return line;
    } catch (const vdna::Error &) {
        return "refused";
    }
}

} // namespace

int main(int argc, char **argv)
{
    std::vector<std::filesystem::path> pictures;
    for (int i = 3; i < argc; i++)
        pictures.push_back(std::filesystem::path(argv[2]) / argv[i]);
    for (std::string text; read_case(text);) {
        std::ofstream(argv[1], std::ios::binary) << text;
        std::cout << line_of(argv[1], pictures) << '\n';
    }
    return std::cout.flush() ? 0 : 1;
}
