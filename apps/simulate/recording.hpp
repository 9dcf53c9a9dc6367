// A simulated drive as a folder of pictures with labels.csv, as `vdna build` reads it.
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "simulate/condition.hpp"
#include "simulate/drive.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

struct RecordingConfig {
    cv::Size size = {320, 240};
    size_t frames = 120;
    int quality = 90;   // JPEG, 1..100
    bool force = false; // replace an earlier recording
};

// Write `directory`/000000.jpg ... and labels.csv, all or nothing: files are written in
// `directory`.partial, which is then renamed. Throws Error, also if interrupted, and leaves nothing
// behind.
void record_drive(const std::filesystem::path &directory, const Route &route,
                  const Condition &condition, const Drive &drive, const RecordingConfig &config);

// Write one picture file: a row of small pictures for each condition, and a column for each place.
void write_sheet(const std::filesystem::path &file, const Route &route, const DriveConfig &drive,
                 cv::Size size, size_t columns, int quality);

} // namespace vdna::simulate
