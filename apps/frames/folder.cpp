// Pictures of a folder, in the order of their names.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <vector>

#include "frames/source.hpp"
#include "picture/files/kind.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

bool is_picture(const fs::path &file)
{
    std::string ending = file.extension().string();
    for (char &c : ending)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(picture::file_endings.begin(), picture::file_endings.end(), ending) !=
           picture::file_endings.end();
}

bool is_hidden(const fs::path &file)
{
    return file.filename().string()[0] == '.';
}

// In no order.
std::vector<fs::path> find_pictures(const fs::path &folder)
{
    std::vector<fs::path> files;
    std::error_code failure;
    for (fs::directory_iterator file(folder, failure), end; !failure && file != end;
         file.increment(failure))
        if (is_picture(*file) && !is_hidden(*file) && file->is_regular_file())
            files.push_back(*file);
    if (failure)
        throw Error(folder.string() + ": cannot read this folder: " + failure.message());
    return files;
}

class FolderReader : public Reader
{
  public:
    FolderReader(const fs::path &folder, double rate_hz)
        : rate_hz_(rate_hz), files_(pictures_in(folder))
    {
    }

    bool read(Frame &out_frame) override
    {
        if (next_ == files_.size())
            return false;
        const fs::path &file = files_[next_];
        out_frame.index = next_++;
        out_frame.file = file;
        out_frame.name = file.string();
        out_frame.utime = std::llround(static_cast<double>(out_frame.index) * 1e6 / rate_hz_);
        bytes_ = read_picture(file);
        out_frame.image = {bytes_.data(), bytes_.size(), 0, 0, 0, VDNA_PIXEL_ENCODED};
        return true;
    }

    bool skip() override
    {
        if (next_ == files_.size())
            return false;
        next_++;
        return true;
    }

    uint64_t size() const override { return files_.size(); }

  private:
    double rate_hz_;
    std::vector<fs::path> files_;
    std::vector<uint8_t> bytes_;
    size_t next_ = 0;
};

} // namespace

bool holds_pictures(const fs::path &folder)
{
    return !find_pictures(folder).empty();
}

std::vector<fs::path> pictures_in(const fs::path &folder)
{
    std::vector<fs::path> files = find_pictures(folder);
    if (files.empty())
        throw Error(folder.string() + ": no pictures in this folder, expected .jpg, .png, "
                                      ".webp, .bmp, .ppm or .tif files");
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<uint8_t> read_picture(const fs::path &file)
{
    std::error_code failure;
    const uintmax_t size = fs::file_size(file, failure);
    std::ifstream stream(file, std::ios::binary);
    if (failure || !stream)
        throw BadFrame(file.string() + ": cannot open this picture");
    std::vector<uint8_t> bytes(size);
    if (!stream.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(size)))
        throw BadFrame(file.string() + ": cannot read this picture");
    return bytes;
}

std::unique_ptr<Reader> open_folder(const fs::path &path, double rate_hz)
{
    return std::make_unique<FolderReader>(path, rate_hz);
}

} // namespace vdna::frames
