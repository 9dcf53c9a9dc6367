// The newest messages of a daemon; of several on the same channels, of the one that answers.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include <nlohmann/json.hpp>

namespace vdna::telemetry
{

class Newest
{
  public:
    using Json = nlohmann::ordered_json;

    // Times are monotonic, in microseconds; it listens from `now_us` on.
    explicit Newest(int64_t now_us) : begin_us_(now_us) {}

    // A message as View::json gives it; kind: View::name. False if it is passed over: it is of
    // another kind, or of a daemon that stands by while another answers.
    bool take(const std::string &kind, Json message, int64_t now_us);

    // A message that cannot be read came on this channel.
    void note_rejected(const std::string &channel, const std::string &reason);

    // null = none. A ranking or answer may be of the last warmup.
    const Json &status() const { return status_; }
    const Json &ranking() const { return ranking_; }
    const Json &localisation() const { return localisation_; }

    // The newest message that could not be read, and why; "" = none.
    const std::string &rejected() const { return rejected_; }
    // When the newest status came; 0 = none has.
    int64_t status_us() const { return status_us_; }
    // Since the newest status, or since the beginning if none has come.
    double silent_s(int64_t now_us) const;
    // Camera frames that the daemon receives in a second, over its last statuses; NaN = not known.
    double camera_hz() const;

  private:
    bool is_of_another(const Json &status) const; // than the newest one
    bool stands_by_another(const Json &status, int64_t now_us) const;
    void take_status(Json status, int64_t now_us);

    int64_t begin_us_, status_us_ = 0;
    Json ranking_, localisation_, status_;
    std::string rejected_;
    struct Count {
        double utime_us, frames;
    };
    std::deque<Count> counts_; // of the last statuses, oldest first
};

} // namespace vdna::telemetry
