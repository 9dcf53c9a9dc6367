// Pictures within a report, and files that are missing or no pictures.
#include "cmocka.hpp"
#include "folder.hpp"
#include "report/picture.hpp"

namespace
{

bool contains(const std::string &text, const std::string &part)
{
    return text.find(part) != std::string::npos;
}

void a_photo_gets_smaller_and_keeps_its_shape(void **)
{
    const Folder folder;
    const std::string html = vdna::report::photo(
        folder.write("a.pgm", "P5\n320 80\n255\n" + std::string(320 * 80, 'x')), "");
    assert_true(contains(html, "width=\"160\" height=\"40\""));
    assert_true(contains(html, "src=\"data:image/jpeg;base64,/9j/")); // FF D8 FF begins a JPEG
}

void a_picture_that_is_gone_is_said_to_be(void **)
{
    const Folder folder;
    for (const std::filesystem::path &file :
         {folder.path() / "missing.jpg", std::filesystem::path(folder.write("empty.jpg", "")),
          std::filesystem::path(folder.write("text.jpg", "no picture")),
          std::filesystem::path(folder.write("broken.pgm", "P5\n99999999 99999999\n255\n"))}) {
        const std::string html = vdna::report::photo(file, "");
        assert_true(contains(html, "cannot be read any more"));
        assert_false(contains(html, "<img"));
    }
}

void shades_are_a_png_no_larger_than_asked_for(void **)
{
    const vdna::report::Shades shades = {2, 3, {0, 1, 2, 3, 4, 5}, 0, 5};
    assert_true(contains(vdna::report::shades_picture(shades, 9, ""), "width=\"3\" height=\"2\""));
    const std::string html = vdna::report::shades_picture(shades, 1, "a \"matrix\"");
    assert_true(contains(html, "width=\"1\" height=\"1\" alt=\"a &quot;matrix&quot;\""));
    assert_true(contains(html, "src=\"data:image/png;base64,iVBORw0KGgo")); // a PNG's signature
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_photo_gets_smaller_and_keeps_its_shape),
        cmocka_unit_test(a_picture_that_is_gone_is_said_to_be),
        cmocka_unit_test(shades_are_a_png_no_larger_than_asked_for),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
