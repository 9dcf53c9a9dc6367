#include "program/replaced_file.hpp"

#include <filesystem>

#include <vdna/cpp/error.hpp>

#include "replace/replace.h"

namespace vdna::program
{

void replace_file(const std::string &path, const std::string &bytes, Durability durability)
{
    vdna_error error{};
    vdna_replace file;
    require(vdna_replace_begin(path.c_str(), &error, &file), error);
    if (vdna_replace_write(&file, bytes.data(), bytes.size(), &error) != VDNA_OK) {
        vdna_replace_abandon(&file);
        throw Error(error.text);
    }
    const bool durable = durability == Durability::durable;
    require(vdna_replace_commit(&file, durable ? VDNA_REPLACE_DURABLE : VDNA_REPLACE_QUICK, &error),
            error);
}

void make_directory(const std::string &directory)
{
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);
    if (failure)
        throw Error(directory + ": cannot make this directory: " + failure.message());
}

} // namespace vdna::program
