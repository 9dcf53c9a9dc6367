// A video that says that it is turned gives upright pictures.
#include <fstream>
#include <iterator>
#include <string>

#include <cmocka.hpp>
#include <folder.hpp>
#include <opencv2/videoio.hpp>

#include "frames/source.hpp"

namespace
{

using vdna::frames::Frame;
using vdna::frames::Source;

const int width = 64, height = 48;

// Its upper left corner is bright.
std::string write_video(const Folder &folder)
{
    const std::string path = folder.path() / "drive.mp4";
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 5, {width, height});
    assert_true(writer.isOpened());
    cv::Mat picture(height, width, CV_8UC3, cv::Scalar::all(0));
    picture(cv::Rect(0, 0, width / 2, height / 2)).setTo(cv::Scalar::all(200));
    for (int i = 0; i < 3; i++)
        writer.write(picture);
    return path;
}

// Write the matrix of a track, which says how to turn it: a, b, u, c, d, v, x, y, w.
void set_matrix(const std::string &path, const int32_t (&matrix)[9])
{
    std::ifstream in(path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(in)), {});
    const size_t header = bytes.find("tkhd");
    assert_true(header != std::string::npos);
    size_t at = header + 4 + 40; // of version 0
    for (const int32_t number : matrix)
        for (int shift = 24; shift >= 0; shift -= 8)
            bytes[at++] = static_cast<char>(static_cast<uint32_t>(number) >> shift);
    std::ofstream(path, std::ios::binary) << bytes;
}

// Level of the picture `x` from the left and `y` from the top, in eighths.
int level(const Frame &frame, uint32_t x, uint32_t y)
{
    const vdna_image &image = frame.image;
    return image.data[y * image.height / 8 * image.row_stride + x * image.width / 8 * 3];
}

void a_video_is_turned_as_its_container_says(void **)
{
    constexpr int32_t one = 1 << 16, w = 1 << 30;
    struct Case {
        int32_t matrix[9];
        bool swaps_sides;
        uint32_t x, y; // where the upper left corner goes, in eighths
    };
    const Case cases[] = {
        {{one, 0, 0, 0, one, 0, 0, 0, w}, false, 1, 1},
        {{0, one, 0, -one, 0, 0, height * one, 0, w}, true, 7, 1}, // clockwise by a quarter
        {{-one, 0, 0, 0, -one, 0, width * one, height * one, w}, false, 7, 7},
        {{0, -one, 0, one, 0, 0, 0, width * one, w}, true, 1, 7},
    };
    for (const Case &c : cases) {
        const Folder folder;
        const std::string path = write_video(folder);
        set_matrix(path, c.matrix);
        Source source(path, {});
        Frame frame;
        assert_true(source.next(frame));
        assert_int_equal(frame.image.width, c.swaps_sides ? height : width);
        assert_int_equal(frame.image.height, c.swaps_sides ? width : height);
        for (const uint32_t x : {1u, 7u})
            for (const uint32_t y : {1u, 7u})
                assert_int_equal(level(frame, x, y) > 100, x == c.x && y == c.y);
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_video_is_turned_as_its_container_says),
    };
    return cmocka_run_group_tests_name("video rotation", tests, nullptr, nullptr);
}
