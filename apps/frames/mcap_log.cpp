#include "frames/mcap_log.hpp"

#include <optional>
#include <set>

#include <vdna/cpp/error.hpp>

#include "frames/log_events.hpp"
#include "frames/mcap_messages.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

// What a first pass over a file finds.
struct Survey {
    std::map<std::string, uint64_t> pictures; // number of messages by topic
    std::set<std::string> topics;             // all of them, with their types
    uint64_t end_bytes = 0;
};

// The next message; damage is passed over.
bool next_sound(McapFile &file, McapMessage &out_message)
{
    for (;;)
        try {
            return file.next(out_message);
        } catch (const BadFrame &) {
            continue;
        }
}

Survey survey(const std::string &path)
{
    McapFile file(path);
    Survey found;
    for (McapMessage message{}; next_sound(file, message);) {
        const McapChannel &channel = *message.channel;
        found.topics.insert(channel.topic + " (" + channel.schema + ", " + channel.encoding + ")");
        if (kind_of(channel) == McapKind::picture)
            found.pictures[channel.topic]++;
    }
    found.end_bytes = file.end_bytes();
    return found;
}

// The topic with the camera's pictures: the one asked for, or the only one if none was.
std::string camera_topic(const std::string &path, const Survey &found, const SourceOptions &options)
{
    if (found.pictures.count(options.camera) > 0)
        return options.camera;
    if (found.pictures.size() == 1 && options.camera == VDNA_CHANNEL_CAMERA)
        return found.pictures.begin()->first;
    const std::string begin = path + ": no compressed pictures on topic " + options.camera;
    if (found.pictures.empty())
        throw Error(begin +
                    ", expected foxglove.CompressedImage or sensor_msgs' CompressedImage; "
                    "it holds" +
                    (found.topics.empty() ? " no messages" : ":" + listed(found.topics)));
    std::set<std::string> topics;
    for (const auto &[topic, number] : found.pictures)
        topics.insert(topic);
    throw Error(begin + "; set " + options.camera_option + " to one of:" + listed(topics));
}

class McapReader : public Reader
{
  public:
    McapReader(const std::string &path, const SourceOptions &options)
        : path_(path), survey_(survey(path)), topic_(camera_topic(path, survey_, options)),
          file_(path)
    {
    }

    bool read(Frame &out_frame) override
    {
        McapMessage message{};
        if (!next_picture(message))
            return false;
        const std::string name = path_ + ": frame " + std::to_string(next_);
        out_frame.index = next_++;
        if (!read_content(message, content_))
            throw BadFrame(name + ": a damaged message of type " + message.channel->schema);
        out_frame.name = name;
        out_frame.utime = content_.utime != 0 ? content_.utime : message.log_us;
        out_frame.image = {content_.encoded.data(), content_.encoded.size(), 0, 0, 0,
                           VDNA_PIXEL_ENCODED};
        return true;
    }

    bool skip() override
    {
        McapMessage message{};
        if (!next_picture(message))
            return false;
        next_++;
        return true;
    }

    uint64_t size() const override { return survey_.pictures.at(topic_); }

    void describe(Account &account) const override
    {
        account.order = "log";
        if (survey_.end_bytes > 0)
            account.notes.push_back("its last " + std::to_string(survey_.end_bytes) +
                                    " bytes are half a record, left out");
    }

  private:
    bool next_picture(McapMessage &out_message)
    {
        while (file_.next(out_message))
            if (out_message.channel->topic == topic_ &&
                kind_of(*out_message.channel) == McapKind::picture)
                return true;
        return false;
    }

    std::string path_;
    Survey survey_;
    std::string topic_;
    McapFile file_;
    McapContent content_;
    uint64_t next_ = 0;
};

// Add the fixes of a file, and the topics that have some.
void read_fixes(const std::string &path, const std::string &topic, TrackFile &fixes,
                std::set<std::string> &topics)
{
    McapFile file(path);
    for (McapMessage message{}; next_sound(file, message);) {
        if (kind_of(*message.channel) != McapKind::fix)
            continue;
        topics.insert(message.channel->topic);
        if (message.channel->topic != topic)
            continue;
        McapContent content;
        if (!read_content(message, content) || !content.has_fix)
            fixes.unplaced++;
        else
            fixes.fixes.push_back({content.utime != 0 ? content.utime : message.log_us, content.lat,
                                   content.lon, content.alt});
    }
}

} // namespace

Track read_mcap_track(const std::vector<std::string> &files, const std::string &topic,
                      int64_t gap_us)
{
    TrackFile fixes;
    std::set<std::string> topics;
    for (const std::string &file : files)
        read_fixes(file, topic, fixes, topics);
    if (topics.count(topic) == 0)
        throw Error(
            files.front() + ": no positions on topic " + topic +
            ", expected foxglove.LocationFix or sensor_msgs' NavSatFix; " +
            (topics.empty() ? "it holds none" : "set --pose-channel to one of:" + listed(topics)));
    return Track::of_fixes(files.front(), fixes, gap_us);
}

std::unique_ptr<Reader> open_mcap(const std::string &path, const SourceOptions &options)
{
    return std::make_unique<McapReader>(path, options);
}

} // namespace vdna::frames
