// Pictures that a disturbed camera gives.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace vdna::eval
{

struct Disturbance {
    const char *key; // in text and JSON
    bool of_scene;   // the picture depends on what is before the camera
    uint32_t most;   // different pictures worth having
    // scene: 8-bit BGR; the result has its size.
    cv::Mat (*picture)(const cv::Mat &scene, std::mt19937 &random);
};

// Black, white, a lens cap (levels of 0 to 15), noise (of 0 to 255), and a strong blur (Gaussian,
// sigma a twentieth of the width).
extern const std::vector<Disturbance> disturbances;

// An encoded picture as 8-bit BGR. name: names it in the error. Throws Error.
cv::Mat decoded(const std::vector<uint8_t> &picture, const std::string &name);

} // namespace vdna::eval
