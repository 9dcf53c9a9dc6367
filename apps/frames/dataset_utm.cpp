// Pictures with their position in the file name: @UTM_EAST@UTM_NORTH@ZONE@...@.jpg.
#include <charconv>

#include <vdna/cpp/error.hpp>
#include <vdna/identity.h>

#include "frames/dataset.hpp"
#include "frames/utm_name.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

double metres(const fs::path &file, const std::string &field)
{
    const char *end = field.data() + field.size();
    double value = 0;
    const auto result = std::from_chars(field.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !(value > -1e9 && value < 1e9))
        throw Error(file.string() + ": '" + field +
                    "' is no UTM coordinate, expected a name like @551187.03@4182105.11@10@S@.jpg");
    return value;
}

Label label_of(const fs::path &file, std::string &zone)
{
    const UtmName name = utm_name_of(file);
    if (name.east.empty() || name.north.empty())
        throw Error(file.string() + ": expected a name that begins with @UTM_EAST@UTM_NORTH@");
    if (zone.empty())
        zone = name.zone;
    // Eastings of two zones have different origins.
    if (name.zone != zone)
        throw Error(file.string() + ": lies in UTM zone " + name.zone + ", expected zone " + zone +
                    " as the first picture");
    Label label;
    label.position = {{metres(file, name.east), metres(file, name.north), 0}};
    label.position_frame = "utm-" + zone;
    vdna_name_replace(label.position_frame.data());
    return label;
}

} // namespace

Dataset load_utm(const fs::path &path, const DatasetOptions &options)
{
    Dataset dataset;
    dataset.tolerance = 25; // metres, as in other tools that use these names
    std::string zone;
    for (const fs::path &folder : traversal_folders(path, options, dataset.notes))
        dataset.traversals.push_back(
            traversal_of(folder, list_pictures(folder, nullptr), [&](const ListedPicture &picture) {
                return label_of(picture.file, zone);
            }));
    return dataset;
}

} // namespace vdna::frames
