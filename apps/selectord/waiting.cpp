#include "selectord/waiting.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>

#include <vdna_messages.h>

#include "telemetry/type_name.hpp"

namespace vdna::selectord
{

namespace
{

constexpr int64_t second_us = 1000000;
constexpr int64_t patience_us = 3 * second_us - second_us / 10; // a judgement may be early
constexpr int64_t overhear_us = 2 * second_us - second_us / 10; // earlier, to have heard some
constexpr int64_t repeat_us = 60 * second_us; // before what has come back is news again
constexpr uint64_t doubtful_frames_min = 3;   // fewer frames say nothing about camera time
constexpr uint64_t late_frames_in = 10;       // more than one late frame in these is doubtful
constexpr uint32_t named_channels_max = 3;

// Appends to the text of a verdict, which is cut if it is too long.
class Writer
{
  public:
    explicit Writer(Verdict &verdict) : text_(verdict.text) {}

    [[gnu::format(printf, 2, 3)]] void add(const char *format, ...)
    {
        const size_t used = std::strlen(text_.data());
        va_list arguments;
        va_start(arguments, format);
        std::vsnprintf(text_.data() + used, text_.size() - used, format, arguments);
        va_end(arguments);
    }

    // Anybody may name a channel: control characters must not reach a terminal.
    void add_channel(const char *name)
    {
        std::array<char, VDNA_CHANNEL_BYTES_MAX + 1> shown{};
        for (size_t i = 0; name[i] && i + 1 < shown.size(); i++)
            shown[i] = (name[i] >= 0 && name[i] < ' ') || name[i] == 0x7f ? '?' : name[i];
        add("%s", shown.data());
    }

    void add_type(uint64_t fingerprint)
    {
        const char *name = telemetry::type_name(fingerprint);
        name ? add("%s", name) : add("fingerprint %016" PRIx64, fingerprint);
    }

  private:
    decltype(Verdict::text) &text_;
};

// The other channels worth naming, not ours and not silent for long. If some carry pictures, only
// those.
class Others
{
  public:
    Others(const Config &config, const Facts &now, bool replay) : replay_(replay)
    {
        for (uint32_t i = 0; i < now.overheard_count; i++) {
            const vdna_transport_overheard &other = now.overheard[i];
            const bool is_own = config.ranking_channel == other.channel ||
                                config.localisation_channel == other.channel ||
                                config.status_channel == other.channel;
            if (!is_own && (replay || now.now_us - other.last_us < patience_us))
                add(other);
        }
    }

    uint32_t count() const { return count_; }
    bool are_pictures() const { return are_pictures_; }

    // Differs with the remedy: other pictures to choose from, only other messages, or none.
    uint64_t remedy() const
    {
        uint64_t sum = count_ > 0;
        for (uint32_t i = 0; are_pictures_ && i < count_; i++)
            sum += std::hash<std::string_view>()(found_[i]->channel);
        return sum;
    }

    // "CAMERA_FRONT carries bot_core.image_t at 15 Hz"
    void write(Writer &out) const
    {
        for (uint32_t i = 0; i < std::min(count_, named_channels_max); i++) {
            out.add("%s", i > 0 ? ", " : "");
            out.add_channel(found_[i]->channel);
            out.add(" carries ");
            out.add_type(found_[i]->fingerprint);
            write_rate(out, *found_[i]);
        }
        if (count_ > named_channels_max)
            out.add(" and %u more", count_ - named_channels_max);
    }

  private:
    void add(const vdna_transport_overheard &other)
    {
        const bool is_picture = other.fingerprint == vdna_message_image.fingerprint;
        if (is_picture && !are_pictures_)
            count_ = 0;
        are_pictures_ = are_pictures_ || is_picture;
        if (is_picture == are_pictures_)
            found_[count_++] = &other;
    }

    // Not of a log, which is read at any speed.
    void write_rate(Writer &out, const vdna_transport_overheard &other) const
    {
        const int64_t span_us = other.last_us - other.first_us;
        if (replay_ || span_us <= 0)
            return;
        const double intervals = static_cast<double>(other.messages - 1);
        const double hz = intervals * 1e6 / static_cast<double>(span_us);
        out.add(" at %.*f Hz", hz < 9.95 ? 1 : 0, hz);
    }

