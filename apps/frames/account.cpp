#include "frames/account.hpp"

namespace vdna::frames
{

std::vector<std::string> sentences_of(const Account &account)
{
    std::vector<std::string> sentences = account.notes;
    if (account.late > 0)
        sentences.push_back(std::to_string(account.late) +
                            " late frames left out: older than a frame before them");
    if (account.bad > 0)
        sentences.push_back(std::to_string(account.bad) +
                            " bad frames left out; the first: " + account.first_bad);
    return sentences;
}

program::Json json_of(const Account &account)
{
    return {{"order", account.order},
            {"time_unit", account.time_unit},
            {"bad_frames", account.bad},
            {"late_frames", account.late},
            {"notes", account.notes}};
}

} // namespace vdna::frames
