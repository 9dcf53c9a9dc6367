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
    const Table table("file,place\na.jpg,7\nsub/b.jpg,-9223372036854775807\n");
    assert_int_equal(*table.label("a.jpg").place, 7);
    assert_true(*table.label("sub/b.jpg").place == INT64_MIN + 1);
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

void a_folder_that_does_not_resolve_is_taken_as_it_is_spelt(void **)
{
    const std::string overlong(300, 'n');
    const Table table("file,place\nloop/a.jpg,7\n./" + overlong + "/b.jpg,8\nc.jpg,9\n");
    std::filesystem::create_symlink("loop", table.path() / "loop");
    assert_int_equal(*table.label("loop/a.jpg").place, 7);
    assert_int_equal(*table.label(overlong + "/b.jpg").place, 8);
    assert_int_equal(*table.label("c.jpg").place, 9);
}

void metres_are_taken_as_they_are(void **)
{
    assert_position(Table("file,x,y\na.jpg,1.5,-2\n").label("a.jpg"), 1.5, -2, 0);
    assert_position(Table("z,y,x,file\n3,2,1e3,a.jpg\n").label("a.jpg"), 1000, 2, 3);
    assert_position(Table("file, x, y\na.jpg, 0, 0\n").label("a.jpg"), 0, 0, 0); // an origin
}

void positions_say_their_frame(void **)
{
    const auto frame_of = [](const std::string &text, const char *asked) {
        const Table table(text);
        const Labels labels(table.csv, {asked, false});
        return labels.find(table.path() / "a", 0).position_frame;
    };
    assert_string_equal(frame_of("file,lat,lon\na,1,2\n", "").c_str(), "wgs84");
    assert_string_equal(frame_of("file,x,y\na,1,2\n", "").c_str(), "local");
    assert_string_equal(frame_of("file,x,y\na,1,2\n", "hall-3").c_str(), "hall-3");
    assert_string_equal(frame_of("file,x,y,position_frame\na,1,2,site\n", "").c_str(), "site");
    assert_string_equal(frame_of("file,place\na,1\n", "").c_str(), "");
    assert_refused("file,x,y,position_frame\na,1,2,site\nb,1,2,other\n",
                   "t.csv:3: position_frame is 'other', expected site as in the rows before");
    assert_refused("file,x,y,position_frame\na,1,2,my site\n",
                   "t.csv:2: position_frame is 'my site', expected the name of a local frame: 1 to "
                   "63 letters, digits, '.', '_' or '-', and not wgs84");
    const Table degrees("file,lat,lon\na,1,2\n");
    try {
        const Labels labels(degrees.csv, {"site", false});
    } catch (const vdna::Error &e) {
        assert_non_null(std::strstr(e.what(), "in frame wgs84, not site; leave out --frame"));
        return;
    }
    fail_msg("degrees became positions of a local frame");
}

