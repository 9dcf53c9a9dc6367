#include "model.hpp"

#include <sha2.h>
#include <string_view>

#include "failure.hpp"
#include "read_file.hpp"

namespace vdna
{

namespace
{

constexpr size_t file_max = size_t{1} << 31; // what protobuf can hold

std::string sha256_of(const std::string &bytes)
{
    char text[SHA256_DIGEST_STRING_LENGTH];
    SHA256Data(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size(), text);
    return text;
}

// Weights in a second file would be looked for in the current directory and loaded unhashed. Every
// tensor kept outside carries the protobuf entry {1: "location", 2: its file}; ten bytes that do
// not turn up in weights by chance.
bool has_external_data(const std::string &bytes)
{
    return std::string_view(bytes).find("\x0a\x08location") != std::string_view::npos;
}

} // namespace

std::string read_model(const std::filesystem::path &file, const std::string &sha256)
{
    std::string bytes = read_file(file, file_max);
    // A damaged model may well load and run: a third of them do.
    const std::string found = sha256_of(bytes);
    if (found != sha256)
        throw Failure(VDNA_ERR_CHECKSUM, file.string() + ": its SHA-256 is " + found +
                                             ", the manifest expects " + sha256 +
                                             "; fetch the model again or correct the manifest");
    if (has_external_data(bytes))
        throw Failure(VDNA_ERR_UNSUPPORTED,
                      file.string() + ": keeps weights in another file, which the SHA-256 does not "
                                      "cover; save it as one file");
    return bytes;
}

} // namespace vdna
