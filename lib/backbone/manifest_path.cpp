#include "manifest_path.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "beside_program.hpp"
#include "failure.hpp"

namespace vdna::backbone
{

namespace fs = std::filesystem;

namespace
{

constexpr const char *extension = ".toml";

std::vector<fs::path> directories()
{
    std::vector<fs::path> all;
    const char *chosen = std::getenv("VDNA_MODELS");
    for (const fs::path &directory :
         {fs::path(chosen ? chosen : ""), beside_program(VDNA_INSTALLED_MODELS),
          fs::path("/usr/share/vdna/models")})
        if (!directory.empty() && std::find(all.begin(), all.end(), directory) == all.end())
            all.push_back(directory);
    return all;
}

// "a, b" for a.toml and b.toml; a directory that cannot be read has none.
std::string names_in(const fs::path &directory)
{
    std::vector<std::string> names;
    std::error_code unreadable;
    for (const auto &entry : fs::directory_iterator(directory, unreadable))
        if (entry.path().extension() == extension)
            names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());

    std::string list;
    for (const std::string &name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list.empty() ? "none" : list;
}

} // namespace

fs::path find_manifest(const std::string &wanted)
{
    if (wanted.find('/') != std::string::npos || fs::path(wanted).extension() == extension)
        return wanted;

    std::string looked;
    for (const fs::path &directory : directories()) {
        const fs::path file = directory / (wanted + extension);
        std::error_code missing;
        if (fs::exists(file, missing))
            return file;
        looked += (looked.empty() ? "" : "; ") + directory.string() + " (has " +
                  names_in(directory) + ")";
    }
    throw fail::Failure(VDNA_ERR_IO,
                        "no backbone is called '" + wanted + "'; looked in " + looked +
                            "; give one of these names, the path of a manifest, or set "
                            "VDNA_MODELS");
}

} // namespace vdna::backbone
