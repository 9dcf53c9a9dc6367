// Pictures of a folder.
#include <cmath>
#include <vector>

#include "frames/picture_list.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

class FolderReader : public Reader
{
  public:
    FolderReader(const std::filesystem::path &folder, double rate_hz, const Labels *labels)
        : rate_hz_(rate_hz), list_(list_pictures(folder, labels))
    {
    }

    bool read(Frame &out_frame) override
    {
        if (next_ == list_.pictures.size())
            return false;
        const ListedPicture &picture = list_.pictures[next_];
        out_frame.index = picture.number;
        out_frame.file = picture.file;
        out_frame.name = picture.file.string();
        out_frame.utime = picture.stamp ? *picture.stamp
                                        : std::llround(static_cast<double>(next_) * 1e6 / rate_hz_);
        next_++;
        bytes_ = read_picture(picture.file);
        out_frame.image = {bytes_.data(), bytes_.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
        return true;
    }

    bool skip() override
    {
        if (next_ == list_.pictures.size())
            return false;
        next_++;
        return true;
    }

    uint64_t size() const override { return list_.pictures.size(); }

    std::vector<int64_t> stamps() const override
    {
        std::vector<int64_t> stamps;
        for (const ListedPicture &picture : list_.pictures)
            if (picture.stamp)
                stamps.push_back(*picture.stamp);
        return stamps;
    }

    void describe(Account &account) const override
    {
        account.order = list_.order;
        account.notes.insert(account.notes.end(), list_.notes.begin(), list_.notes.end());
    }

  private:
    double rate_hz_;
    PictureList list_;
    std::vector<uint8_t> bytes_;
    size_t next_ = 0;
};

} // namespace

std::unique_ptr<Reader> open_folder(const std::filesystem::path &path, double rate_hz,
                                    const Labels *labels)
{
    return std::make_unique<FolderReader>(path, rate_hz, labels);
}

} // namespace vdna::frames
