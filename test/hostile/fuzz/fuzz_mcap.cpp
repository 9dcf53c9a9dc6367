// Any bytes as an MCAP file: refused with a sentence about the file, or read to its end, each frame
// with a picture or a complaint.
//
// The first byte chooses between the camera's frames and the positions.
#include <cstring>
#include <iostream>
#include <iterator>

#include "frames/mcap_log.hpp"
#include "frames/source.hpp"
#include "mcap_bytes.hpp"
#include "memory_file.hpp"

using namespace vdna::frames;

static void read_frames(const std::string &path)
{
    const std::unique_ptr<Reader> reader = open_mcap(path, {});
    uint64_t frames = 0;
    for (Frame frame;;)
        try {
            if (!reader->read(frame))
                break;
            frames++;
            MUST(frame.image.size == 0 || frame.image.data != nullptr);
        } catch (const BadFrame &bad) {
            frames += std::strstr(bad.what(), ": frame ") != nullptr;
        }
    MUST(frames == reader->size());
}

static void read_track(const std::string &path)
{
    const Track track = read_mcap_track({path}, "/topic", 1000000);
    MUST(track.size() >= 1 && track.begin_utime() <= track.end_utime());
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static MemoryFile file;
    if (size == 0)
        return 0;
    std::cerr.rdbuf(nullptr); // what was left out
    file.hold(bytes + 1, size - 1);
    try {
        bytes[0] % 2 == 0 ? read_frames(file.path()) : read_track(file.path());
    } catch (const vdna::Error &error) {
        MUST(std::strstr(error.what(), file.path().c_str()) != nullptr);
    }
    return 0;
}

// Two messages of a type, in the open and in chunks.
static std::string seed_of(const mcap::Sample &sample)
{
    const std::string messages = mcap::schema(1, sample.schema) +
                                 mcap::channel(1, 1, "/topic", sample.encoding) +
                                 mcap::message(1, 1700000000000000, sample.of(1700000000000000)) +
                                 mcap::message(1, 1700000001000000, sample.of(1700000001000000));
    return mcap::header() + messages + mcap::chunk(messages, "") + mcap::chunk(messages, "lz4") +
           mcap::chunk(messages, "zstd") + mcap::end();
}

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    constexpr unsigned pictures = std::size(mcap::pictures),
                       all = pictures + std::size(mcap::fixes);
    if (index >= all)
        return 0;
    const bool is_picture = index < pictures;
    const std::string seed =
        seed_of(is_picture ? mcap::pictures[index] : mcap::fixes[index - pictures]);
    if (seed.size() >= capacity)
        return 0;
    out[0] = is_picture ? 0 : 1;
    std::memcpy(out + 1, seed.data(), seed.size());
    return 1 + seed.size();
}
