#include "simulate/recording.hpp"

#include <cstdio>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <vdna/cpp/error.hpp>

#include "program/interrupt.hpp"
#include "program/new_folder.hpp"
#include "program/progress.hpp"
#include "program/replaced_file.hpp"

namespace vdna::simulate
{

namespace fs = std::filesystem;

namespace
{

std::string picture_name(size_t frame)
{
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.jpg", frame);
    return name;
}

void write_picture(const fs::path &file, const cv::Mat &picture, int quality)
{
    std::vector<uchar> bytes;
    cv::imencode(file.extension().string(), picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    program::replace_file(file.string(), {bytes.begin(), bytes.end()}, program::Durability::quick);
}

// True for the file names of record_drive(): no other file is ever deleted.
bool is_ours(const fs::path &entry)
{
    const std::string name = entry.filename().string();
    return name == "labels.csv" ||
           (entry.extension() == ".jpg" &&
            entry.stem().string().find_first_not_of("0123456789") == std::string::npos);
}

// Throws unless the directory is missing, empty, or a recording that may be replaced.
void require_replaceable(const fs::path &directory, bool force)
{
    if (!fs::exists(directory))
        return;
    if (!fs::is_directory(directory))
        throw Error(directory.string() + ": is a file; name a new directory");
    for (const auto &entry : fs::directory_iterator(directory)) {
        if (!force)
            throw Error(directory.string() +
                        ": exists and is not empty; name a new directory, or give --force");
        if (!is_ours(entry.path()))
            throw Error(entry.path().string() +
                        ": is not part of a recording; --force replaces recordings only");
    }
}

// In the left corner above `bottom`, legible on any background.
void write_name(cv::Mat3b &sheet, const std::string &name, int bottom)
{
    const cv::Point corner(5, bottom - 6);
    cv::putText(sheet, name, corner, cv::FONT_HERSHEY_SIMPLEX, .45, {0, 0, 0}, 3, cv::LINE_AA);
    cv::putText(sheet, name, corner, cv::FONT_HERSHEY_SIMPLEX, .45, {255, 255, 255}, 1,
                cv::LINE_AA);
}

void write_recording(const fs::path &directory, const Route &route, const Condition &condition,
                     const Drive &drive, const RecordingConfig &config)
{
    const Renderer renderer(route, condition, config.size);
    program::Progress bar("driving through " + condition.name, config.frames);
    std::string labels = "file,utime,x,y\n";
    for (size_t frame = 0; frame < config.frames; frame++) {
        program::require_not_interrupted();
        const std::string name = picture_name(frame);
        write_picture(directory / name, renderer.render(drive.shot(frame)), config.quality);
        const cv::Point2d position = drive.position(frame);
        char numbers[96];
        std::snprintf(numbers, sizeof numbers, ",%lld,%.3f,%.3f\n",
                      static_cast<long long>(drive.utime(frame)), position.x, position.y);
        labels += name + numbers;
        bar.advance();
    }
    program::replace_file((directory / "labels.csv").string(), labels, program::Durability::quick);
}

} // namespace

void record_drive(const fs::path &directory, const Route &route, const Condition &condition,
                  const Drive &drive, const RecordingConfig &config)
{
    // "out/" means out.
    const fs::path target = directory.has_filename() ? directory : directory.parent_path();
    try {
        require_replaceable(target, config.force);
        require_replaceable(target.string() + ".partial", true);
        program::NewFolder work(target);
        write_recording(work.partial(), route, condition, drive, config);
        work.finish();
    } catch (const fs::filesystem_error &error) {
        throw Error(error.path1().string() + ": cannot write: " + error.code().message());
    }
}

void write_sheet(const fs::path &file, const Route &route, const DriveConfig &config, cv::Size size,
                 size_t columns, int quality)
{
    if (!cv::haveImageWriter(file.string()))
        throw Error(file.string() + ": no picture format is known by this ending; try .jpg");
    const Drive drive(route, config);
    const auto rows = static_cast<int>(conditions().size());
    cv::Mat3b sheet(rows * size.height, static_cast<int>(columns) * size.width);
    for (int row = 0; row < rows; row++) {
        const Condition &condition = conditions()[static_cast<size_t>(row)];
        const Renderer renderer(route, condition, size);
        for (size_t column = 0; column < columns; column++) {
            const cv::Point corner(static_cast<int>(column) * size.width, row * size.height);
            renderer.render(drive.shot(column)).copyTo(sheet(cv::Rect(corner, size)));
        }
        write_name(sheet, condition.name, (row + 1) * size.height);
    }
    write_picture(file, sheet, quality);
}

} // namespace vdna::simulate
