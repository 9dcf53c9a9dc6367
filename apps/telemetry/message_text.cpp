#include "telemetry/message_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numeric>
#include <string_view>

#include <vdna_messages.h>
#include <vdna_msg_command_result_t.h>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

#include <vdna/transport.h>

#include "program/choice_sentence.hpp"
#include "telemetry/commands.hpp"
#include "telemetry/members.hpp"

namespace vdna::telemetry
{

namespace
{

[[gnu::format(printf, 1, 2)]] std::string format(const char *pattern, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(text, sizeof text, pattern, arguments);
    va_end(arguments);
    return text;
}

// Also handles values of later versions.
const char *validity_of(const vdna_msg_ranking_t &message)
{
    return message.validity == VDNA_MSG_RANKING_T_VALID       ? "VALID"
           : message.validity == VDNA_MSG_RANKING_T_NONE_FITS ? "NONE_FITS"
                                                              : "UNKNOWN";
}

const char *validity_of(const vdna_msg_localisation_t &message)
{
    switch (message.validity) {
    case VDNA_MSG_LOCALISATION_T_VALID:
        return "VALID";
    case VDNA_MSG_LOCALISATION_T_WARMING_UP:
        return "WARMING_UP";
    case VDNA_MSG_LOCALISATION_T_REFUSED:
        return "REFUSED";
    case VDNA_MSG_LOCALISATION_T_UNSURE:
        return "UNSURE";
    case VDNA_MSG_LOCALISATION_T_DEGRADED:
        return "DEGRADED";
    case VDNA_MSG_LOCALISATION_T_NONE_FITS:
        return "NONE_FITS";
    case VDNA_MSG_LOCALISATION_T_FAULT:
        return "FAULT";
    default:
        return "UNKNOWN";
    }
}

const char *basis_of(const vdna_msg_localisation_t &message)
{
    switch (message.basis) {
    case VDNA_MSG_LOCALISATION_T_SEEN:
        return "SEEN";
    case VDNA_MSG_LOCALISATION_T_PARKED:
        return "PARKED";
    case VDNA_MSG_LOCALISATION_T_CARRIED:
        return "CARRIED";
    default:
        return "UNKNOWN";
    }
}

bool has_place(const vdna_msg_localisation_t &message)
{
    return message.validity == VDNA_MSG_LOCALISATION_T_VALID ||
           message.validity == VDNA_MSG_LOCALISATION_T_UNSURE ||
           message.validity == VDNA_MSG_LOCALISATION_T_DEGRADED ||
           message.validity == VDNA_MSG_LOCALISATION_T_NONE_FITS;
}

const char *state_of(const vdna_msg_status_t &message)
{
    switch (message.state) {
    case VDNA_MSG_STATUS_T_WARMUP:
        return "WARMUP";
    case VDNA_MSG_STATUS_T_VALID:
        return "VALID";
    case VDNA_MSG_STATUS_T_UNSURE:
        return "UNSURE";
    case VDNA_MSG_STATUS_T_STALE:
        return "STALE";
    case VDNA_MSG_STATUS_T_DEGRADED:
        return "DEGRADED";
    case VDNA_MSG_STATUS_T_NONE_FITS:
        return "NONE_FITS";
    case VDNA_MSG_STATUS_T_FAULT:
        return "FAULT";
    case VDNA_MSG_STATUS_T_STANDBY:
        return "STANDBY";
    default:
        return "UNKNOWN";
    }
}

double ms(int64_t us)
{
    return static_cast<double>(us) / 1000;
}

struct NamedStage {
    const char *name;
    const vdna_msg_duration_t *duration;
};

// In the order in which a frame passes them.
std::array<NamedStage, 8> stages_of(const vdna_msg_status_t &message)
{
    return {{{"queue", &message.queue_time},
             {"decode", &message.decode_time},
             {"resize", &message.resize_time},
             {"inference", &message.inference_time},
             {"select", &message.select_time},
             {"rank", &message.rank_time},
             {"publish", &message.publish_time},
             {"total", &message.total_time}}};
}

nlohmann::ordered_json json_of(const vdna_msg_duration_t &duration)
{
    return {{"newest_us", duration.newest_us},
            {"p50_us", duration.p50_us},
            {"p99_us", duration.p99_us},
            {"max_us", duration.max_us}};
}

// A position with its unit: enough digits for a centimetre.
std::string position_text(const char *frame, const double *at)
{
    if (std::string_view(frame) == "wgs84")
        return format("%.7f %.7f, height %.2f m", at[0], at[1], at[2]);
    return format("%.2f %.2f %.2f m in %s", at[0], at[1], at[2], frame);
}

// ", predicted recall 0.75 (0.62 to 0.84)"; "" if it is not predicted.
std::string prediction_text(double recall, double low, double high)
{
    return std::isnan(recall) ? ""
                              : format(", predicted recall %.2f (%.2f to %.2f)", recall, low, high);
}

program::Choice choice_of(const vdna_msg_ranking_t &message)
{
    return {message.experience[0],
            message.previous,
            message.count,
            message.window_frames,
            0,
            message.verdict,
            message.unlike,
            message.predicted_recall[0],
            message.predicted_low[0],
            message.predicted_high[0],
            message.no_prediction,
            message.skill};
}

// By how much the first entry is nearer than the second, and one line per neuron of that.
std::string reasons_text(const vdna_msg_ranking_t &message)
{
    const double named =
        std::accumulate(message.reason_bins, message.reason_bins + message.reasons, 0.0);
    const program::MarginShare share{message.experience[0], message.experience[1],
                                     message.margin_bins,   named,
                                     message.reasons,       message.neurons};
    std::string text = format("\n             %s", program::sentence_of(share).data());
    for (int32_t i = 0; i < message.reasons; i++)
        text +=
            format("\n             %s %d: %+.4f bins, mean bin live %.1f, first %.1f, second %.1f",
                   message.reason_tap[i], message.reason_neuron[i], message.reason_bins[i],
                   message.live_bin[i], message.winner_bin[i], message.runner_up_bin[i]);
    return text;
}

nlohmann::ordered_json reasons_json(const vdna_msg_ranking_t &message)
{
    nlohmann::ordered_json reasons = nlohmann::ordered_json::array();
    for (int32_t i = 0; i < message.reasons; i++)
        reasons.push_back({{"tap", message.reason_tap[i]},
                           {"neuron", message.reason_neuron[i]},
                           {"bins", message.reason_bins[i]},
                           {"live_bin", message.live_bin[i]},
                           {"winner_bin", message.winner_bin[i]},
                           {"runner_up_bin", message.runner_up_bin[i]},
                           {"winner_most", message.winner_most[i]},
                           {"winner_least", message.winner_least[i]},
                           {"runner_up_most", message.runner_up_most[i]},
                           {"runner_up_least", message.runner_up_least[i]}});
    return reasons;
}

// Two lines about the ranking as a whole, then one line per experience, then why.
std::string text_of(const vdna_msg_ranking_t &message)
{
    std::string text =
        format("ranking      %s%s%s after %d frames, by %s, margin %.3f bins, "
               "backbone %s",
               validity_of(message), message.verdict[0] ? " " : "", message.verdict,
               message.window_frames, message.ranked_by, message.margin_bins, message.backbone);
    if (message.count > 0)
        text += format("\n             %s", program::sentence_of(choice_of(message)).data());
    for (int32_t i = 0; i < message.count; i++)
        text += format("\n%11d  %-32s %9.3f bins%s", i + 1, message.experience[i],
                       message.distance_bins[i],
                       message.tied[i]    ? "  tied"
                       : message.bound[i] ? "  at least"
                                          : "") +
                prediction_text(message.predicted_recall[i], message.predicted_low[i],
                                message.predicted_high[i]);
    return message.reasons > 0 && message.count > 1 ? text + reasons_text(message) : text;
}

// One line.
std::string text_of(const vdna_msg_localisation_t &message)
{
    std::string text = format("localisation %s", validity_of(message));
    if (has_place(message)) {
        text += format(" %s frame %d", message.experience, message.frame);
        if (!std::isnan(message.confidence))
            text += format(", confidence %.2f%s", message.confidence,
                           message.moving ? "" : " (standing)");
        text += format(", nearest %d at %.3f", message.nearest_frame, message.distance);
        if (message.has_place)
            text += format(", place %lld", static_cast<long long>(message.place));
        if (message.has_position)
            text += ", position " + position_text(message.position_frame, message.position);
    }
    if (message.basis == VDNA_MSG_LOCALISATION_T_PARKED)
        text += ", parked";
    if (message.basis == VDNA_MSG_LOCALISATION_T_CARRIED)
        text += ", carried on";
    if (message.reason[0])
        text += format(": %s", message.reason);
    return text + format(" (%.1f ms)", ms(message.latency_us));
}

// One to three lines.
std::string text_of(const vdna_msg_status_t &message)
{
    const auto number = [](int64_t value) { return static_cast<long long>(value); };
    const auto mb = [](int64_t bytes) { return static_cast<double>(bytes) / 1e6; };
    std::string text = format(
        "status       %s %.0f %%%s%s%s%s, received %lld, processed %lld, skipped %lld, refused "
        "%lld, "
        "oversized %lld, late %lld, rejected %lld, %.0f MB, at most %.0f MB",
        state_of(message), 100 * message.progress, message.experience[0] ? " " : "",
        message.experience, message.reason[0] ? ": " : "", message.reason, number(message.received),
        number(message.processed), number(message.skipped), number(message.refused),
        number(message.oversized), number(message.late), number(message.rejected),
        mb(message.resident_bytes), mb(message.resident_bytes_max));
    if (message.parked > 0)
        text += format(", parked %lld", number(message.parked));
    if (message.carried > 0)
        text += format(", carried %lld", number(message.carried));
    if (message.over_rate > 0)
        text += format(", beyond the rate %lld", number(message.over_rate));
    if (message.pinned[0])
        text += format(", pinned: %s", message.pinned);
    if (message.shadow)
        text += ", in shadow";
    for (int32_t i = 0; i < message.excluded_count; i++)
        text += (i == 0 ? ", excluded: " : " ") + std::string(message.excluded[i]);
    if (message.left_out > 0)
        text += format(", %d experience%s left out", message.left_out,
                       message.left_out == 1 ? "" : "s");
    if (message.map_changed)
        text += ", the map's directory has changed";
    text +=
        prediction_text(message.predicted_recall, message.predicted_low, message.predicted_high);
    if (message.processed > 0) {
        text += "\n             ms, median/99th percentile/longest:";
        for (const auto &[name, stage] : stages_of(message))
            text += format(" %s %.1f/%.1f/%.1f", name, ms(stage->p50_us), ms(stage->p99_us),
                           ms(stage->max_us));
    }
    if (message.message[0])
        text += format("\n             last problem: %s", message.message);
    return text;
}

// One line.
std::string text_of(const vdna_msg_command_result_t &message)
{
    return format("result       %s %s: ", name_of_command(message.command),
                  message.accepted ? "accepted" : "refused") +
           message.text + format(" (map %s)", message.map_hash);
}

nlohmann::ordered_json json_of(const vdna_msg_command_result_t &message)
{
    return {{"type", "result"},
            {"utime", message.utime},
            {"command", name_of_command(message.command)},
            {"accepted", message.accepted != 0},
            {"text", message.text},
            {"map_hash", message.map_hash}};
}

nlohmann::ordered_json json_of(const vdna_msg_ranking_t &message)
{
    nlohmann::ordered_json entries = nlohmann::ordered_json::array();
    for (int32_t i = 0; i < message.count; i++)
        entries.push_back({{"experience", message.experience[i]},
                           {"distance_bins", message.distance_bins[i]},
                           {"tied", message.tied[i] != 0},
                           {"bound", message.bound[i] != 0},
                           {"predicted_recall", message.predicted_recall[i]},
                           {"predicted_low", message.predicted_low[i]},
                           {"predicted_high", message.predicted_high[i]},
                           {"transfer", message.transfer[i]}});
    return {{"type", "ranking"},
            {"utime", message.utime},
            {"window_begin_utime", message.window_begin_utime},
            {"window_frames", message.window_frames},
            {"validity", validity_of(message)},
            {"repeated", message.repeated != 0},
            {"backbone", message.backbone},
            {"comparable", message.comparable},
            {"map_hash", message.map_hash},
            {"margin_bins", message.margin_bins},
            {"ranked_by", message.ranked_by},
            {"verdict", message.verdict},
            {"unlike", message.unlike},
            {"no_prediction", message.no_prediction},
            {"skill", message.skill},
            {"settled_frames", message.settled_frames},
            {"previous", message.previous},
            {"neurons", message.neurons},
            {"reasons", reasons_json(message)},
            {"ranking", entries}};
}

nlohmann::ordered_json json_of(const vdna_msg_localisation_t &message)
{
    nlohmann::ordered_json json{{"type", "localisation"},
                                {"utime", message.utime},
                                {"validity", validity_of(message)},
                                {"reason", message.reason},
                                {"experience", nullptr},
                                {"frame", nullptr},
                                {"frame_utime", nullptr},
                                {"place", nullptr},
                                {"position_frame", nullptr},
                                {"position", nullptr},
                                {"confidence", message.confidence},
                                {"moving", nullptr},
                                {"nearest_frame", nullptr},
                                {"distance", nullptr},
                                {"predicted_recall", message.predicted_recall},
                                {"predicted_low", message.predicted_low},
                                {"predicted_high", message.predicted_high},
                                {"basis", basis_of(message)},
                                {"latency_us", message.latency_us},
                                {"skipped", message.skipped}};
    if (!has_place(message))
        return json;
    json["experience"] = message.experience;
    json["frame"] = message.frame;
    json["frame_utime"] = message.frame_utime;
    json["moving"] = message.moving != 0;
    json["nearest_frame"] = message.nearest_frame;
    json["distance"] = message.distance;
    if (message.has_place)
        json["place"] = message.place;
    if (message.has_position) {
        json["position_frame"] = message.position_frame;
        json["position"] = message.position;
    }
    return json;
}

nlohmann::ordered_json json_of(const vdna_msg_status_t &message)
{
    nlohmann::ordered_json json{{"type", "status"},
                                {"utime", message.utime},
                                {"state", state_of(message)},
                                {"instance", message.instance},
                                {"serving_utime", message.serving_utime},
                                {"host", message.host},
                                {"boot_id", message.boot_id},
                                {"reason", message.reason},
                                {"frame_age_us", message.frame_age_us},
                                {"progress", message.progress},
                                {"experience", message.experience},
                                {"predicted_recall", message.predicted_recall},
                                {"predicted_low", message.predicted_low},
                                {"predicted_high", message.predicted_high},
                                {"skill", message.skill},
                                {"settled_frames", message.settled_frames},
                                {"switches", message.switches},
                                {"experiences", message.experiences},
                                {"left_out", message.left_out},
                                {"map_hash", message.map_hash},
                                {"map_changed", message.map_changed != 0},
                                {"pinned", message.pinned},
                                {"shadow", message.shadow != 0},
                                {"excluded", nlohmann::ordered_json::array()},
                                {"backbone", message.backbone},
                                {"version", message.version},
                                {"received", message.received},
                                {"processed", message.processed},
                                {"parked", message.parked},
                                {"carried", message.carried},
                                {"refused", message.refused},
                                {"unusable", message.unusable},
                                {"skipped", message.skipped},
                                {"over_rate", message.over_rate},
                                {"oversized", message.oversized},
                                {"late", message.late},
                                {"rejected", message.rejected},
                                {"lost", message.lost},
                                {"incomplete", message.incomplete},
                                {"dropped_datagrams", message.dropped_datagrams},
                                {"malformed_datagrams", message.malformed_datagrams},
                                {"repeated_datagrams", message.repeated_datagrams},
                                {"foreign_datagrams", message.foreign_datagrams},
                                {"unprotected_frames", message.unprotected_frames},
                                {"corrupted_frames", message.corrupted_frames},
                                {"repeated_frames", message.repeated_frames},
                                {"reordered_frames", message.reordered_frames},
                                {"lost_frames", message.lost_frames},
                                {"restarts", message.restarts}};
    for (int32_t i = 0; i < message.excluded_count; i++)
        json["excluded"].push_back(message.excluded[i]);
    for (const auto &[name, duration] : stages_of(message))
        json[name] = json_of(*duration);
    json["resident_bytes"] = message.resident_bytes;
    json["resident_bytes_max"] = message.resident_bytes_max;
    json["picture_bytes_max"] = message.picture_bytes_max;
    json["window_frames_max"] = message.window_frames_max;
    json["backlog_max"] = message.backlog_max;
    json["message"] = message.message;
    return json;
}

template <typename Message>
View view(const vdna_message_type &type, const char *name, const char *channel)
{
    return {&type, name, channel,
            [](const void *message) { return text_of(*static_cast<const Message *>(message)); },
            [](const void *message) { return json_of(*static_cast<const Message *>(message)); }};
}

} // namespace

std::string position_of(const nlohmann::ordered_json &localisation)
{
    if (localisation.contains("position") && localisation["position"].is_array()) {
        const auto at = localisation["position"].get<std::array<double, 3>>();
        return position_text(text_of(localisation, "position_frame").c_str(), at.data());
    }
    const double place = number_of(localisation, "place");
    return std::isnan(place) ? "" : format("place %.0f", place);
}

const std::vector<View> &views()
{
    static const std::vector<View> all{
        view<vdna_msg_ranking_t>(vdna_message_ranking, "ranking", VDNA_CHANNEL_RANKING),
        view<vdna_msg_localisation_t>(vdna_message_localisation, "localisation",
                                      VDNA_CHANNEL_LOCALISATION),
        view<vdna_msg_command_result_t>(vdna_message_command_result, "result",
                                        VDNA_CHANNEL_COMMAND_RESULT),
        view<vdna_msg_status_t>(vdna_message_status, "status", VDNA_CHANNEL_STATUS),
    };
    return all;
}

const View &view_of(const vdna_message_type &type)
{
    return *std::find_if(views().begin(), views().end(),
                         [&](const View &view) { return view.type == &type; });
}

std::string json_line(const View &view, const std::string &channel, const void *message)
{
    nlohmann::ordered_json json{{"channel", channel}};
    json.update(view.json(message));
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

} // namespace vdna::telemetry
