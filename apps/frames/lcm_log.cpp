// Camera frames of an LCM log.
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
    const uint64_t found = fingerprint_of(bytes), expected = vdna_message_image.fingerprint;
    if (found == expected)
        return "a damaged message of type bot_core.image_t";
    return "a message of fingerprint " + fingerprint_text(found) + ", expected " +
           fingerprint_text(expected) + " (bot_core.image_t)";
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
                     : "set " + options.camera_option + " to one of:" + listed(log_.channels)));
    }

    bool read(Frame &out_frame) override
    {
        complain_of_damage();
        if (next_ == log_.events.size())
            return false;
        const LogEvent &event = log_.events[next_];
        const std::string name = path_ + ": frame " + std::to_string(next_);
        out_frame.index = next_++;
        read_message(stream_, event, name, bytes_);
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