void degrees_become_earth_centred_metres(void **)
{
    const double a = 6378137, b = 6356752.3142; // WGS84 semi-axes
    const Table table("file,lat,lon,alt\n0.jpg,0,360,0\n1.jpg,0,90,10\n2.jpg,-90,0,0\n");
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

void assert_no_truth(const vdna::frames::Label &label)
{
    assert_true(label.lacks_truth);
    assert_false(label.place.has_value() || label.position.has_value());
}

void a_frame_without_a_row_has_no_truth(void **)
{
    const Table table("file,place\na.jpg,1\n");
    table.write("a.jpg", "");
    table.write("b.jpg", "");
    assert_no_truth(table.label("b.jpg"));
    assert_false(table.label("a.jpg").lacks_truth);
    assert_no_truth(Table("frame,place\n0,1\n").label(7));
    const Table times("file,utime\na.jpg,1\n");
    times.write("a.jpg", "");
    assert_false(times.label("b.jpg").lacks_truth); // nobody has any
}

void a_row_with_empty_cells_has_no_truth(void **)
{
    assert_no_truth(Table("file,lat,lon\na,,\nb,1,2\n").label("a"));
    assert_no_truth(Table("file,x,y,z\na, ,,\nb,1,2,3\n").label("a"));
    assert_no_truth(Table("file,place\na,\nb,1\n").label("a"));
    const vdna::frames::Label timed = Table("file,utime,lat,lon\na,5,,\nb,6,1,2\n").label("a");
    assert_no_truth(timed);
    assert_int_equal(*timed.utime, 5);
    const vdna::frames::Label place = Table("file,place,x,y\na,5,,\nb,6,1,2\n").label("a");
    assert_false(place.lacks_truth || place.position.has_value());
    assert_position(Table("file,x,y,z\na,1,2,\n").label("a"), 1, 2, 0); // no altitude
}

// What a table tells, without the folder's name.
std::string note_of(const std::string &text)
{
    const Table table(text);
    const std::string note = Labels(table.csv).note();
    return note.empty() ? "" : note.substr(table.path().string().size() + 1);
}

void fixes_that_nobody_can_have_are_left_out_and_told(void **)
{
    const std::string text = "file,lat,lon,alt\na,0,0,5\nb,48.1,11.5,500\nc,91,11,0\nd,48,-361,0\n"
                             "e,nan,11,0\nf,48.1,,3\ng,0,0,0\nh,48,11,200000\ni,,,\nj,0.0,1,nan\n"
                             "k,N/A,none,\n";
    const Table table(text);
    for (const char *bad : {"a", "c", "d", "e", "f", "g", "h", "i", "k"})
        assert_no_truth(table.label(bad));
    assert_true(table.label("b").position.has_value());
    assert_true(table.label("j").position.has_value());
    assert_string_equal(note_of(text).c_str(),
                        "t.csv: 8 fixes left out: 1 with half of a position, 2 without a number, 2 "
                        "at 0,0, 3 beyond the globe");
    assert_string_equal(note_of("file,lat,lon\na,0,0\nb,1,1\n").c_str(),
                        "t.csv: 1 fix left out: 1 at 0,0");
    assert_string_equal(note_of("file,lat,lon\na,,\nb,1,1\n").c_str(), "");
}

void metres_in_the_columns_of_degrees_are_refused(void **)
{
    assert_refused("file,lat,lon\na,0,0\nb,4181998.3,550960.7\nc,4181998.4,550961.7\n",
                   "t.csv:3: lat,lon is 4181998.3,550960.7, and no other row has a position on the "
                   "globe, expected degrees; metres go into the columns x and y");
}

// A drive at 10 m/s, one position a second, some of them elsewhere.
std::string drive(size_t rows, const std::map<size_t, double> &elsewhere)
{
    std::string text = "file,utime,x,y\n";
    for (size_t i = 0; i < rows; i++) {
        const auto away = elsewhere.find(i);
        text += std::to_string(i) + "," + std::to_string(1000000 * i) + "," +
                std::to_string(10.0 * static_cast<double>(i)) + "," +
                std::to_string(away == elsewhere.end() ? 0 : away->second) + "\n";
    }
    return text;
}

std::string jumps_of(size_t rows, const std::map<size_t, double> &elsewhere)
{
    return note_of(drive(rows, elsewhere));
}

void a_leap_and_back_is_left_out(void **)
{
    const char *told = "t.csv: 1 fix left out: 1 where no vehicle gets in the time";
    assert_string_equal(jumps_of(9, {{4, 5000}}).c_str(), told);
    assert_string_equal(jumps_of(9, {{4, -126}}).c_str(), told);
    assert_string_equal(jumps_of(9, {{4, 120}}).c_str(), "");
    assert_string_equal(jumps_of(9, {{3, 5000}, {4, 5001}, {6, 9000}}).c_str(),
                        "t.csv: 3 fixes left out: 3 where no vehicle gets in the time");
    const Table table(drive(9, {{4, 5000}}));
    assert_no_truth(table.label("4"));
    assert_true(table.label("5").position.has_value());
}

void a_drive_that_goes_on_elsewhere_is_kept(void **)
{
    std::map<size_t, double> second_half, long_while;
    for (size_t i = 20; i < 40; i++)
        second_half[i] = 5000;
    for (size_t i = 10; i < 21; i++)
        long_while[i] = 5000;
    assert_string_equal(jumps_of(40, second_half).c_str(), "");
    assert_string_equal(jumps_of(40, long_while).c_str(), ""); // 11 rows
    assert_string_equal(jumps_of(9, {{0, 5000}}).c_str(), "");
    assert_string_equal(jumps_of(9, {{8, 5000}}).c_str(), "");
}

void drives_of_one_table_and_rows_in_any_order_make_no_jumps(void **)
{
    assert_string_equal(
        note_of("file,utime,x,y\na/0,0,0,0\nb/0,1,9000,0\na/1,2,0,1\nb/1,3,9000,1\na/2,4,0,2\n")
            .c_str(),
        "");
    assert_string_equal(
        note_of("file,utime,x,y\n2,2000000,20,0\n0,0,0,0\n9,90000000,2000,0\n1,1000000,10,0\n")
            .c_str(),
        "");
}

// A folder `pictures` with these pictures, empty, and a table beside it.
struct Pictures : Folder {
    explicit Pictures(const std::vector<std::string> &names)
    {
        std::filesystem::create_directory(path() / "pictures");
        for (const std::string &name : names)
            write("pictures/" + name, "");
    }

    // The place of a picture by a table, written to `csv`; "none", or the complaint.
    std::string place(const std::string &rows, const std::string &picture,
                      const vdna::frames::LabelOptions &options = {},
                      const std::string &csv = "t.csv") const
    {
        try {
            const Labels labels(write(csv, "file,place\n" + rows), options);
            const std::optional<int64_t> found =
                labels.find(path() / "pictures" / picture, 0).place;
            return found ? std::to_string(*found) : "none";
        } catch (const vdna::Error &e) {
            return e.what();
        }
    }
};

void names_are_relative_to_the_table_or_to_the_folder(void **)
{
    const Pictures at({"a.jpg", "b.jpg"});
    for (const char *name : {"pictures/a.jpg", "./pictures/a.jpg", "a.jpg", "./a.jpg"})
        assert_string_equal(at.place(std::string(name) + ",1\n", "a.jpg").c_str(), "1");
    assert_string_equal(at.place("pictures/a.jpg,1\n", "a.jpg", {}, "pictures/t.csv").c_str(), "1");
    assert_string_equal(at.place("a.jpg,1\n", "a.jpg", {"", true}).substr(0, 1).c_str(), "/");
    // A row beside the table is about the picture there.
    at.write("a.jpg", "");
    assert_string_equal(at.place("a.jpg,1\nb.jpg,2\n", "a.jpg").c_str(), "none");
}

void names_that_look_alike_match(void **)
{
    const std::string composed = "K\xC3\xA4"
                                 "fer.jpg",
                      decomposed = "Ka\xCC\x88"
                                   "fer.jpg";
    const Pictures apart({decomposed, "A b.JPG"}), together({composed});
    assert_string_equal(apart.place(composed + ",1\n", decomposed).c_str(), "1");
    assert_string_equal(together.place(decomposed + ",1\n", composed).c_str(), "1");
    assert_string_equal(together.place("pictures/" + decomposed + ",1\n", composed).c_str(), "1");
    assert_string_equal(apart.place("a B.jpg,1\n", "A b.JPG").c_str(), "1");
    assert_string_equal(apart.place("pictures\\A b.JPG,1\n", "A b.JPG").c_str(), "1");
    assert_string_equal(apart.place(".\\pictures\\a b.jpg,1\n", "A b.JPG", {"", true}).c_str(),
                        "1");
}

void names_that_fit_two_pictures_or_two_rows_match_none(void **)
{
    const Pictures two({"a.jpg", "A.jpg", "b.jpg", "C.jpg"});
    assert_string_equal(two.place("a.jpg,1\nb.jpg,2\n", "a.jpg").c_str(), "1");
    assert_string_equal(two.place("a.jpg,1\nb.jpg,2\n", "A.jpg").c_str(), "none");
    assert_string_equal(two.place("a.JPG,1\nb.jpg,2\n", "A.jpg").c_str(), "none");
    assert_string_equal(two.place("c.JPG,1\nc.jpg,2\nb.jpg,3\n", "C.jpg").c_str(), "none");
}

void a_table_of_other_pictures_names_both_spellings(void **)
{
    const Pictures at({"000.jpg", "001.jpg"});
    const std::string pictures = (at.path() / "pictures").string();
    assert_string_equal(
        at.place("frame_0.png,1\n", "000.jpg").c_str(),
        ((at.path() / "t.csv").string() + ": no row is about a picture of " + pictures +
         ": its first row is about 'frame_0.png', and a picture is called '000.jpg', "
         "expected names relative to the table or to the folder of the pictures")
            .c_str());
    assert_non_null(std::strstr(at.place("", "000.jpg").c_str(), "it has no rows"));
    assert_non_null(std::strstr(at.place("000.jpg,1\nK\xE4"
                                         "fer.jpg,2\n",
                                         "001.jpg")
                                    .c_str(),
                                "t.csv:3: file is not UTF-8"));
}

void a_table_of_other_frames_is_told_at_the_end(void **)
{
    const Table table("frame,place\n1000,1\n1039,2\n");
    const Labels labels(table.csv);
    labels.find("", 0);
    labels.find("", 39);
    try {
        labels.finish();
    } catch (const vdna::Error &e) {
        assert_non_null(std::strstr(e.what(), "no row is about a frame that was read: its rows are "
                                              "about frames 1000 to 1039, those read are 0 to 39"));
        labels.find("", 1000);
        labels.finish();
        return;
    }
    fail_msg("a table of other frames was accepted");
}

void rows_about_other_files_of_a_folder_are_known(void **)
{
    const std::string composed = "K\xC3\xA4"
                                 "fer.jpg",
                      decomposed = "Ka\xCC\x88"
                                   "fer.jpg";
    const Pictures at({"a.jpg", decomposed});
    const std::filesystem::path folder = at.path() / "pictures";
    const Labels labels(at.write("t.csv", "file,place\npictures/a.jpg,1\npictures/" + composed +
                                              ",2\npictures/gone.jpg,3\npictures/sub/b.jpg,4\n"
                                              "elsewhere/c.jpg,5\n"));
    const std::vector<std::filesystem::path> others =
        labels.others_below(folder, {folder / "a.jpg", folder / decomposed});
    assert_int_equal(others.size(), 2);
    assert_string_equal(others[0].c_str(), (folder / "gone.jpg").c_str());
    assert_string_equal(others[1].c_str(), (folder / "sub/b.jpg").c_str());
    const Table frames("frame,utime\n7,70\n3,30\n");
    assert_true(Labels(frames.csv).others_below(frames.path(), {}).empty());
    assert_true(Labels(frames.csv).frame_utimes() == (std::vector<int64_t>{30, 70}));
    assert_int_equal(Labels(frames.csv).numbered_frames(), 8);
    assert_int_equal(labels.numbered_frames(), 0);
}

void a_bare_name_of_a_table_is_a_file_of_the_working_folder(void **)
{
    const Table table("file,place\na.jpg,7\n");
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(table.path());
    const Labels labels("t.csv");
    assert_int_equal(*labels.find("a.jpg", 0).place, 7);
    std::filesystem::current_path(before);
    assert_int_equal(*labels.find(table.path() / "a.jpg", 0).place, 7);
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
    assert_refused("file,utime\na,x\n", std::string("t.csv:2: utime is 'x'") + whole);
    assert_false(Table("file,utime\na,\n").label("a").utime.has_value());
    assert_int_equal(*Table("file,place\na, 1 \n").label("a").place, 1);
    assert_refused("file,place\na,-9223372036854775808\n",
                   "t.csv:2: place is '-9223372036854775808', expected a whole number above -2^63, "
                   "which stands for none");
    assert_refused("file,place\na,9223372036854775808\n",
                   std::string("t.csv:2: place is '9223372036854775808'") + whole);
    assert_refused("frame,place\n-1,1\n", "t.csv:2: frame is '-1', expected a number from 0");
    assert_refused("file,x,y\na,1e9,-1e10\n",
                   "t.csv:2: y is '-1e10', expected metres within +-1e9");
    for (const char *bad : {"1e400", "1,5", "abc", "0x10"})
        assert_non_null(std::strstr(
            refusal_of("file,x,y\n" + std::string("a,") + bad + ",2\n").c_str(), "t.csv:2: "));
}

void a_cell_that_is_no_number_names_the_likely_cause(void **)
{
    assert_refused("file,x,y\na,\"1,5\",2\n",
                   "t.csv:2: x is '1,5', expected a decimal number; write decimals with a point");
    assert_refused("file,x,y\na,1.5 m,2\n",
                   "t.csv:2: x is '1.5 m', expected a decimal number; leave out 'm'");
    assert_refused("file,lat,lon\na,48.1\xC2\xB0N,2\n",
                   "t.csv:2: lat is '48.1\xC2\xB0N', expected a decimal number; leave out "
                   "'\xC2\xB0N'");
    assert_refused("file,x,y\na,east,2\n", "t.csv:2: x is 'east', expected a decimal number");
}

void other_separators_and_encodings_are_named(void **)
{
    const char *remedy =
        ", expected commas; save the table with commas, and with points in decimal "
        "numbers";
    assert_refused("file;lat;lon\na;48,1;11,5\n",
                   std::string("t.csv:1: the columns are separated by ';'") + remedy);
    assert_refused("file\tlat\tlon\n",
                   std::string("t.csv:1: the columns are separated by tabs") + remedy);
    assert_refused(
        "\"file\";\"lat\"\n",
        "t.csv:1: expected a comma or the end of the line after a field, found ';'; save "
        "the table with commas between the columns");
    const std::string utf16("\xFF\xFE"
                            "f\0i\0l\0e\0",
                            10),
        no_mark("f\0i\0l\0e\0", 8);
    for (const std::string &text : {utf16, no_mark})
        assert_refused(text, "t.csv: UTF-16 or binary, expected text in UTF-8; save the table as "
                             "CSV in UTF-8");
    assert_refused("file,place\ra,1\r",
                   "t.csv:1: the line ends in a carriage return alone, expected LF or CRLF; save "
                   "the table with one of them");
}

void a_row_of_another_width_is_refused(void **)
{
    assert_refused("file,place\na,1\nb,2,3\n",
                   "t.csv:3: found 3 fields, expected 2 as in the header; write decimal numbers "
                   "with a point, and quote names that hold a comma");
    assert_refused("file,place\na\n", "t.csv:2: found 1 fields, expected 2 as in the header");
}

void a_file_twice_is_refused(void **)
{
    assert_refused("file,place\na,1\n./a,2\n",
                   "t.csv:3: file is './a', expected each one only once; it is also in line 2");
    assert_refused("frame,place\n4,1\n\n4,1\n",
                   "t.csv:4: frame is '4', expected each one only once; it is also in line 2");
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
                                    "lat,lon[,alt], or utime (found 'x')");
    assert_refused("File,x,y\na,1,2\n",
                   "t.csv: no column 'file' or 'frame', expected one that says "
                   "which picture or frame a row is about (found 'File')");
    assert_non_null(std::strstr(refusal_of("file,Latitude,Longitude\na,1,2\n").c_str(),
                                "or utime (found 'Latitude')"));
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
        cmocka_unit_test(a_folder_that_does_not_resolve_is_taken_as_it_is_spelt),
        cmocka_unit_test(metres_are_taken_as_they_are),
        cmocka_unit_test(degrees_become_earth_centred_metres),
        cmocka_unit_test(times_may_stand_alone_or_beside_places),
        cmocka_unit_test(frames_are_found_by_index),
        cmocka_unit_test(quoted_fields_byte_order_marks_and_crlf_are_read),
        cmocka_unit_test(the_last_line_needs_no_end),
        cmocka_unit_test(other_columns_are_ignored),
        cmocka_unit_test(positions_say_their_frame),
        cmocka_unit_test(a_frame_without_a_row_has_no_truth),
        cmocka_unit_test(a_row_with_empty_cells_has_no_truth),
        cmocka_unit_test(fixes_that_nobody_can_have_are_left_out_and_told),
        cmocka_unit_test(metres_in_the_columns_of_degrees_are_refused),
        cmocka_unit_test(a_leap_and_back_is_left_out),
        cmocka_unit_test(a_drive_that_goes_on_elsewhere_is_kept),
        cmocka_unit_test(drives_of_one_table_and_rows_in_any_order_make_no_jumps),
        cmocka_unit_test(names_are_relative_to_the_table_or_to_the_folder),
        cmocka_unit_test(names_that_look_alike_match),
        cmocka_unit_test(names_that_fit_two_pictures_or_two_rows_match_none),
        cmocka_unit_test(a_table_of_other_pictures_names_both_spellings),
        cmocka_unit_test(a_table_of_other_frames_is_told_at_the_end),
        cmocka_unit_test(rows_about_other_files_of_a_folder_are_known),
        cmocka_unit_test(a_bare_name_of_a_table_is_a_file_of_the_working_folder),
        cmocka_unit_test(a_cell_that_is_no_number_names_the_likely_cause),
        cmocka_unit_test(other_separators_and_encodings_are_named),
        cmocka_unit_test(a_table_of_files_does_not_serve_a_video),
        cmocka_unit_test(a_bad_cell_is_told_with_file_line_and_column),
        cmocka_unit_test(a_row_of_another_width_is_refused),
        cmocka_unit_test(a_file_twice_is_refused),
        cmocka_unit_test(an_open_quote_is_told_where_it_began),
        cmocka_unit_test(a_header_without_labels_or_without_keys_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
