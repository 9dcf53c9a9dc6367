#include "frames/account.hpp"

namespace vdna::frames
{

namespace
{

// "1 late frame", "2 late frames"
std::string frames_text(uint64_t count, const char *kind)
{
    return std::to_string(count) + " " + kind + (count == 1 ? " frame" : " frames");
}

} // namespace

std::vector<std::string> sentences_of(const Account &account)
{
    std::vector<std::string> sentences = account.notes;
    if (account.late > 0)
        sentences.push_back(frames_text(account.late, "late") +
                            " left out: older than a frame before them");
    if (account.bad > 0)
        sentences.push_back(frames_text(account.bad, "bad") +
                            " left out; the first: " + account.first_bad);
    return sentences;
}

program::Json json_of(const Account &account)
{
    return {{"order", account.order},
            {"time_unit", account.time_unit},
            {"expected_frames",
             account.expected > 0 ? program::Json(account.expected) : program::Json()},
            {"bad_frames", account.bad},
            {"late_frames", account.late},
            {"notes", account.notes}};
}

} // namespace vdna::frames
