// CSV tables of labels: contents and refusals.
#include <cstring>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/labels.hpp"

using vdna::frames::Labels;

namespace
{

// A folder with one table, t.csv.
struct Table : Folder {
    explicit Table(const std::string &text) : csv(write("t.csv", text)) {}
    vdna::frames::Label label(const std::string &file) const
    {
        return Labels(csv).find(path() / file, 0);
    }
    vdna::frames::Label label(uint64_t frame) const { return Labels(csv).find("", frame); }
    std::filesystem::path csv;
};

// The complaint about a table, without the folder's name; "" if it is accepted.
std::string refusal_of(const std::string &text)
{
    const Table table(text);
    try {
        const Labels labels(table.csv);
    } catch (const vdna::Error &e) {
        return std::string(e.what()).substr(table.path().string().size() + 1);
    }
    return "";
}

void assert_refused(const std::string &text, const std::string &sentence)
{
    assert_string_equal(refusal_of(text).c_str(), sentence.c_str());
}

void assert_position(const vdna::frames::Label &label, double x, double y, double z)
{
    assert_true(label.position.has_value());
    const double expected[] = {x, y, z};
    for (size_t i = 0; i < 3; i++)
        assert_float_equal((*label.position)[i], expected[i], 1e-3);
}

void places_belong_to_files_beside_the_table(void **)
{
    const Table table("file,place\na.jpg,7\nsub/b.jpg,-9223372036854775808\n");
    assert_int_equal(*table.label("a.jpg").place, 7);
    assert_true(*table.label("sub/b.jpg").place == INT64_MIN);
    assert_false(table.label("a.jpg").position.has_value());
    assert_false(table.label("a.jpg").utime.has_value());
}

void a_path_is_found_however_it_is_written(void **)
{
    const Table table("file,place\n./sub/../a.jpg,7\n");
    std::filesystem::create_directory(table.path() / "sub");
    assert_int_equal(*table.label("sub/../a.jpg").place, 7);
    assert_int_equal(*table.label("a.jpg").place, 7);
}

void metres_are_taken_as_they_are(void **)
{
    assert_position(Table("file,x,y\na.jpg,1.5,-2\n").label("a.jpg"), 1.5, -2, 0);
    assert_position(Table("z,y,x,file\n3,2,1e3,a.jpg\n").label("a.jpg"), 1000, 2, 3);
}

void degrees_become_earth_centred_metres(void **)
{
    const double a = 6378137, b = 6356752.3142; // WGS84 semi-axes
    const Table table("file,lat,lon,alt\n0.jpg,0,0,0\n1.jpg,0,90,10\n2.jpg,-90,0,0\n");
    assert_position(table.label("0.jpg"), a, 0, 0);
    assert_position(table.label("1.jpg"), 0, a + 10, 0);
    assert_position(table.label("2.jpg"), 0, 0, -b);
    assert_position(Table("file,lat,lon\n0.jpg,0,180\n").label("0.jpg"), -a, 0, 0);
}

void times_may_stand_alone_or_beside_places(void **)
{
    assert_true(*Table("file,utime\na.jpg,1700000000000000\n").label("a.jpg").utime ==
                1700000000000000);
    const vdna::frames::Label both = Table("file,utime,place\na.jpg,5,6\n").label("a.jpg");
    assert_int_equal(*both.utime, 5);
    assert_int_equal(*both.place, 6);
}

void frames_are_found_by_index(void **)
{
    const Table table("frame,place\n0,10\n12,20\n");
    assert_int_equal(*table.label(12).place, 20);
}

void quoted_fields_byte_order_marks_and_crlf_are_read(void **)
{
    const Table table("\xEF\xBB\xBF"
                      "file,note,place\r\n\"a,b.jpg\",\"two\r\nlines, \"\"quoted\"\"\",3\r\n\r\n");
    assert_int_equal(*table.label("a,b.jpg").place, 3);
}

void the_last_line_needs_no_end(void **)
{
    assert_int_equal(*Table("file,place\na.jpg,4").label("a.jpg").place, 4);
}

void other_columns_are_ignored(void **)
{
    const Table table("file,experience,order,place,gt_tol,source\na.jpg,winter,0,8,64,x y\n");
    assert_int_equal(*table.label("a.jpg").place, 8);
}

void a_frame_without_a_row_is_named(void **)
{
    const Table table("file,place\na.jpg,1\n");
    try {
        table.label("b.jpg");
    } catch (const vdna::Error &e) {
        const std::string expected = table.csv.string() + ": no row about " +
                                     (table.path() / "b.jpg").string() +
                                     ", expected one for every frame; add it";
        assert_string_equal(e.what(), expected.c_str());
        return;
    }
    fail_msg("a picture without a row was accepted");
}

void a_table_of_files_does_not_serve_a_video(void **)
{
    const Table table("file,place\na.jpg,1\n");
    try {
        table.label(uint64_t{0});
    } catch (const vdna::Error &e) {
        assert_non_null(std::strstr(e.what(), "expected the column frame"));
        return;
    }
    fail_msg("a table without the column frame was accepted");
}

void a_bad_cell_is_told_with_file_line_and_column(void **)
{
    const char *whole = ", expected a whole number";
    assert_refused("file,place\na,1\n\nb,1.5\n", std::string("t.csv:4: place is '1.5'") + whole);
    assert_refused("file,place\na,\n", std::string("t.csv:2: place is ''") + whole);
    assert_refused("file,place\na, 1\n", std::string("t.csv:2: place is ' 1'") + whole);
    assert_refused("file,place\na,9223372036854775808\n",
                   std::string("t.csv:2: place is '9223372036854775808'") + whole);
    assert_refused("frame,place\n-1,1\n", "t.csv:2: frame is '-1', expected a number from 0");
    assert_refused("file,lat,lon\na,90.5,0\n",
                   "t.csv:2: lat is '90.5', expected a decimal number within +-90");
    for (const char *bad : {"nan", "inf", "1e400", "1,5"})
        assert_non_null(std::strstr(
            refusal_of("file,x,y\n" + std::string("a,") + bad + ",2\n").c_str(), "t.csv:2: "));
}

void a_row_of_another_width_is_refused(void **)
{
    assert_refused("file,place\na,1\nb,2,3\n",
                   "t.csv:3: found 3 fields, expected 2 as in the header");
}

void a_file_twice_is_refused(void **)
{
    assert_refused("file,place\na,1\n./a,2\n",
                   "t.csv:3: file is './a', expected each one only once");
}

void an_open_quote_is_told_where_it_began(void **)
{
    assert_refused("file,place\n\"a,1\nb,2\n", "t.csv:2: a quoted field is never closed");
    assert_refused("file,place\n\"a\"b,1\n",
                   "t.csv:2: expected a comma or the end of the line after a field");
}

void a_header_without_labels_or_without_keys_is_refused(void **)
{
    assert_refused("", "t.csv: empty, expected a CSV header");
    assert_refused("place\n1\n", "t.csv: no column 'file' or 'frame', expected one that says which "
                                 "picture or frame a row is about");
    assert_refused("file,x\na,1\n", "t.csv: no column with a label, expected place, or x,y[,z], or "
                                    "lat,lon[,alt], or utime");
    assert_refused("file,x,y,lat,lon\na,1,2,3,4\n", "t.csv: columns x,y and lat,lon both give a "
                                                    "position, expected one of them");
    assert_refused("file,place,file\na,1,b\n", "t.csv:1: two columns are called 'file'");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(places_belong_to_files_beside_the_table),
        cmocka_unit_test(a_path_is_found_however_it_is_written),
        cmocka_unit_test(metres_are_taken_as_they_are),
        cmocka_unit_test(degrees_become_earth_centred_metres),
        cmocka_unit_test(times_may_stand_alone_or_beside_places),
        cmocka_unit_test(frames_are_found_by_index),
        cmocka_unit_test(quoted_fields_byte_order_marks_and_crlf_are_read),
        cmocka_unit_test(the_last_line_needs_no_end),
        cmocka_unit_test(other_columns_are_ignored),
        cmocka_unit_test(a_frame_without_a_row_is_named),
        cmocka_unit_test(a_table_of_files_does_not_serve_a_video),
        cmocka_unit_test(a_bad_cell_is_told_with_file_line_and_column),
        cmocka_unit_test(a_row_of_another_width_is_refused),
        cmocka_unit_test(a_file_twice_is_refused),
        cmocka_unit_test(an_open_quote_is_told_where_it_began),
        cmocka_unit_test(a_header_without_labels_or_without_keys_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
