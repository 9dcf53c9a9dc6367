#include "telemetry/headline.hpp"

#include <cmath>

#include "program/print.hpp"
#include "telemetry/members.hpp"

namespace vdna::telemetry
{

namespace
{

using Json = nlohmann::ordered_json;
using program::fixed;

std::string percent(double share)
{
    return fixed(100 * share, 0);
}

// "94 % of its frames should be found (88 to 97 %)"
std::string prediction_of(const Json &entry)
{
    const double low = number_of(entry, "predicted_low"), high = number_of(entry, "predicted_high");
    return percent(number_of(entry, "predicted_recall")) + " % of its frames should be found" +
           (std::isfinite(low) && std::isfinite(high)
                ? " (" + percent(low) + " to " + percent(high) + " %)"
                : "");
}

// Why the ranking has its first entry first.
std::string reason_of(const Json &ranking, const Json &entries)
{
    const Json &first = entries[0];
    if (entries.size() == 1)
        return "because the map has no other experience";
    const Json &second = entries[1];
    const double gain =
        number_of(first, "predicted_recall") - number_of(second, "predicted_recall");
    const std::string rule = text_of(ranking, "ranked_by"), next = text_of(second, "experience");
    if (!rule.empty() && rule != "emd" && std::isfinite(gain))
        return "because " + prediction_of(first) + ", in " + next + " " + percent(std::abs(gain)) +
               " points " + (gain < 0 ? "more" : "fewer");
    const double farther = number_of(second, "distance_bins") - number_of(first, "distance_bins");
    return "because it looks most like the warmup's frames: " +
           fixed(number_of(first, "distance_bins"), 2) + " bins away, " + next + " " +
           fixed(farther, 2) + " farther";
}

// ", because ..." if the ranking is the one that made this choice, or an operator.
std::string because(const Json &status, const Json &ranking, const std::string &choice)
{
    if (text_of(status, "pinned") == choice)
        return ", because it is pinned";
    if (!ranking.is_object() || !ranking.contains("ranking") || ranking["ranking"].empty())
        return "; why was said before this program listened";
    const Json &entries = ranking["ranking"];
    const std::string first = text_of(entries[0], "experience");
    if (first != choice && status.value("shadow", false))
        return ", kept by shadow; recommended is " + first;
    return first == choice ? ", " + reason_of(ranking, entries) : "";
}

std::string with_reason(const std::string &clause, const Json &status)
{
    const std::string reason = text_of(status, "reason");
    return clause + (reason.empty() ? "." : ": " + reason + ".");
}

} // namespace

Headline headline(const Json &status, const Json &ranking, double silent_s, const std::string &url)
{
    if (!status.is_object())
        return {"wait", "No daemon heard on " + url + " for " + fixed(silent_s, 0) +
                            " s: is vdna_selectord running, on this LCM network?"};
    if (silent_s > silence_max_s)
        return {"bad", "No daemon heard on " + url + " for " + fixed(silent_s, 0) +
                           " s: it has ended, or the network is gone."};
    const std::string state = text_of(status, "state"), choice = text_of(status, "experience");
    if (state == "WARMUP")
        return {"wait", "Warming up: " + percent(number_of(status, "progress")) +
                            " % of the frames to choose by have come."};
    if (state == "VALID")
        return {"good", "Localising in " + choice + because(status, ranking, choice) + "."};
    if (state == "UNSURE" && !text_of(status, "reason").empty())
        return {"doubt", with_reason("Unsure of the place in " + choice, status)};
    if (state == "UNSURE")
        return {"doubt", "Unsure of the place, localising in " + choice +
                             because(status, ranking, choice) + "."};
    if (state == "NONE_FITS" && text_of(status, "pinned") == choice)
        return {"doubt", with_reason("Localising in " + choice + ", which does not fit", status)};
    if (state == "NONE_FITS")
        return {"doubt",
                with_reason("No experience fits, " + choice + " is the least bad", status)};
    if (state == "STALE")
        return {"bad", with_reason("No place is known", status)};
    if (state == "DEGRADED")
        return {"doubt", with_reason("The camera's frames cannot be trusted", status)};
    if (state == "FAULT")
        return {"bad", with_reason("No place is given", status)};
    if (state == "STANDBY")
        return {"wait", with_reason("Standing by", status)};
    return {"doubt", with_reason("In a state that this program does not know, " + state, status)};
}

} // namespace vdna::telemetry
