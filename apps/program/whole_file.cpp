#include "program/whole_file.hpp"

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <vdna/cpp/error.hpp>

namespace vdna::program
{

void write_whole_file(const std::string &path, const std::string &bytes)
{
    // Two processes may write the same file at once.
    const std::string part = path + "." + std::to_string(getpid()) + ".part";
    std::ofstream stream(part, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    std::error_code failure;
    if (stream)
        std::filesystem::rename(part, path, failure);
    if (!stream || failure) {
        std::error_code unused;
        std::filesystem::remove(part, unused);
        throw Error(path + ": cannot write this file" + (failure ? ": " + failure.message() : ""));
    }
}

} // namespace vdna::program
