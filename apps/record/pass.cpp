#include "record/pass.hpp"

#include "frames/camera_image.hpp"
#include "program/interrupt.hpp"

namespace vdna::record
{

Pass::Pass(const std::string &path, const frames::SourceOptions &options, Backbone &backbone)
    : source_(path, options), backbone_(backbone), skip_bad_(options.skip_bad),
      progress_(path, source_.size())
{
}

bool Pass::next()
{
    for (;;) {
        program::require_not_interrupted();
        try {
            const bool more = run();
            progress_.advance(more);
            return more;
        } catch (const frames::BadFrame &bad) {
            if (!skip_bad_)
                throw Error(bad.what() + std::string("; replace or remove it, or leave out frames "
                                                     "that cannot be used with --skip-bad"));
            if (bad_ == 0)
                first_bad_ = bad.what();
            bad_ += bad.frames();
            progress_.advance();
        }
    }
}

frames::Account Pass::account() const
{
    frames::Account account = source_.account();
    account.bad = bad_;
    account.first_bad = first_bad_;
    return account;
}

bool Pass::run()
{
    if (!source_.next(frame_))
        return false;
    frame_.image = frames::camera_image(frame_.image, frame_.name, converter_);
    output_ = run_network(backbone_, frame_);
    return true;
}

vdna_backbone_frame run_network(Backbone &backbone, const frames::Frame &frame)
{
    vdna_backbone_frame output{};
    vdna_error error{};
    const vdna_status status = vdna_backbone_run(backbone.get(), &frame.image, &error, &output);
    const std::string sentence = frame.name + ": " + error.text;
    if (status == VDNA_ERR_FORMAT || status == VDNA_ERR_UNSUPPORTED || status == VDNA_ERR_NONFINITE)
        throw frames::BadFrame(sentence);
    if (status != VDNA_OK)
        throw Error(sentence);
    return output;
}

} // namespace vdna::record
