// Ranges and their backbone, read from and written to ranges files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/cpp/experience.hpp>
#include <vdna/range.h>

namespace vdna::record
{

// A range table and the network it was calibrated with.
struct Ranges {
    std::string origin;        // for complaints: the file, or "calibration"
    vdna_identity identity;    // bins and range are unknown; dim may be known
    std::vector<float> values; // [neurons][2]
    // [neurons][2], the least and greatest activation before they were widened to `values`, from
    // which ranges of more pictures are merged; empty = not known
    std::vector<float> observed{};
};

// How observed minima and maxima become ranges: "midpoint" or "zero".
extern const char *const range_rules[2]; // indexed by VDNA_RANGE_ABOUT_...

// Minima and maxima over frames, from which ranges are made.
class Calibration
{
  public:
    explicit Calibration(const vdna_backbone_info &backbone);
    // where: names the frame in complaints.
    void observe(const vdna_backbone_frame &frame, const std::string &where);
    // rule: VDNA_RANGE_ABOUT_...; requires at least one observed frame.
    Ranges ranges(uint32_t rule) const;

  private:
    Ranges observed_;
};

// The ranges of an experience.
Ranges ranges_of(const Experience &experience);

// Read a ranges file, or take the ranges of an experience file. Throws Error.
Ranges read_ranges(const std::string &path);

// Write a ranges file of a Calibration atomically. Throws Error.
void write_ranges(const Ranges &ranges, uint32_t rule, const std::string &path);

// Throw Error, naming the field and the remedy, unless these ranges were made with `backbone`.
void require_backbone(const Ranges &ranges, const vdna_backbone_info &backbone);

} // namespace vdna::record
