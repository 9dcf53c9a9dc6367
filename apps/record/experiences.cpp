#include "record/experiences.hpp"

#include <algorithm>

namespace vdna::record
{

namespace fs = std::filesystem;

std::vector<fs::path> experience_files(const fs::path &map)
{
    std::error_code failure;
    std::vector<fs::path> files;
    for (fs::directory_iterator file(map, failure), end; !failure && file != end;
         file.increment(failure))
        if (file->path().extension() == VDNA_MAP_EXTENSION &&
            file->path().filename().string()[0] != '.')
            files.push_back(*file);
    if (failure)
        throw Error(map.string() + ": cannot read this map directory: " + failure.message());
    std::sort(files.begin(), files.end());
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
