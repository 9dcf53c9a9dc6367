// parked_of FILE...: looks at picture files as the frames of one camera, each of which is answered
// in full unless it is parked. Prints a line for each: 1 if it is parked or else 0, and the number
// of the frame that it was compared with, from 0, with a tab between.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include <vdna/parked.h>

#include "failure.hpp"
#include "picture/files/file_converter.hpp"
#include "selectord/config.hpp"
#include "selectord/glance.hpp"

namespace
{

vdna_parked_picture measure(const char *path, vdna::selectord::Glance &glance)
{
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    vdna::picture::FileConverter converter;
    const vdna_image image =
        converter.convert(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size());
    vdna_parked_picture picture;
    if (!glance.look(image, picture))
        throw vdna::fail::Failure(VDNA_ERR_FORMAT, "cannot be decoded");
    return picture;
}

} // namespace

int main(int argc, char **argv)
{
    const double limit = vdna::selectord::Config().parked;
    vdna_parked parked;
    if (vdna_parked_init(&parked, static_cast<uint32_t>(100 * limit)) != VDNA_OK)
        return 1;
    vdna::selectord::Glance glance(VDNA_IMAGE_PIXELS_MAX);
    int reference = 0;
    for (int i = 1; i < argc; i++) {
        try {
            const vdna_parked_picture picture = measure(argv[i], glance);
            const bool is_parked = vdna_parked_look(&parked, &picture) != 0;
            std::printf("%d\t%d\n", is_parked, reference);
            if (is_parked)
                continue;
            vdna_parked_keep(&parked);
            reference = i - 1;
        } catch (const vdna::fail::Failure &failure) {
            return std::fprintf(stderr, "parked_of: %s: %s\n", argv[i], failure.what()), 1;
        }
    }
    return 0;
}
