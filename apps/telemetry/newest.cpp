#include "telemetry/newest.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "telemetry/headline.hpp"
#include "telemetry/members.hpp"

namespace vdna::telemetry
{

namespace
{

constexpr double second_us = 1e6;
constexpr size_t rate_statuses = 4; // over which the camera's rate is taken: three seconds

} // namespace

double Newest::silent_s(int64_t now_us) const
{
    return static_cast<double>(now_us - (status_us_ > 0 ? status_us_ : begin_us_)) / second_us;
}

double Newest::camera_hz() const
{
    if (counts_.size() < 2)
        return NAN;
    const Count &first = counts_.front(), &last = counts_.back();
    const double us = last.utime_us - first.utime_us;
    return us > 0 ? (last.frames - first.frames) * second_us / us : NAN;
}

bool Newest::is_of_another(const Json &status) const
{
    return status_.value("instance", Json()) != status.value("instance", Json());
}

bool Newest::stands_by_another(const Json &status, int64_t now_us) const
{
    return text_of(status, "state") == "STANDBY" && status_.is_object() &&
           text_of(status_, "state") != "STANDBY" && is_of_another(status) &&
           silent_s(now_us) < silence_max_s;
}

void Newest::take_status(Json status, int64_t now_us)
{
    if (status_.is_object() && is_of_another(status)) {
        counts_.clear();
        // A restarted daemon that warms up has no ranking and no place yet: those of its
        // predecessor go.
        if (text_of(status, "state") == "WARMUP")
            ranking_ = localisation_ = nullptr;
    }
    counts_.push_back({number_of(status, "utime"), number_of(status, "received")});
    if (counts_.size() > rate_statuses)
        counts_.pop_front();
    status_ = std::move(status);
    status_us_ = now_us;
}

void Newest::note_rejected(const std::string &channel, const std::string &reason)
{
    rejected_ = channel + ": " + reason;
}

bool Newest::take(const std::string &kind, Json message, int64_t now_us)
{
    if (kind == "ranking")
        ranking_ = std::move(message);
    else if (kind == "localisation")
        localisation_ = std::move(message);
    else if (kind != "status" || stands_by_another(message, now_us))
        return false;
    else
        take_status(std::move(message), now_us);
    return true;
}

} // namespace vdna::telemetry
