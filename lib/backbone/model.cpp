#include "model.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include <sha2.h>
#include <unistd.h>

#include "failure.hpp"
#include "sha256.h"

namespace vdna::backbone
{

namespace
{

constexpr size_t file_max = size_t{1} << 31; // what protobuf can hold
constexpr size_t piece = size_t{1} << 18;    // read at a time

// Weights in a second file would be loaded unhashed. Every tensor kept outside carries the protobuf
// entry {1: "location", 2: its file}; ten bytes that do not turn up in weights by chance.
constexpr std::string_view external = "\x0a\x08location";

// Add bytes to a hash: whole blocks by instructions, where the processor has them and no block is
// begun; the rest by libmd.
void update(SHA2_CTX &hash, const uint8_t *bytes, size_t size)
{
    constexpr uint64_t block_bits = 8 * VDNA_SHA256_BLOCK;
    const size_t blocks = hash.bitcount[0] % block_bits == 0 ? size / VDNA_SHA256_BLOCK : 0;
    size_t done = 0;
    if (vdna_sha256_by_instruction(hash.state.st32, bytes, blocks)) {
        done = blocks * VDNA_SHA256_BLOCK;
        hash.bitcount[0] += blocks * block_bits;
    }
    SHA256Update(&hash, bytes + done, size - done);
}

struct Content {
    std::string sha256;
    bool external_data = false;
};

// Look at all of a file, a piece at a time, each behind the end of the one before it: what is
// looked for may stand on both.
Content content_of(OpenFile &file)
{
    Content content;
    SHA2_CTX hash;
    SHA256Init(&hash);
    std::vector<char> bytes(external.size() - 1 + piece);
    size_t kept = 0;
    while (const size_t count = file.read(bytes.data() + kept, piece)) {
        update(hash, reinterpret_cast<const uint8_t *>(bytes.data() + kept), count);
        const std::string_view seen(bytes.data(), kept + count);
        content.external_data |= seen.find(external) != std::string_view::npos;
        kept = std::min(seen.size(), external.size() - 1);
        std::copy(seen.end() - kept, seen.end(), bytes.begin());
    }
    char text[SHA256_DIGEST_STRING_LENGTH];
    content.sha256 = SHA256End(&hash, text);
    return content;
}

} // namespace

Model::Model(const std::filesystem::path &file, const std::string &sha256) : file_(file, file_max)
{
    const Content content = content_of(file_);
    // A damaged model may well load and run: a third of them do.
    if (content.sha256 != sha256)
        throw fail::Failure(VDNA_ERR_CHECKSUM,
                            name().string() + ": its SHA-256 is " + content.sha256 +
                                ", the manifest expects " + sha256 +
                                "; fetch the model again or correct the manifest");
    if (content.external_data)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            name().string() +
                                ": keeps weights in another file, which the SHA-256 does not "
                                "cover; save it as one file");
}

std::string Model::path() const
{
    const std::string path = "/proc/self/fd/" + std::to_string(file_.descriptor());
    if (access(path.c_str(), R_OK) != 0)
        throw fail::Failure(VDNA_ERR_IO, name().string() + ": cannot be loaded through " + path +
                                             ": " + std::strerror(errno) + "; mount /proc");
    return path;
}

} // namespace vdna::backbone
