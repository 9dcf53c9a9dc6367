#include "beside_program.hpp"

#include <system_error>

namespace vdna::backbone
{

namespace fs = std::filesystem;

fs::path beside_program(const char *relative)
{
    std::error_code unknown;
    const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
    return program.empty() ? program : (program.parent_path() / relative).lexically_normal();
}

} // namespace vdna::backbone
