// Pictures with their position in the file name: @UTM_EAST@UTM_NORTH@ZONE@...@.jpg.
#include <charconv>

#include <vdna/identity.h>

#include "frames/dataset.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

namespace
{

namespace fs = std::filesystem;

// The fields between the '@' of a file name.
std::vector<std::string> fields_of(const fs::path &file)
{
    const std::string name = file.filename().string();
    std::vector<std::string> fields;
    for (size_t at = 0; at < name.size() && name[at] == '@';) {
        const size_t next = std::min(name.find('@', at + 1), name.size());
        fields.push_back(name.substr(at + 1, next - at - 1));
        at = next;
    }
    return fields;
}

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
    const std::vector<std::string> fields = fields_of(file);
    if (fields.size() < 3)
        throw Error(file.string() + ": expected a name that begins with @UTM_EAST@UTM_NORTH@");
    if (zone.empty())
        zone = fields[2];
    // Eastings of two zones have different origins.
    if (fields[2] != zone)
        throw Error(file.string() + ": lies in UTM zone " + fields[2] + ", expected zone " + zone +
                    " as the first picture");
    Label label;
    label.position = {{metres(file, fields[0]), metres(file, fields[1]), 0}};
    label.position_frame = "utm-" + zone;
    vdna_name_replace(label.position_frame.data());
    return label;
}

} // namespace

Dataset load_utm(const fs::path &path)
{
    Dataset dataset;
    dataset.tolerance = 25; // metres, as in other tools that use these names
    std::string zone;
    for (const fs::path &folder : folders_in(path)) {
        DatasetTraversal traversal{folder.filename().string(), "", {}};
        for (const fs::path &file : pictures_in(folder))
            traversal.frames.push_back({file, label_of(file, zone)});
        dataset.traversals.push_back(std::move(traversal));
    }
    return dataset;
}

} // namespace vdna::frames
