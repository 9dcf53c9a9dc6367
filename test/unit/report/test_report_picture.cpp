// Pictures within a report, and files that are missing or no pictures.
#include "cmocka.hpp"
#include "folder.hpp"
#include "report/picture.hpp"

using namespace vdna;

namespace
{

void a_photo_gets_smaller_and_keeps_its_shape(void **)
{
    const Folder folder;
    const report::Encoded photo =
        report::photo_jpeg(folder.write("a.pgm", "P5\n320 80\n255\n" + std::string(320 * 80, 'x')));
    assert_int_equal(photo.columns, 160);
    assert_int_equal(photo.rows, 40);
    assert_true(photo.bytes[0] == 0xff && photo.bytes[1] == 0xd8); // begins a JPEG
}

void a_picture_that_is_gone_is_empty(void **)
{
    const Folder folder;
    for (const std::filesystem::path &file :
         {folder.path() / "missing.jpg", std::filesystem::path(folder.write("empty.jpg", "")),
          std::filesystem::path(folder.write("text.jpg", "no picture")),
          std::filesystem::path(folder.write("broken.pgm", "P5\n99999999 99999999\n255\n"))})
        assert_true(report::photo_jpeg(file).bytes.empty());
}

void shades_are_a_png_no_larger_than_asked_for(void **)
{
    const report::Shades shades = {2, 3, {0, 1, 2, 3, 4, 5}, 0, 5};
    assert_int_equal(report::shades_png(shades, 9).columns, 3);
    const report::Encoded small = report::shades_png(shades, 1);
    assert_true(small.columns == 1 && small.rows == 1);
    assert_true(small.bytes[0] == 0x89 && small.bytes[1] == 'P'); // begins a PNG
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_photo_gets_smaller_and_keeps_its_shape),
        cmocka_unit_test(a_picture_that_is_gone_is_empty),
        cmocka_unit_test(shades_are_a_png_no_larger_than_asked_for),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
