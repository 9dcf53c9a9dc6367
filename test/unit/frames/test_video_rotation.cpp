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

// Its left half is bright.
std::string write_video(const Folder &folder)
{
    const std::string path = folder.path() / "drive.mp4";
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 5, {width, height});
    assert_true(writer.isOpened());
    cv::Mat picture(height, width, CV_8UC3, cv::Scalar::all(0));
    picture.colRange(0, width / 2).setTo(cv::Scalar::all(200));
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

void a_video_is_turned_as_its_container_says(void **)
{
    constexpr int32_t one = 1 << 16, w = 1 << 30;
    const Folder folder;
    const std::string path = write_video(folder);
    set_matrix(path, {0, one, 0, -one, 0, 0, height * one, 0, w}); // clockwise by 90 degrees
    Source source(path, {});
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.image.width, height);
    assert_int_equal(frame.image.height, width);
    // The left half is now the upper one.
    const auto level = [&](uint32_t x, uint32_t y) {
        return frame.image.data[y * frame.image.row_stride + 3 * x];
    };
    assert_in_range(level(4, 4), 180, 220);
    assert_in_range(level(height - 4, 4), 180, 220);
    assert_in_range(level(4, width - 4), 0, 20);
}

void a_video_that_says_nothing_is_left_as_it_is(void **)
{
    const Folder folder;
    Source source(write_video(folder), {});
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.image.width, width);
    assert_in_range(frame.image.data[0], 180, 220);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_video_is_turned_as_its_container_says),
        cmocka_unit_test(a_video_that_says_nothing_is_left_as_it_is),
    };
    return cmocka_run_group_tests_name("video rotation", tests, nullptr, nullptr);
}
