#include "beside_program.hpp"

#include <string>
#include <system_error>

#include <dlfcn.h>
#include <link.h>

namespace vdna::backbone
{

namespace fs = std::filesystem;

namespace
{

// The shared library that this code is in; empty if it is in the program itself.
std::string own_library()
{
    Dl_info unused;
    link_map *map = nullptr;
    static const char here = 0;
    if (!dladdr1(&here, &unused, reinterpret_cast<void **>(&map), RTLD_DL_LINKMAP) || !map)
        return "";
    return map->l_name; // "" is the program
}

} // namespace

fs::path beside_program(const char *relative)
{
    std::error_code unknown;
    const std::string library = own_library();
    const fs::path folder =
        library.empty() ? fs::read_symlink("/proc/self/exe", unknown).parent_path()
                        : fs::absolute(library, unknown).parent_path() / VDNA_INSTALLED_PROGRAMS;
    return unknown ? fs::path() : (folder / relative).lexically_normal();
}

} // namespace vdna::backbone