    bool replay_;
    bool are_pictures_ = false;
    uint32_t count_ = 0;
    std::array<const vdna_transport_overheard *, VDNA_TRANSPORT_OVERHEARD_MAX> found_{};
};

uint64_t messages_of(const Facts &facts)
{
    return facts.camera.received + facts.camera.camera_rejected + facts.camera.repeated_frames +
           facts.camera.reordered_frames;
}

// Why none of the messages between two moments was received as a frame.
Cause rejection(const vdna_transport_counters &then, const vdna_transport_counters &now)
{
    if (now.corrupted_frames > then.corrupted_frames)
        return Cause::corrupted;
    if (now.unprotected_frames > then.unprotected_frames)
        return Cause::unprotected;
    if (now.repeated_frames > then.repeated_frames || now.reordered_frames > then.reordered_frames)
        return Cause::repeated;
    return Cause::other_type;
}

// Why no frame between two moments made progress. `restarts_before`: a restart matters until the
// warmup gets further than those before it, which may take longer.
Cause obstacle(const Facts &then, const Facts &now, uint64_t restarts_before)
{
    const uint64_t received = now.camera.received - then.camera.received;
    const uint64_t accepted = now.accepted - then.accepted;
    if (messages_of(now) == messages_of(then))
        return Cause::silence;
    if (received == 0)
        return rejection(then.camera, now.camera);
    if (now.camera.oversized - then.camera.oversized == received)
        return Cause::oversized;
    if (accepted == 0 && now.refused > then.refused)
        return Cause::refused;
    if (accepted == 0)
        return now.late > then.late ? Cause::late : Cause::none;
    if (now.selected)
        return Cause::none;
    if (now.restarts > restarts_before)
        return Cause::restarts;
    if (now.parked - then.parked == accepted)
        return Cause::parked;
    return now.still > 0 && now.still + 1 >= accepted ? Cause::still : Cause::none;
}

// Why frames between two moments are doubtful although they are used.
Cause doubt(const Facts &then, const Facts &now)
{
    const uint64_t accepted = now.accepted - then.accepted, late = now.late - then.late;
    if (accepted >= doubtful_frames_min && now.still >= accepted)
        return Cause::still;
    return late * late_frames_in > accepted + late ? Cause::late : Cause::none;
}

void write_silence(Writer &out, const Config &config, const Others &others)
{
    if (others.count() == 0) {
        out.add(
            ", nor on any other channel: start the camera driver, on the LCM URL of this daemon "
            "(%.100s)",
            config.url.empty() ? "LCM's default" : config.url.c_str());
        return;
    }
    out.add("; ");
    others.write(out);
    if (!others.are_pictures())
        out.add(", none bot_core.image_t: start the camera driver");
    else
        out.add(": set [lcm] camera%s", others.count() > 1 ? " to one of them" : "");
}

void write_other_type(Writer &out, const Facts &now, const Others &others)
{
    const uint64_t found = now.camera.camera_fingerprint;
    const char *name = telemetry::type_name(found);
    if (found == vdna_message_image.fingerprint)
        out.add("malformed: they begin as bot_core.image_t and end too early or too late");
    else
        out.add("of another type: found fingerprint %016" PRIx64 "%s%s%s, expected "
                "bot_core.image_t, %016" PRIx64,
                found, name ? " (" : "", name ? name : "", name ? ")" : "",
                vdna_message_image.fingerprint);
    out.add("; let the camera driver send that, or set [lcm] camera");
    if (others.are_pictures()) {
        out.add(": ");
        others.write(out);
    }
}

void write_oversized(Writer &out, const Config &config, const Facts &now)
{
    out.add("larger than [lcm] max_image_bytes: found %" PRIu64 " bytes, expected at most %u; set "
            "it to %" PRIu64 " or more (see --print-memory), or send JPEG",
            now.camera.oversized_bytes, config.max_image_bytes, now.camera.picture_bytes_max);
}

void write_late(Writer &out, const Facts &now)
{
    out.add("frames come late, %" PRIu64 " so far: newer ones had come before them; is there more "
            "than one camera on the channel ",
            now.late);
}

// What distinguishes two verdicts of the same cause that want different remedies.
uint64_t detail_of(Cause cause, const Facts &now, const Others &others)
{
    switch (cause) {
    case Cause::silence:
        return others.remedy();
    case Cause::other_type:
        return now.camera.camera_fingerprint + (others.are_pictures() ? others.remedy() : 0);
    case Cause::refused:
        return std::hash<std::string_view>()(now.refusal);
    case Cause::restarts:
        return std::hash<std::string_view>()(now.restart_reason);
    default:
        return 0;
    }
}

} // namespace

Waiting::Waiting(const Config &config, bool replay) : config_(config), replay_(replay) {}

bool Waiting::wants_to_overhear() const
{
    return replay_ || (judged_ > 0 && last().now_us - picture_us_ >= overhear_us);
}

void Waiting::note_progress(const Facts &now)
{
    if (judged_ == 0) {
        message_us_ = picture_us_ = now.now_us;
        progress_ = now;
        return;
    }
    if (messages_of(now) != messages_of(last()))
        message_us_ = now.now_us;
    if (now.camera.received != last().camera.received)
        picture_us_ = now.now_us;

    // A warmup that restarted makes progress once it gets further than those before it; a reset by
    // command begins a new count.
    const bool was_reset = now.progress < last().progress && now.restarts == last().restarts;
    const bool advanced =
        now.selected ? now.accepted > progress_.accepted : now.progress > progress_.progress;
    if (advanced || was_reset || now.selected != progress_.selected)
        progress_ = now;
}

// Judge the last three seconds. Once the camera is silent, what was wrong with its last messages is
// still worth saying, so go back to the last progress then.
Cause Waiting::find_cause(const Facts &now) const
{
    if (judged_ < recent_.size() - 1)
        return Cause::none;
    const Facts &then = recent_[(judged_ + 1) % recent_.size()];
    Cause cause = Cause::none;
    if (now.now_us - progress_.now_us >= patience_us) {
        const bool is_silent = messages_of(now) == messages_of(then);
        cause = obstacle(is_silent ? progress_ : then, now, progress_.restarts);
    }
    return cause != Cause::none ? cause : doubt(then, now);
}

Verdict Waiting::describe(Cause cause, const Facts &now) const
{
    Verdict verdict;
    const Others others(config_, now, replay_);
    verdict.cause = cause;
    verdict.detail = detail_of(cause, now, others);
    Writer out(verdict);
    const std::string &camera = config_.camera_channel;
    const int64_t silent_us = now.now_us - message_us_;
    const long silent_s = std::lround(static_cast<double>(silent_us) / second_us);
    switch (cause) {
    case Cause::none:
        return verdict;
    case Cause::silence:
        out.add("no message on ");
        out.add_channel(camera.c_str());
        if (!replay_)
            out.add(" for %ld s", silent_s);
        write_silence(out, config_, others);
        if (now.camera.foreign_datagrams > 0)
            out.add("; other machines send, which may not: name them in [lcm] sources");
        return verdict;
    case Cause::corrupted:
        out.add(
            "all frames are damaged on their way, their checksums are false: look at the network "
            "and at the sender, on ");
        out.add_channel(camera.c_str());
        break;
    case Cause::unprotected:
        out.add("all frames are without the protection that [lcm] require_protection demands: send "
                "them by `vdna camera`, or set it to false; on ");
        out.add_channel(camera.c_str());
        break;
    case Cause::repeated:
        out.add("all frames came before, as when a recording is sent again: `vdna command reset` "
                "makes them count; on ");
        out.add_channel(camera.c_str());
        break;
    case Cause::other_type:
        out.add("all messages on ");
        out.add_channel(camera.c_str());
        out.add(" are ");
        write_other_type(out, now, others);
        break;
    case Cause::oversized:
        out.add("all frames are ");
        write_oversized(out, config_, now);
        break;
    case Cause::refused:
        out.add("all frames are refused, the last one because: %.300s", now.refusal);
        // A reason that names the limit does not know who set it.
        if (std::strstr(now.refusal, std::to_string(config_.max_image_pixels).c_str()))
            out.add(" ([lcm] max_image_pixels)");
        break;
    case Cause::restarts:
        out.add("the warmup began anew %" PRIu64 " time%s so far, the last time %.100s; see "
                "to the camera's clock, and that one camera only sends on ",
                now.restarts, now.restarts == 1 ? "" : "s", now.restart_reason);
        out.add_channel(camera.c_str());
        break;
    case Cause::parked:
        out.add("the pictures show nothing new, so the robot seems to stand, and [warmup] distinct "
                "counts no such picture: drive on, or set it to false");
        break;
    case Cause::still:
        out.add("camera time has not moved for %" PRIu64 " frames: let the camera driver set utime "
                "for each frame, in microseconds",
                now.still + 1);
        break;
    case Cause::late:
        write_late(out, now);
        out.add_channel(camera.c_str());
        out.add("?");
        break;
    }
    if (!replay_ && silent_us >= patience_us)
        out.add("; no message for %ld s", silent_s);
    return verdict;
}

bool Waiting::is_news(const Verdict &verdict, int64_t now_us)
{
    const bool is_same = verdict.cause == printed_.cause && verdict.detail == printed_.detail;
    const bool is_back = was_well_ && now_us - printed_us_ >= repeat_us;
    was_well_ = verdict.cause == Cause::none;
    if (was_well_ || (is_same && !is_back))
        return false;
    printed_ = verdict;
    printed_us_ = now_us;
    return true;
}

Verdict Waiting::judge(const Facts &now)
{
    note_progress(now);
    Verdict verdict = describe(find_cause(now), now);
    verdict.is_news = is_news(verdict, now.now_us);
    recent_[judged_++ % recent_.size()] = now;
    return verdict;
}

Verdict Waiting::judge_end(const Facts &end) const
{
    return describe(obstacle({}, end, 0), end);
}

} // namespace vdna::selectord
