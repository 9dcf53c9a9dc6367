// process_cost MANIFEST PICTURE FRAMES: run a picture through the network in this process and in
// one of its own, in turn, FRAMES times each, and print the medians in microseconds.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <vector>

#include "program/clock.hpp"
#include "selectord/backbone_child.hpp"
#include "selectord/backbone_process.hpp"

namespace
{

using namespace vdna;
using namespace vdna::selectord;

std::vector<uint8_t> read_file(const char *path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int64_t time_of(const Backbone &backbone, const vdna_image &image)
{
    const int64_t begin_us = program::monotonic_us();
    vdna_error error{};
    vdna_backbone_frame frame;
    require(vdna_backbone_run(backbone.get(), &image, &error, &frame), error);
    return program::monotonic_us() - begin_us;
}

int64_t median(std::vector<int64_t> times)
{
    std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2),
                     times.end());
    return times[times.size() / 2];
}

void measure(const char *manifest, const char *picture, int frames)
{
    Config config;
    config.manifest = manifest;
    const std::vector<uint8_t> jpeg = read_file(picture);
    const vdna_image image{jpeg.data(), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG};
    const Backbone inside(config.manifest, config.threads, "", config.max_image_pixels);
    BackboneProcess process(config);
    const Backbone outside = process.open();
    std::vector<int64_t> within, beside;
    for (int i = 0; i < frames; i++) {
        within.push_back(time_of(inside, image));
        beside.push_back(time_of(outside, image));
    }
    std::printf("%lld %lld\n", static_cast<long long>(median(within)),
                static_cast<long long>(median(beside)));
}

} // namespace

int main(int argc, char **argv)
{
    if (is_backbone_child(argc, argv))
        return run_backbone_child();
    if (argc != 4)
        return std::fprintf(stderr, "usage: process_cost MANIFEST PICTURE FRAMES\n"), 2;
    signal(SIGPIPE, SIG_IGN);
    try {
        measure(argv[1], argv[2], std::atoi(argv[3]));
    } catch (const std::exception &error) {
        return std::fprintf(stderr, "process_cost: %s\n", error.what()), 1;
    }
    return 0;
}
