// vdna show - a frame of a map as a picture.
#include <cerrno>
#include <cstring>
#include <iostream>

#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <vdna/cpp/decoder.hpp>

#include "frames/iso_time.hpp"
#include "program/replaced_file.hpp"
#include "record/experiences.hpp"
#include "record/thumbnails.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct ShowOptions {
    std::string map, experience, output;
    uint32_t frame = 0;
    bool open = false;
};

const vdna_experience &find(const std::vector<Experience> &files, const ShowOptions &options)
{
    std::string names;
    for (const Experience &file : files) {
        if (file->name == options.experience)
            return *file.get();
        names += (names.empty() ? "" : ", ") + std::string(file->name);
    }
    throw Error(options.map + ": has no experience " + options.experience +
                ", expected one of: " + names);
}

struct Picture {
    std::string png;
    int width, height; // pixels
};

Picture picture_of(const vdna_experience &e, uint32_t frame)
{
    const std::string name = std::string(e.name) + ": frame " + std::to_string(frame);
    if (frame >= e.frames)
        throw Error(name + " is not there, expected 0 to " + std::to_string(e.frames - 1));
    const std::string_view jpeg = thumbnail_of(e, frame);
    if (jpeg.empty())
        throw Error(name + " has no thumbnail; rebuild the experience by `vdna build --force`, "
                           "without --no-thumbnails");
    const Decoder decoder = open_decoder(record::Thumbnails::pixels_max);
    vdna_error error{};
    const vdna_image image{
        reinterpret_cast<const uint8_t *>(jpeg.data()), jpeg.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
    vdna_pixels pixels;
    if (vdna_decoder_decode(decoder.get(), &image, &error, &pixels) != VDNA_OK)
        throw Error(name + ": its thumbnail cannot be shown: " + error.text +
                    "; rebuild the experience by `vdna build --force`");
    // Pixels of a JPEG are BGR.
    const cv::Mat bgr(static_cast<int>(pixels.height), static_cast<int>(pixels.width), CV_8UC3,
                      const_cast<uint8_t *>(pixels.data), pixels.stride);
    std::vector<uint8_t> png;
    cv::imencode(".png", bgr, png);
    return {{png.begin(), png.end()}, bgr.cols, bgr.rows};
}

// Does not return: the viewer takes our place.
[[noreturn]] void open_viewer(const std::string &file)
{
    execlp("xdg-open", "xdg-open", file.c_str(), static_cast<char *>(nullptr));
    throw Error(std::string("xdg-open: cannot be run: ") + std::strerror(errno) +
                "; install Debian's package xdg-utils, or open " + file + " yourself");
}

void show(const ShowOptions &options)
{
    const std::vector<Experience> files = record::open_experiences({options.map});
    const vdna_experience &e = find(files, options);
    const Picture picture = picture_of(e, options.frame);
    if (options.output == "-") {
        std::cout << picture.png << std::flush;
        return;
    }
    const std::string file =
        options.output.empty() ? std::string(e.name) + "-" + std::to_string(options.frame) + ".png"
                               : options.output;
    program::replace_file(file, picture.png, program::Durability::quick);
    const std::string date = frames::date_of(e.frame_utime[options.frame]);
    std::cout << file << ": " << picture.width << "x" << picture.height << ", frame "
              << options.frame << " of " << e.frames << (date.empty() ? "" : ", " + date)
              << std::endl;
    if (options.open)
        open_viewer(file);
}

} // namespace

void add_show(CLI::App &app)
{
    CLI::App *command = app.add_subcommand("show", "Write the thumbnail of a map's frame as PNG");
    const auto options = std::make_shared<ShowOptions>();
    command->add_option("MAP", options->map, "map directory, or experience file")
        ->type_name("PATH")
        ->required();
    command->add_option("EXPERIENCE", options->experience, "its name")
        ->type_name("NAME")
        ->required();
    command->add_option("FRAME", options->frame, "its index in the experience, from 0")
        ->type_name("N")
        ->required();
    CLI::Option *output =
        command
            ->add_option("-o,--output", options->output,
                         "file to write; - = standard output (default: EXPERIENCE-FRAME.png)")
            ->type_name("FILE");
    command->add_flag("--open", options->open, "open it in the desktop's viewer (xdg-open)");
    command->footer("Examples:\n"
                    "  vdna show park winter 17\n"
                    "  vdna show park winter 17 --open -o frame.png");
    command->callback([options, output] {
        if (options->open && !output->empty() && options->output == "-")
            throw CLI::ValidationError("--open", "needs a file, not standard output");
        show(*options);
    });
}

} // namespace vdna::tool
