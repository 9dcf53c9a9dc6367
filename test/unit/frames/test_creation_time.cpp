// The creation time of MP4 files.
#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/creation_time.hpp"

namespace
{

std::string big_endian(uint64_t value, int bytes)
{
    std::string text;
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
        text += static_cast<char>(value >> shift & 0xff);
    return text;
}

std::string box(const std::string &name, const std::string &contents)
{
    return big_endian(8 + contents.size(), 4) + name + contents;
}

std::string long_box(const std::string &name, const std::string &contents)
{
    return big_endian(1, 4) + name + big_endian(16 + contents.size(), 8) + contents;
}

constexpr uint64_t seconds_1904 = 2082844800ull + 1714564800; // 2024-05-01T12:00:00Z

std::string header(uint64_t seconds)
{
    return box("mvhd", big_endian(0, 4) + big_endian(seconds, 4) + std::string(88, '\0'));
}

std::optional<int64_t> time_of(const std::string &bytes)
{
    const Folder folder;
    return vdna::frames::creation_time_of(folder.write("v.mp4", bytes));
}

void it_is_found_behind_other_boxes(void **)
{
    const std::string start = box("ftyp", "isom") + long_box("mdat", std::string(1000, 'x'));
    for (const std::string &movie : {box("moov", header(seconds_1904)),
                                     long_box("moov", box("udta", "a") + header(seconds_1904)),
                                     box("moov", box("mvhd", big_endian(1, 1) + big_endian(0, 3) +
                                                                 big_endian(seconds_1904, 8)))})
        assert_true(time_of(start + movie) == 1714564800000000);
}

void a_file_without_one_has_none(void **)
{
    const std::string whole = box("ftyp", "isom") + box("moov", header(seconds_1904));
    for (size_t size = 0; size < whole.size() - 88 - 4; size++)
        assert_false(time_of(whole.substr(0, size)).has_value());
    assert_false(time_of(box("moov", header(0))).has_value());          // unset
    assert_false(time_of(box("moov", header(2082844800))).has_value()); // 1970: a clock never set
    assert_false(
        time_of(box("moov", box("mvhd", std::string("\1\0\0\0", 4) + big_endian(UINT64_MAX, 8))))
            .has_value());
    assert_false(time_of(std::string(16, '\0')).has_value());
    assert_false(time_of(big_endian(1, 4) + "free" + big_endian(UINT64_MAX, 8)).has_value());
    const Folder folder;
    assert_false(vdna::frames::creation_time_of(folder.path()).has_value());
    assert_false(vdna::frames::creation_time_of(folder.path() / "none").has_value());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(it_is_found_behind_other_boxes),
        cmocka_unit_test(a_file_without_one_has_none),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
