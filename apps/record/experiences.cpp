#include "record/experiences.hpp"

namespace vdna::record
{

namespace fs = std::filesystem;

std::vector<fs::path> experience_files(const fs::path &map)
{
    vdna_error error{};
    uint32_t count = 0;
    require(vdna_map_count(map.c_str(), &error, &count), error);
    std::vector<vdna_map_file> listed(count);
    require(vdna_map_list(map.c_str(), count, &error, listed.data(), &count), error);
    std::vector<fs::path> files;
    for (uint32_t i = 0; i < count; i++)
        files.push_back(map / listed[i].file);
    return files;
}

std::vector<Experience> open_experiences(const std::vector<std::string> &paths)
{
    std::vector<Experience> experiences;
    for (const std::string &path : paths) {
        if (!fs::is_directory(path)) {
            experiences.emplace_back(path);
            continue;
        }
        const std::vector<fs::path> files = experience_files(path);
        if (files.empty())
            throw Error(path +
                        ": no experience in this directory, expected NAME.vdna files; make "
                        "one with `vdna build " +
                        path + " SOURCE`");
        for (const fs::path &file : files)
            experiences.emplace_back(file);
    }
    return experiences;
}

} // namespace vdna::record
