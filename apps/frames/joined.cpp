// One drive in several files: recorders cut them by size.
#include <algorithm>
#include <filesystem>

#include "frames/log_events.hpp"
#include "frames/mcap_file.hpp"
#include "frames/natural_order.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

class JoinedReader : public Reader
{
  public:
    // Videos time their frames from 0, so each begins where the one before it ends; logs have
    // stamps that go on by themselves.
    JoinedReader(std::vector<std::unique_ptr<Reader>> parts, bool are_videos)
        : parts_(std::move(parts)), are_videos_(are_videos)
    {
    }

    bool read(Frame &out_frame) override
    {
        for (; part_ < parts_.size(); go_on())
            if (parts_[part_]->read(out_frame)) {
                out_frame.index = next_++;
                out_frame.utime += begin_us_;
                if (out_frame.utime > newest_us_)
                    spacing_us_ = out_frame.utime - newest_us_;
                newest_us_ = out_frame.utime;
                return true;
            }
        return false;
    }

    bool skip() override
    {
        for (; part_ < parts_.size(); go_on())
            if (parts_[part_]->skip()) {
                next_++;
                return true;
            }
        return false;
    }

    uint64_t size() const override
    {
        uint64_t total = 0;
        for (const auto &part : parts_) {
            if (part->size() == 0)
                return 0;
            total += part->size();
        }
        return total;
    }

    std::vector<int64_t> stamps() const override
    {
        std::vector<int64_t> all;
        for (const auto &part : parts_) {
            const std::vector<int64_t> stamps = part->stamps();
            all.insert(all.end(), stamps.begin(), stamps.end());
        }
        return all;
    }

    void describe(Account &account) const override
    {
        for (const auto &part : parts_)
            part->describe(account);
    }

  private:
    void go_on()
    {
        part_++;
        if (are_videos_)
            begin_us_ = newest_us_ + spacing_us_;
    }

    std::vector<std::unique_ptr<Reader>> parts_;
    bool are_videos_;
    size_t part_ = 0;
    uint64_t next_ = 0;
    int64_t begin_us_ = 0;
    int64_t newest_us_ = 0;
    int64_t spacing_us_ = 0; // of the newest two frames, also between two videos
};

enum class Format { video, lcm, mcap };

Format format_of(const std::string &path)
{
    if (is_mcap(path))
        return Format::mcap;
    return is_lcm_log(path) ? Format::lcm : Format::video;
}

// "drive.lcm" for the file "drive.lcm.00"; "" for everything else.
std::string base_of(const std::string &path)
{
    const std::string ending = fs::path(path).extension().string();
    const bool is_number =
        ending.size() > 1 && ending.find_first_not_of("0123456789", 1) == std::string::npos;
    return is_number && !fs::is_directory(path) ? path.substr(0, path.size() - ending.size()) : "";
}

} // namespace

std::vector<std::string> parts_of(const std::string &path)
{
    if (fs::exists(path))
        return {path};
    std::vector<std::string> parts;
    for (size_t begin = 0; begin <= path.size();) {
        const size_t end = std::min(path.find('+', begin), path.size());
        parts.push_back(path.substr(begin, end - begin));
        if (!fs::exists(parts.back()))
            return {path};
        begin = end + 1;
    }
    return parts;
}

std::vector<std::string> join_numbered(const std::vector<std::string> &sources)
{
    std::vector<std::vector<std::string>> drives;
    for (const std::string &source : sources) {
        const std::string base = base_of(source);
        const auto same = std::find_if(drives.begin(), drives.end(), [&](const auto &drive) {
            return !base.empty() && base_of(drive.front()) == base;
        });
        if (same == drives.end())
            drives.push_back({source});
        else
            same->push_back(source);
    }
    std::vector<std::string> joined;
    for (std::vector<std::string> &drive : drives) {
        std::sort(drive.begin(), drive.end(), comes_before);
        joined.push_back(join(drive));
    }
    return joined;
}

std::string join(const std::vector<std::string> &paths)
{
    std::string source;
    for (const std::string &path : paths)
        source += (source.empty() ? "" : "+") + path;
    return source;
}

std::string drive_name_of(const std::string &source)
{
    const fs::path path = fs::weakly_canonical(parts_of(source).front());
    if (fs::is_directory(path))
        return path.filename().string();
    const std::string base = base_of(path.string());
    return (base.empty() ? path : fs::path(base)).stem().string();
}

std::unique_ptr<Reader> open_joined(const std::vector<std::string> &paths,
                                    const SourceOptions &options)
{
    std::vector<std::unique_ptr<Reader>> parts;
    const Format format = format_of(paths.front());
    for (const std::string &path : paths) {
        if (fs::is_directory(path) || format_of(path) != format)
            throw Error(path + ": cannot be joined with " + paths.front() +
                        ", expected videos only, LCM logs only or MCAP files only");
        parts.push_back(open_reader(path, options, nullptr));
    }
    return std::make_unique<JoinedReader>(std::move(parts), format == Format::video);
}

} // namespace vdna::frames
