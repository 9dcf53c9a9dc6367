// One pass of a source's frames through a network.
#pragma once

#include <string>

#include <vdna/cpp/backbone.hpp>

#include "frames/camera_image.hpp"
#include "frames/source.hpp"
#include "program/progress.hpp"

namespace vdna::record
{

// Run the network on one frame, as a camera sends it. The result is borrowed until the next run.
// Throws BadFrame if the picture cannot be used, or Error.
vdna_backbone_frame run_network(Backbone &backbone, const frames::Frame &frame);

// Usage: for (Pass pass(...); pass.next();) use(pass.frame(), pass.output());
// Shows progress, and ends with exit_interrupted on Ctrl-C.
class Pass
{
  public:
    // backbone: borrowed. Throws Error as Source does.
    Pass(const std::string &path, const frames::SourceOptions &options, Backbone &backbone);

    // Run the next usable frame; false at the end. Throws Error for an unusable or missing frame,
    // or counts and skips it if options.skip_bad is set.
    bool next();
    const frames::Frame &frame() const { return frame_; }
    // Borrowed until next().
    const vdna_backbone_frame &output() const { return output_; }
    // What was read so far, and what was left out.
    frames::Account account() const;

  private:
    bool run();

    frames::Source source_;
    Backbone &backbone_;
    bool skip_bad_;
    program::Progress progress_;
    picture::FileConverter converter_;
    frames::Frame frame_;
    vdna_backbone_frame output_{};
    uint64_t bad_ = 0;
    std::string first_bad_; // why
};

} // namespace vdna::record
