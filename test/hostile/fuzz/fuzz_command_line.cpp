// Any arguments of vdna and vdna_selectord: parsed, or refused with a sentence. Commands are not
// run; configuration files are read, and nothing is written.
//
// The first byte chooses the program; the rest are its arguments, each ended by a NUL.
#include <algorithm>
#include <cstring>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>

#include "fuzz.h"
#include "selectord/command_line.hpp"
#include "vdna/command_line.hpp"

// vdna, made once, since that takes longer than parsing.
struct Tool {
    std::unique_ptr<CLI::App> app = vdna::tool::command_line();

    Tool()
    {
        app->parse_complete_callback([] { throw CLI::Success(); }); // before a command's work
        std::cout.rdbuf(nullptr);                                   // --help
    }
};

static std::vector<std::string> arguments_of(const uint8_t *bytes, size_t size)
{
    constexpr size_t most = 64;
    std::vector<std::string> arguments;
    while (size > 0 && arguments.size() < most) {
        const size_t length = static_cast<size_t>(std::find(bytes, bytes + size, 0) - bytes);
        arguments.emplace_back(reinterpret_cast<const char *>(bytes), length);
        const size_t used = std::min(length + 1, size);
        bytes += used;
        size -= used;
    }
    return arguments;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size == 0)
        return 0;
    const std::vector<std::string> arguments = arguments_of(bytes + 1, size - 1);
    std::vector<const char *> argv = {"program"};
    for (const std::string &argument : arguments)
        argv.push_back(argument.c_str());
    argv.push_back(nullptr);
    const int argc = static_cast<int>(argv.size()) - 1;
    static Tool tool;
    try {
        if (bytes[0] % 2)
            vdna::selectord::read_command_line(argc, argv.data());
        else
            tool.app->parse(argc, argv.data());
    } catch (const CLI::ParseError &) {
    } catch (const vdna::Error &error) {
        MUST(error.what()[0] != '\0');
    }
    return 0;
}

static const char *const lines[] = {
    "vdna rank --warmup 42 --exclude winter --per-tap --json today/ park",
    "vdna rank park/winter.vdna park/summer.vdna",
    "vdna build --backbone efficientnet_lite0 --threads 2 --rate 2.5 --every 5 --skip-bad a b -o m",
    "vdna build --range-rule zero --labels l.csv --frame hall --gps t.gpx --gps-gap 1 a -o m",
    "vdna export a b.vdna --c-array -o c.c",
    "vdna calibrate --time-unit ms --late 0.5 --time-offset -3.5 a -o r.json",
    "vdna localise --time-offset 2024-05-01T12:00:00Z --with-altitude today park",
    "vdna play --camera CAMERA -l udpm://239.255.76.67:7667?ttl=0 --rate 10 a",
    "vdna camera --size 640x480 /dev/video0",
    "vdna simulate out --condition dusk --seed 3 --frames 240 --step 0.7 --size 160x120",
    "vdna eval data --warmup 45s --format nordland --stride 5",
    "vdna command pin winter --channel C --timeout 2 --no-wait",
    "vdna doctor -c vdna.toml --map m -l udpm://x --for 2.5 --json",
    "vdna --help",
    "vdna_selectord -c /nowhere.toml --map m --backbone b --warmup-frames 50 -l udpm://x",
    "vdna_selectord --warmup-seconds 4.5 --answers a.jsonl --print-memory --json",
    "vdna_selectord --print-config --check --version"};

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index >= std::size(lines))
        return 0;
    const std::string line = lines[index];
    const size_t name = line.find(' ');
    if (line.size() - name > capacity)
        return 0;
    out[0] = line.compare(0, name, "vdna") != 0;
    std::replace_copy(line.begin() + static_cast<ptrdiff_t>(name) + 1, line.end(), out + 1, ' ',
                      '\0');
    return line.size() - name;
}
