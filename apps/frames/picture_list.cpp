#include "frames/picture_list.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>

#include "frames/natural_order.hpp"
#include "frames/source.hpp"
#include "frames/utm_name.hpp"
#include "picture/files/kind.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

template <typename Endings>
bool is_among(const std::string &ending, const Endings &endings)
{
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// Also a picture of a kind that cannot be read, so that nobody misses it without a word.
bool is_picture(const fs::path &file)
{
    std::string ending = file.extension().string();
    for (char &c : ending)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return is_among(ending, picture::file_endings) || is_among(ending, picture::unreadable_endings);
}

bool is_hidden(const fs::path &file)
{
    return file.filename().string()[0] == '.';
}

bool name_comes_before(const fs::path &a, const fs::path &b)
{
    return comes_before(a.string(), b.string());
}

// The entries of a folder for which `is_wanted`, in natural order.
template <typename Predicate>
std::vector<fs::path> entries_of(const fs::path &folder, Predicate is_wanted)
{
    std::vector<fs::path> entries;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure))
        if (!is_hidden(*entry) && is_wanted(*entry))
            entries.push_back(*entry);
    if (failure)
        throw Error(folder.string() + ": cannot read this folder: " + failure.message());
    std::sort(entries.begin(), entries.end(), name_comes_before);
    return entries;
}

// A link whose target is missing counts, to be complained of.
std::vector<fs::path> find_pictures(const fs::path &folder)
{
    return entries_of(folder, [](const fs::directory_entry &entry) {
        return is_picture(entry) && !entry.is_directory();
    });
}

[[noreturn]] void complain_of_no_pictures(const fs::path &folder)
{
    for (const fs::path &inner : folders_in(folder))
        if (const size_t count = find_pictures(inner).size())
            throw Error(folder.string() + ": no pictures in this folder, but " +
                        std::to_string(count) + " one level down; name " + inner.string());
    throw Error(folder.string() + ": no pictures in this folder, expected .jpg, .png, "
                                  ".webp, .bmp, .pgm, .ppm or .tif files");
}

// Give every picture a stamp if any has one: a picture without one takes that of the picture before
// it, and at the beginning that of the first that has one. Returns whether there are stamps.
bool complete_stamps(std::vector<ListedPicture> &pictures)
{
    const auto first = std::find_if(pictures.begin(), pictures.end(),
                                    [](const ListedPicture &p) { return p.stamp.has_value(); });
    if (first == pictures.end())
        return false;
    std::optional<int64_t> before = first->stamp;
    for (ListedPicture &picture : pictures)
        before = picture.stamp = picture.stamp ? picture.stamp : before;
    return true;
}

bool order_by_table(const Labels *labels, PictureList &list)
{
    if (labels)
        for (ListedPicture &picture : list.pictures)
            picture.stamp = labels->find(picture.file, picture.number).utime;
    if (!complete_stamps(list.pictures))
        return false;
    std::stable_sort(
        list.pictures.begin(), list.pictures.end(),
        [](const ListedPicture &a, const ListedPicture &b) { return *a.stamp < *b.stamp; });
    list.order = "utime";
    return true;
}

bool order_by_times_in_names(PictureList &list)
{
    std::vector<std::string> times; // by number
    for (const ListedPicture &picture : list.pictures) {
        if (!is_utm_name(picture.file))
            return false;
        times.push_back(utm_name_of(picture.file).time);
    }
    const bool tell_apart =
        std::adjacent_find(times.begin(), times.end(), std::not_equal_to<>()) != times.end();
    if (!tell_apart || std::count(times.begin(), times.end(), "") > 0) {
        list.notes.push_back("its pictures are named after positions without a time: taken in the "
                             "order of the names, which need not be that of the drive");
        return false;
    }
    for (ListedPicture &picture : list.pictures)
        picture.stamp = stamp_of(times[picture.number]);
    complete_stamps(list.pictures);
    std::stable_sort(list.pictures.begin(), list.pictures.end(),
                     [&](const ListedPicture &a, const ListedPicture &b) {
                         return comes_before(times[a.number], times[b.number]);
                     });
    list.order = "times in names";
    return true;
}

bool are_numbered(const std::vector<ListedPicture> &pictures)
{
    return std::all_of(pictures.begin(), pictures.end(), [](const ListedPicture &picture) {
        return picture.file.stem().string().find_first_of("0123456789") != std::string::npos;
    });
}

} // namespace

PictureList list_pictures(const fs::path &folder, const Labels *labels)
{
    std::vector<fs::path> files = find_pictures(folder);
    if (labels) {
        const std::vector<fs::path> others = labels->others_below(folder, files);
        files.insert(files.end(), others.begin(), others.end());
        std::sort(files.begin(), files.end(), name_comes_before);
    }
    if (files.empty())
        complain_of_no_pictures(folder);

    PictureList list;
    for (const fs::path &file : files)
        list.pictures.push_back({file, list.pictures.size(), {}});
    if (!order_by_table(labels, list) && !order_by_times_in_names(list))
        list.order = are_numbered(list.pictures) ? "numbers" : "names";
    return list;
}

std::vector<fs::path> pictures_in(const fs::path &folder)
{
    const std::vector<fs::path> files = find_pictures(folder);
    if (files.empty())
        complain_of_no_pictures(folder);
    return files;
}

bool holds_pictures(const fs::path &folder)
{
    return !find_pictures(folder).empty();
}

std::vector<fs::path> folders_in(const fs::path &path)
{
    return entries_of(path, [](const fs::directory_entry &entry) { return entry.is_directory(); });
}

std::vector<uint8_t> read_picture(const fs::path &file)
{
    std::error_code failure;
    if (fs::is_symlink(file, failure) && !fs::exists(file, failure))
        throw BadFrame(file.string() + ": a link to " + fs::read_symlink(file, failure).string() +
                       ", which is not there; fetch it");
    if (!fs::exists(file, failure))
        throw BadFrame(file.string() + ": not found, though the table has a row about it");
    const uintmax_t size = fs::file_size(file, failure);
    std::ifstream stream(file, std::ios::binary);
    if (failure || !stream)
        throw BadFrame(file.string() + ": cannot open this picture");
    std::vector<uint8_t> bytes(size);
    if (!stream.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(size)))
        throw BadFrame(file.string() + ": cannot read this picture");
    return bytes;
}

} // namespace vdna::frames
