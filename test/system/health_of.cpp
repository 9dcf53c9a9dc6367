// health_of FILE...: judges picture files as the frames of one camera. Prints a line for each:
// verdict, contrast, structure, grain and bright as in vdna/health.h, and the file, with tabs
// between.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include <vdna/health.h>
#include <vdna/picture.h>

#include "failure.hpp"
#include "picture/files/file_converter.hpp"

namespace
{

vdna_health_picture measure(const char *path, vdna_decoder *decoder)
{
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    vdna::picture::FileConverter converter;
    const vdna_image image =
        converter.convert(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size());
    vdna_error error{};
    vdna_pixels pixels;
    vdna_status status = vdna_decoder_decode(decoder, &image, &error, &pixels);
    if (status != VDNA_OK)
        throw vdna::fail::Failure(status, error.text);
    vdna_health_picture picture;
    status = vdna_health_measure(&pixels, &picture);
    if (status != VDNA_OK)
        throw vdna::fail::Failure(status, vdna_status_text(status));
    return picture;
}

} // namespace

int main(int argc, char **argv)
{
    vdna_decoder *decoder = nullptr;
    vdna_health health;
    if (vdna_decoder_open(VDNA_IMAGE_PIXELS_MAX, nullptr, &decoder) != VDNA_OK ||
        vdna_health_init(&health, nullptr) != VDNA_OK)
        return 1;
    for (int i = 1; i < argc; i++) {
        try {
            const vdna_health_picture picture = measure(argv[i], decoder);
            const uint32_t verdict = vdna_health_take(&health, &picture);
            std::printf("%s\t%u\t%u\t%u\t%u\t%s\n", vdna_health_text(verdict), picture.contrast,
                        picture.structure, picture.grain, picture.bright, argv[i]);
        } catch (const vdna::fail::Failure &failure) {
            return std::fprintf(stderr, "health_of: %s: %s\n", argv[i], failure.what()), 1;
        }
    }
    vdna_decoder_close(decoder);
    return 0;
}
