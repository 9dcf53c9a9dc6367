// Any bytes as the configuration of the daemon: refused with a sentence about the file, or read,
// and then what --print-config makes of it reads back as the same.
#include <cstring>
#include <sstream>

#include "memory_file.hpp"
#include "program/exit_code.hpp"
#include "selectord/config.hpp"

using namespace vdna;
using namespace vdna::selectord;

static std::string printed(const Config &config)
{
    std::ostringstream out;
    print_config(config, out);
    return out.str();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static MemoryFile file, again;
    file.hold(bytes, size);
    try {
        const std::string text = printed(read_config(file.path()));
        again.hold(text.data(), text.size());
        MUST(printed(read_config(again.path())) == text);
    } catch (const program::UsageError &error) {
        MUST(std::strncmp(error.what(), (file.path() + ":").c_str(), file.path().size() + 1) == 0);
    }
    return 0;
}

// The defaults, every other setting, and dates, arrays and tables where none belong.
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    const std::string seeds[] = {
        printed(Config()),
        "[map]\ndirectory = '/m'\ncopy = false\n[warmup]\nseconds = 12.5\nframes_min = 3\n"
        "[localise]\nmin_confidence = 0.5\ntolerance = 1e3\n[cpu]\naffinity = \"0,2-3\"\nnice = "
        "-5\n",
        "[lcm]\nurl = \"\"\"udpm://239.255.76.67:7667?ttl=1\"\"\"\nsources = \"10.0.0.2\"\n"
        "camera = \"A\\u00e9\\n\"\nmax_image_bytes = 0x10_0000\nlate_seconds = inf\n",
        "lcm.camera = 'C'\ncpu = {nice = +1}\n[memory]\nlock = [true, {a = 1979-05-27T07:32:00Z}]\n"
        "[[select]]\ntop = nan\n"};
    if (index >= sizeof seeds / sizeof *seeds || seeds[index].size() > capacity)
        return 0;
    std::memcpy(out, seeds[index].data(), seeds[index].size());
    return seeds[index].size();
}
