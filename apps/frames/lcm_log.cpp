// Camera frames of an LCM log.
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <vector>

#include <vdna_messages.h>

#include <vdna/transport.h>

#include "frames/log_events.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

std::string joined(const std::set<std::string> &names)
{
    std::string text;
    for (const std::string &name : names)
        text += " " + name;
    return text;
}

std::string loss_of(const LogDamage &damage)
{
    return "damaged at byte " + std::to_string(damage.offset) + ": " + std::to_string(damage.size) +
           " bytes are no events" +
           (damage.lost_events > 0 ? ", " + std::to_string(damage.lost_events) + " events are lost"
                                   : "");
}

// Why bytes are no camera message: of another type, or damaged.
std::string refusal_of(const std::vector<uint8_t> &bytes)
{
    uint64_t fingerprint = 0;
    for (size_t i = 0; i < std::min(bytes.size(), sizeof fingerprint); i++)
        fingerprint = fingerprint << 8 | bytes[i];
    char text[128];
    std::snprintf(text, sizeof text,
                  fingerprint == vdna_message_image.fingerprint
                      ? "a damaged message of type bot_core.image_t"
                      : "a message of fingerprint %016" PRIx64 ", expected %016" PRIx64
                        " (bot_core.image_t)",
                  fingerprint, vdna_message_image.fingerprint);
    return text;
}

class LogReader : public Reader
{
  public:
    LogReader(const std::string &path, const SourceOptions &options)
        : path_(path), stream_(path, std::ios::binary), log_(read_log(path, options.camera))
    {
        if (log_.events.empty())
            throw Error(
                path + ": no message on channel " + options.camera + ", expected camera frames; " +
                (log_.channels.empty()
                     ? "it holds no others"
                     : "set " + options.camera_option + " to one of:" + joined(log_.channels)));
    }

    bool read(Frame &out_frame) override
    {
        complain_of_damage();
        if (next_ == log_.events.size())
            return false;
        const LogEvent &event = log_.events[next_];
        const std::string name = path_ + ": frame " + std::to_string(next_);
        out_frame.index = next_++;
        bytes_.resize(event.size);
        stream_.seekg(static_cast<std::streamoff>(event.offset));
        if (!stream_.read(reinterpret_cast<char *>(bytes_.data()), event.size))
            throw Error(name + ": cannot read; the log changed while it was open");
        vdna_transport_frame camera;
        if (vdna_transport_parse_image(bytes_.data(), bytes_.size(), &camera) != VDNA_OK)
            throw BadFrame(name + ": " + refusal_of(bytes_));
        out_frame.name = name;
        out_frame.utime = camera.utime;
        out_frame.image = camera.image;
        return true;
    }

    bool skip() override
    {
        complain_of_damage();
        if (next_ == log_.events.size())
            return false;
        next_++;
        return true;
    }

    uint64_t size() const override { return log_.events.size(); }

    std::vector<int64_t> stamps() const override
    {
        std::vector<int64_t> stamps;
        for (const LogEvent &event : log_.events)
            stamps.push_back(event.stamp);
        return stamps;
    }

    void describe(Account &account) const override
    {
        account.order = "log";
        if (log_.end_bytes > 0)
            account.notes.push_back("its last " + std::to_string(log_.end_bytes) +
                                    " bytes are zeros or half an event, left out");
    }

  private:
    // Each damage is complained of once, before the first frame after it.
    void complain_of_damage()
    {
        if (next_damage_ == log_.damages.size() || log_.damages[next_damage_].next > next_)
            return;
        throw BadFrame(path_ + ": " + loss_of(log_.damages[next_damage_++]));
    }

    std::string path_;
    std::ifstream stream_;
    LogContents log_;
    std::vector<uint8_t> bytes_;
    size_t next_ = 0;
    size_t next_damage_ = 0;
};

} // namespace

std::unique_ptr<Reader> open_lcm_log(const std::string &path, const SourceOptions &options)
{
    return std::make_unique<LogReader>(path, options);
}

} // namespace vdna::frames
