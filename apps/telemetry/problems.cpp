#include "telemetry/problems.hpp"

#include "program/print.hpp"
#include "telemetry/members.hpp"

namespace vdna::telemetry
{

namespace
{

// A counter of the status that tells of a problem where it is not 0.
struct Loss {
    const char *counter;
    const char *meaning;
    const char *remedy; // or cause; "" = none is known
};

constexpr Loss losses[] = {
    {"left_out", "Damaged experiences left out", "build them again, then send SIGHUP"},
    {"refused", "Frames that could not be used", ""},
    {"unusable", "Of these, with pictures that show nothing or nothing new", ""},
    {"skipped", "Frames skipped for newer ones", "they come faster than they are answered"},
    {"oversized", "Frames too large", "send JPEG, or raise [lcm] max_image_bytes"},
    {"late", "Frames too old", "let one camera only send on the channel"},
    {"rejected", "Messages that break their format", "correct their sender's encoder"},
    {"lost", "Camera messages that never came", ""},
    {"incomplete", "Messages with missing parts", ""},
    {"dropped_datagrams", "Datagrams dropped by the system", "its receive buffer was full"},
    {"malformed_datagrams", "Datagrams malformed", ""},
    {"foreign_datagrams", "Datagrams from elsewhere", "with ttl=0 only this machine may send"},
    {"corrupted_frames", "Frames corrupted", ""},
    {"reordered_frames", "Frames overtaken", ""},
    {"lost_frames", "Protected frames lost", ""},
    {"restarts", "Warmups begun anew as time ran backwards", "see to the camera's clock"},
};

} // namespace

std::vector<std::string> problems_of(const nlohmann::ordered_json &status)
{
    std::vector<std::string> problems;
    if (const std::string newest = text_of(status, "message"); !newest.empty())
        problems.push_back(newest);
    if (is_true(status, "map_changed"))
        problems.emplace_back("The map's directory has changed since it was opened; SIGHUP opens "
                              "it again");
    for (const auto &[counter, meaning, remedy] : losses) {
        const double count = number_of(status, counter);
        if (count > 0)
            problems.push_back(std::string(meaning) + ": " + program::fixed(count, 0) +
                               (remedy[0] ? "; " : "") + remedy);
    }
    return problems;
}

} // namespace vdna::telemetry
