// Frames from folders, videos and LCM logs.
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/picture_list.hpp"
#include "frames/source.hpp"

using vdna::frames::Frame;
using vdna::frames::Source;
using vdna::frames::SourceOptions;

namespace
{

std::vector<Frame> frames_of(const std::string &path, const SourceOptions &options = {})
{
    std::vector<Frame> frames;
    Source source(path, options);
    for (Frame frame; source.next(frame);)
        frames.push_back(frame);
    return frames;
}

std::string refusal_of(const std::string &path, const SourceOptions &options = {})
{
    try {
        frames_of(path, options);
    } catch (const vdna::Error &e) {
        return e.what();
    }
    return "";
}

// The frames of a source, bad ones left out; counts these.
std::vector<Frame> usable_frames_of(Source &source, uint64_t &out_bad)
{
    std::vector<Frame> frames;
    out_bad = 0;
    for (;;) {
        try {
            Frame frame;
            if (!source.next(frame))
                return frames;
            frames.push_back(frame);
        } catch (const vdna::frames::BadFrame &bad) {
            out_bad += bad.frames();
        }
    }
}

void assert_contains(const std::string &text, const char *part)
{
    if (text.find(part) == std::string::npos)
        fail_msg("found '%s', expected it to contain '%s'", text.c_str(), part);
}

std::string big_endian(uint64_t value, int bytes)
{
    std::string text;
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
        text += static_cast<char>(value >> shift & 0xff);
    return text;
}

// A bot_core.image_t of one grey pixel.
std::string camera_message(int64_t utime, char grey)
{
    return big_endian(0x14739ffe13d5f5f0, 8) + big_endian(static_cast<uint64_t>(utime), 8) +
           big_endian(1, 4) + big_endian(1, 4) + big_endian(1, 4) + big_endian(VDNA_PIXEL_GREY, 4) +
           big_endian(1, 4) + grey + big_endian(0, 4);
}

// An event of an LCM log; `claimed` is the data length in its header.
std::string event(const std::string &channel, const std::string &data, uint32_t claimed)
{
    return big_endian(0xEDA1DA01, 4) + big_endian(0, 8) + big_endian(1, 8) +
           big_endian(channel.size(), 4) + big_endian(claimed, 4) + channel + data;
}

std::string event(const std::string &channel, const std::string &data)
{
    return event(channel, data, static_cast<uint32_t>(data.size()));
}

void pictures_come_in_the_natural_order_of_their_names(void **)
{
    const Folder folder;
    for (const char *name : {"b.PNG", "a10.jpg", "a9.jpeg", ".hidden.jpg", "notes.txt", "c"})
        folder.write(name, name);
    const std::vector<Frame> frames = frames_of(folder.path());
    assert_int_equal(frames.size(), 3);
    assert_string_equal(frames[0].file.filename().c_str(), "a9.jpeg");
    assert_string_equal(frames[1].file.filename().c_str(), "a10.jpg");
    assert_string_equal(frames[2].file.filename().c_str(), "b.PNG");
}

void a_picture_is_handed_on_as_the_bytes_of_its_file(void **)
{
    const Folder folder;
    folder.write("a.jpg", "bytes");
    Source source(folder.path());
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.image.pixelformat, VDNA_PIXEL_ENCODED);
    assert_int_equal(frame.image.size, 5);
    assert_memory_equal(frame.image.data, "bytes", 5);
    assert_false(source.next(frame));
}

void pictures_without_times_are_dated_by_the_rate(void **)
{
    const Folder folder;
    for (const char *name : {"0.jpg", "1.jpg", "2.jpg"})
        folder.write(name, "x");
    assert_int_equal(frames_of(folder.path())[2].utime, 200000);
    SourceOptions options;
    options.rate_hz = 30;
    assert_int_equal(frames_of(folder.path(), options)[2].utime, 66667);
}

void a_folder_brings_its_own_labels(void **)
{
    const Folder folder;
    folder.write("0.jpg", "x");
    folder.write("labels.csv", "file,utime,place\n0.jpg,77,5\n");
    const Frame frame = frames_of(folder.path()).at(0);
    assert_int_equal(frame.utime, 77);
    assert_int_equal(*frame.label.place, 5);

    const Folder elsewhere;
    SourceOptions options;
    options.labels =
        elsewhere.write("l.csv", "file,place\n" + (folder.path() / "0.jpg").string() + ",6\n");
    assert_int_equal(*frames_of(folder.path(), options).at(0).label.place, 6);

    options.labelled = false;
    assert_false(frames_of(folder.path(), options).at(0).label.place.has_value());
}

void a_picture_without_a_row_is_a_frame_without_truth(void **)
{
    const Folder folder;
    folder.write("0.jpg", "x");
    folder.write("1.jpg", "x");
    folder.write("labels.csv", "file,place\n0.jpg,5\n");
    vdna::frames::Source source(folder.path());
    vdna::frames::Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(*frame.label.place, 5);
    assert_true(source.next(frame));
    assert_true(frame.label.lacks_truth);
    assert_false(source.next(frame));
}

void skip_and_every_keep_the_index_in_the_source(void **)
{
    const Folder folder;
    for (int i = 0; i < 8; i++)
        folder.write(std::to_string(i) + ".jpg", "x");
    SourceOptions options;
    options.skip = 2;
    options.every = 3;
    const std::vector<Frame> frames = frames_of(folder.path(), options);
    assert_int_equal(frames.size(), 2);
    assert_int_equal(frames[0].index, 2);
    assert_int_equal(frames[1].index, 5);
    assert_int_equal(frames[1].utime, 500000);
    assert_int_equal(Source(folder.path(), options).size(), 2);

    options.skip = 8;
    assert_contains(refusal_of(folder.path(), options), "has 8 frames, expected more than the 8");
}

void what_is_no_source_is_refused(void **)
{
    const Folder folder;
    assert_contains(refusal_of(folder.path()), "no pictures in this folder");
    assert_contains(refusal_of(folder.path() / "none"), "not found");
    assert_contains(refusal_of(folder.write("text", "just text\n")), "neither a folder");
    assert_contains(refusal_of(folder.write("empty", "")), "neither a folder");
}

void a_log_gives_the_frames_of_its_camera(void **)
{
    const Folder folder;
    const std::string log =
        folder.write("l", event("CAMERA", camera_message(100000, 'a')) + event("POSE", "?") +
                              event("CAMERA", camera_message(200000, 'b')));
    Source source(log);
    assert_int_equal(source.size(), 2);
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.utime, 100000);
    assert_int_equal(frame.image.pixelformat, VDNA_PIXEL_GREY);
    assert_int_equal(frame.image.width, 1);
    assert_int_equal(frame.image.data[0], 'a');
    assert_true(source.next(frame));
    assert_int_equal(frame.index, 1);
    assert_int_equal(frame.image.data[0], 'b');
    assert_false(source.next(frame));
}

void another_channel_can_be_the_camera(void **)
{
    const Folder folder;
    const std::string log = folder.write("l", event("FRONT", camera_message(1, 'a')));
    SourceOptions options;
    options.camera = "FRONT";
    assert_int_equal(frames_of(log, options).size(), 1);
    assert_contains(refusal_of(log), "no message on channel CAMERA");
    assert_contains(refusal_of(log), "set --camera to one of: FRONT");
}

void a_log_that_ends_within_an_event_gives_what_came_before(void **)
{
    const Folder folder;
    const std::string whole = event("CAMERA", camera_message(1, 'a'));
    for (size_t cut = 1; cut < whole.size(); cut++) {
        const std::string log = folder.write("l", whole + whole.substr(0, cut));
        assert_int_equal(frames_of(log).size(), 1);
    }
}

void a_length_beyond_the_end_of_a_log_is_not_believed(void **)
{
    const Folder folder;
    const std::string good = event("CAMERA", camera_message(1, 'a'));
    for (const uint32_t claimed : {0x7fffffffu, 0xffffffffu}) {
        const std::string log = folder.write("l", good + event("CAMERA", "abc", claimed));
        assert_contains(refusal_of(log),
                        ("damaged at byte " + std::to_string(good.size())).c_str());
        Source source(log);
        uint64_t bad = 0;
        assert_int_equal(usable_frames_of(source, bad).size(), 1);
        assert_int_equal(bad, 1);
    }
}

void a_log_that_is_damaged_inside_is_refused_with_the_place(void **)
{
    const Folder folder;
    const std::string good = event("CAMERA", camera_message(1, 'a'));
    const std::string at = "damaged at byte " + std::to_string(good.size());
    std::string bad = good + good;
    bad[good.size()] = 'x'; // the magic
    assert_contains(refusal_of(folder.write("l", bad)), at.c_str());
    bad = good + good + event(std::string(1001, 'C'), "") + good;
    assert_contains(refusal_of(folder.write("l", bad)),
                    ("damaged at byte " + std::to_string(2 * good.size())).c_str());
}

std::string notes_of(const Source &source)
{
    std::string text;
    for (const std::string &sentence : sentences_of(source.account()))
        text += sentence + "; ";
    return text;
}

void pictures_come_in_the_order_of_their_utime(void **)
{
    const Folder folder;
    for (const char *name : {"1.jpg", "2.jpg", "10.jpg"})
        folder.write(name, "x");
    folder.write("labels.csv", "file,utime\n1.jpg,3000000\n2.jpg,1000000\n10.jpg,2000000\n");
    Source source(folder.path());
    assert_string_equal(source.account().order.c_str(), "utime");
    const std::vector<Frame> frames = frames_of(folder.path());
    assert_string_equal(frames[0].file.filename().c_str(), "2.jpg");
    assert_string_equal(frames[1].file.filename().c_str(), "10.jpg");
    assert_string_equal(frames[2].file.filename().c_str(), "1.jpg");
    assert_int_equal(frames[2].utime, 3000000);
    assert_int_equal(frames[2].index, 0);
}

void a_picture_without_a_utime_goes_with_the_one_before_it(void **)
{
    vdna::frames::PictureList list;
    const Folder folder;
    for (const char *name : {"1.jpg", "2.jpg", "3.jpg"})
        folder.write(name, "x");
    const vdna::frames::Labels labels(
        folder.write("labels.csv", "frame,utime\n0,3000000\n1,\n2,1000000\n"));
    list = vdna::frames::list_pictures(folder.path(), &labels);
    assert_string_equal(list.pictures[0].file.filename().c_str(), "3.jpg");
    assert_string_equal(list.pictures[2].file.filename().c_str(), "2.jpg");
    assert_int_equal(*list.pictures[2].stamp, 3000000);
}

void names_with_positions_come_in_the_order_of_their_times(void **)
{
    const Folder folder;
    folder.write("@551@41@10@S@@@@@@@@@20240613000002@@.jpg", "x");
    folder.write("@552@41@10@S@@@@@@@@@20240613000001@@.jpg", "x");
    Source source(folder.path());
    assert_string_equal(source.account().order.c_str(), "times in names");
    const std::vector<Frame> frames = frames_of(folder.path());
    assert_int_equal(frames[0].utime, 1718236801000000);
    assert_int_equal(frames[1].utime, 1718236802000000);
}

void names_with_positions_and_no_times_say_so(void **)
{
    const Folder folder;
    folder.write("@0@2.4.jpg", "x");
    folder.write("@0@2.5.jpg", "x");
    Source source(folder.path());
    assert_string_equal(source.account().order.c_str(), "numbers");
    assert_contains(notes_of(source), "which need not be that of the drive");
}

void links_without_a_target_and_rows_without_a_picture_are_bad_frames(void **)
{
    const Folder folder;
    folder.write("1.jpg", "x");
    std::filesystem::create_symlink("elsewhere", folder.path() / "2.jpg");
    folder.write("labels.csv", "file,place\n1.jpg,1\n2.jpg,2\n3.jpg,3\n");
    assert_contains(refusal_of(folder.path()), "2.jpg: a link to elsewhere, which is not there");
    Source source(folder.path());
    uint64_t bad = 0;
    assert_int_equal(usable_frames_of(source, bad).size(), 1);
    assert_int_equal(bad, 2);
    assert_int_equal(source.account().expected, 3);
}

void pictures_one_level_down_are_found_by_the_table_or_named(void **)
{
    const Folder folder;
    std::filesystem::create_directory(folder.path() / "images");
    folder.write("images/1.jpg", "x");
    assert_contains(refusal_of(folder.path()),
                    ("but 1 one level down; name " + (folder.path() / "images").string()).c_str());
    folder.write("labels.csv", "file,place\nimages/1.jpg,7\n");
    assert_int_equal(*frames_of(folder.path()).at(0).label.place, 7);
}

void stamps_in_another_unit_are_converted_and_told(void **)
{
    const Folder folder;
    folder.write("1.jpg", "x");
    folder.write("2.jpg", "x");
    folder.write("labels.csv",
                 "file,utime\n1.jpg,1700000000000000000\n2.jpg,1700000000100000000\n");
    Source source(folder.path());
    assert_contains(notes_of(source), "its stamps are nanoseconds");
    assert_string_equal(source.account().time_unit.c_str(), "nanoseconds");
    assert_int_equal(frames_of(folder.path())[1].utime, 1700000000100000);
    SourceOptions options;
    options.time_unit = VDNA_TIME_UNIT_US;
    assert_int_equal(frames_of(folder.path(), options)[1].utime, 1700000000100000000);
    assert_contains(notes_of(Source(folder.path(), options)), "100.0 s apart by their stamps");
}

// A log of camera frames with these stamps.
std::string log_of(const std::vector<int64_t> &stamps)
{
    std::string log;
    for (const int64_t stamp : stamps)
        log += event("CAMERA", camera_message(stamp, 'a'));
    return log;
}

void late_frames_of_a_log_are_left_out_and_counted(void **)
{
    const Folder folder;
    const std::string log = folder.write("l", log_of({0, 300000, 200000, 400000, 350000}));
    Source source(log);
    uint64_t bad = 0;
    const std::vector<Frame> frames = usable_frames_of(source, bad);
    assert_int_equal(frames.size(), 3);
    assert_int_equal(frames[2].utime, 400000);
    assert_int_equal(source.account().late, 2);
    assert_contains(notes_of(source), "2 late frames left out");
}

void a_larger_step_back_is_told(void **)
{
    const Folder folder;
    const std::string log = folder.write("l", log_of({9000000, 9100000, 2000000}));
    Source source(log);
    uint64_t bad = 0;
    assert_int_equal(usable_frames_of(source, bad).size(), 3);
    assert_contains(notes_of(source), "camera time steps back by 7.1 s at frame 2");
}

void stamps_that_stand_still_are_told(void **)
{
    const Folder folder;
    assert_contains(notes_of(Source(folder.write("l", log_of({0, 0, 0})))),
                    "camera time stands still: all 3 stamps are 0");
}

void zeros_at_the_end_of_a_log_are_its_end(void **)
{
    const Folder folder;
    const std::string log = folder.write("l", log_of({1000, 2000}) + std::string(5000, '\0'));
    assert_int_equal(frames_of(log).size(), 2);
    assert_contains(notes_of(Source(log)), "its last 5000 bytes are zeros or half an event");
}

void a_damaged_log_goes_on_at_the_next_event_and_counts_the_loss(void **)
{
    const Folder folder;
    const size_t size = event("CAMERA", camera_message(0, 'a')).size();
    std::string bytes = log_of({0, 100000, 200000, 300000, 400000});
    // A hole over the end of the second event and the beginning of the third.
    bytes.replace(2 * size - 20, 40, std::string(40, '\0'));
    Source source(folder.write("l", bytes));
    uint64_t bad = 0;
    const std::vector<Frame> frames = usable_frames_of(source, bad);
    assert_int_equal(frames.size(), 3);
    assert_int_equal(frames[1].utime, 300000);
    assert_int_equal(bad, 1);

    // An event that was cut: the next one begins within its claimed length.
    Source cut(folder.write("l", log_of({0}) + log_of({100000}).substr(0, size - 5) +
                                     log_of({200000, 300000})));
    assert_int_equal(usable_frames_of(cut, bad).size(), 3);
    assert_int_equal(bad, 1);
}

void a_table_with_more_rows_than_frames_is_told_once(void **)
{
    const Folder folder;
    SourceOptions options;
    options.labels = folder.write("l.csv", "frame,place\n0,1\n1,2\n2,3\n3,4\n");
    const std::string log = folder.write("l", log_of({0, 100000}));
    assert_contains(refusal_of(log, options), "ends after 2 frames, but the table has rows up to "
                                              "frame 3");
    Source source(log, options);
    uint64_t bad = 0;
    assert_int_equal(usable_frames_of(source, bad).size(), 2);
    assert_int_equal(bad, 2);
}

void files_of_one_drive_are_one_source(void **)
{
    const Folder folder;
    const std::string a = folder.write("a", log_of({0, 100000}));
    const std::string b = folder.write("b", log_of({200000}));
    Source source(a + "+" + b);
    assert_int_equal(source.size(), 3);
    const std::vector<Frame> frames = frames_of(a + "+" + b);
    assert_int_equal(frames[2].index, 2);
    assert_int_equal(frames[2].utime, 200000);
    assert_contains(refusal_of(a + "+" + folder.path().string()), "cannot be joined");
    assert_contains(refusal_of(a + "+none"), "not found");
    const std::string plus = folder.write("c+d", log_of({7}));
    assert_int_equal(frames_of(plus).size(), 1);
}

void files_that_a_logger_cut_are_joined_by_their_numbers(void **)
{
    const Folder folder;
    const std::string first = folder.write("drive.lcm.9", log_of({0}));
    const std::string second = folder.write("drive.lcm.10", log_of({100000}));
    const std::string other = folder.write("other.lcm", log_of({0}));
    const std::vector<std::string> joined = vdna::frames::join_numbered({second, other, first});
    assert_int_equal(joined.size(), 2);
    assert_string_equal(joined[0].c_str(), (first + "+" + second).c_str());
    assert_string_equal(joined[1].c_str(), other.c_str());
    assert_string_equal(vdna::frames::drive_name_of(joined[0]).c_str(), "drive");
    assert_string_equal(vdna::frames::drive_name_of(other).c_str(), "other");
}

// A video of grey frames at 5 Hz.
std::string write_video(const Folder &folder, const char *name, int frames)
{
    const std::string video = folder.path() / name;
    cv::VideoWriter writer(video, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5, {64, 48});
    assert_true(writer.isOpened());
    for (int i = 0; i < frames; i++)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(i, i, i)));
    return video;
}

void videos_of_one_drive_follow_one_another_in_time(void **)
{
    const Folder folder;
    const std::vector<Frame> frames =
        frames_of(write_video(folder, "a.avi", 4) + "+" + write_video(folder, "b.avi", 3));
    assert_int_equal(frames.size(), 7);
    assert_int_equal(frames[3].utime, 600000);
    assert_int_equal(frames[4].utime, 800000);
    assert_int_equal(frames[6].utime, 1200000);
    assert_int_equal(frames[6].index, 6);
}

std::string bytes_of(const std::string &path)
{
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void a_video_that_was_cut_short_says_so(void **)
{
    const Folder folder;
    const std::string whole = bytes_of(write_video(folder, "whole.avi", 40));
    const std::string cut = folder.write("cut.avi", whole.substr(0, whole.size() * 6 / 10));
    assert_contains(refusal_of(cut), " of 40 frames");
    Source source(cut);
    uint64_t bad = 0;
    const size_t frames = usable_frames_of(source, bad).size();
    assert_in_range(frames, 15, 30);
    assert_int_equal(frames + bad, 40);
    assert_int_equal(source.account().expected, 40);

    // A table of all frames does not make them missing twice.
    std::string table = "frame,place\n";
    for (int i = 0; i < 40; i++)
        table += std::to_string(i) + "," + std::to_string(i) + "\n";
    SourceOptions options;
    options.labels = folder.write("l.csv", table);
    Source labelled(cut, options);
    usable_frames_of(labelled, bad);
    assert_int_equal(frames + bad, 40);
}

// The decoder hands out the last frames of such a video after its end, when OpenCV has no times.
void the_last_frames_of_a_video_have_times_too(void **)
{
    const Folder folder;
    const std::string video = folder.path() / "v.mp4";
    {
        cv::VideoWriter writer(video, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), 5, {64, 48});
        if (!writer.isOpened())
            _skip(__FILE__, __LINE__); // no H.264 encoder
        for (int i = 0; i < 40; i++)
            writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(6 * i, 3 * i, i)));
    }
    const std::vector<Frame> frames = frames_of(video);
    assert_int_equal(frames.size(), 40);
    for (size_t i = 0; i < frames.size(); i++)
        assert_int_equal(frames[i].utime, 200000 * i);
    assert_string_equal(notes_of(Source(video)).c_str(), "");
}

void a_video_without_a_frame_count_is_read(void **)
{
    const Folder folder;
    // The pictures alone, as a camera's stream is stored.
    std::vector<uint8_t> picture;
    cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(9, 9, 9)), picture);
    std::string stream;
    for (int i = 0; i < 5; i++)
        stream.append(picture.begin(), picture.end());
    Source source(folder.write("camera.mjpeg", stream));
    uint64_t bad = 0;
    const std::vector<Frame> frames = usable_frames_of(source, bad);
    assert_int_equal(frames.size(), 5);
    assert_int_equal(bad, 0);
    assert_int_equal(frames[4].utime - frames[3].utime, frames[1].utime - frames[0].utime);
    assert_true(frames[4].utime > 0);
}

void a_bad_camera_message_does_not_end_the_log(void **)
{
    const Folder folder;
    const std::string log = folder.write("l", event("CAMERA", "nonsense") +
                                                  event("CAMERA", camera_message(200000, 'b')));
    Source source(log);
    Frame frame;
    bool refused = false;
    try {
        source.next(frame);
    } catch (const vdna::frames::BadFrame &) {
        refused = true;
    }
    assert_true(refused);
    assert_true(source.next(frame));
    assert_int_equal(frame.index, 1);
    assert_int_equal(frame.utime, 200000);
}

void a_video_is_dated_by_its_own_rate(void **)
{
    const Folder folder;
    const std::string video = folder.path() / "v.avi";
    {
        cv::VideoWriter writer(video, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 5, {64, 48});
        assert_true(writer.isOpened());
        for (const double blue : {0.0, 100.0, 200.0})
            writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(blue, 0, 0)));
    }
    SourceOptions options;
    options.skip = 1;
    Source source(video, options);
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.index, 1);
    assert_int_equal(frame.utime, 200000);
    assert_int_equal(frame.image.pixelformat, VDNA_PIXEL_BGR3);
    assert_int_equal(frame.image.width, 64);
    assert_int_equal(frame.image.height, 48);
    assert_in_range(frame.image.data[0], 90, 110);
    assert_true(source.next(frame));
    assert_in_range(frame.image.data[0], 190, 210);
    assert_false(source.next(frame));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(pictures_come_in_the_natural_order_of_their_names),
        cmocka_unit_test(pictures_come_in_the_order_of_their_utime),
        cmocka_unit_test(a_picture_without_a_utime_goes_with_the_one_before_it),
        cmocka_unit_test(names_with_positions_come_in_the_order_of_their_times),
        cmocka_unit_test(names_with_positions_and_no_times_say_so),
        cmocka_unit_test(links_without_a_target_and_rows_without_a_picture_are_bad_frames),
        cmocka_unit_test(pictures_one_level_down_are_found_by_the_table_or_named),
        cmocka_unit_test(stamps_in_another_unit_are_converted_and_told),
        cmocka_unit_test(late_frames_of_a_log_are_left_out_and_counted),
        cmocka_unit_test(a_larger_step_back_is_told),
        cmocka_unit_test(stamps_that_stand_still_are_told),
        cmocka_unit_test(zeros_at_the_end_of_a_log_are_its_end),
        cmocka_unit_test(a_damaged_log_goes_on_at_the_next_event_and_counts_the_loss),
        cmocka_unit_test(a_table_with_more_rows_than_frames_is_told_once),
        cmocka_unit_test(files_of_one_drive_are_one_source),
        cmocka_unit_test(files_that_a_logger_cut_are_joined_by_their_numbers),
        cmocka_unit_test(videos_of_one_drive_follow_one_another_in_time),
        cmocka_unit_test(a_video_that_was_cut_short_says_so),
        cmocka_unit_test(the_last_frames_of_a_video_have_times_too),
        cmocka_unit_test(a_video_without_a_frame_count_is_read),
        cmocka_unit_test(a_picture_is_handed_on_as_the_bytes_of_its_file),
        cmocka_unit_test(pictures_without_times_are_dated_by_the_rate),
        cmocka_unit_test(a_folder_brings_its_own_labels),
        cmocka_unit_test(a_picture_without_a_row_is_a_frame_without_truth),
        cmocka_unit_test(skip_and_every_keep_the_index_in_the_source),
        cmocka_unit_test(what_is_no_source_is_refused),
        cmocka_unit_test(a_log_gives_the_frames_of_its_camera),
        cmocka_unit_test(another_channel_can_be_the_camera),
        cmocka_unit_test(a_log_that_ends_within_an_event_gives_what_came_before),
        cmocka_unit_test(a_length_beyond_the_end_of_a_log_is_not_believed),
        cmocka_unit_test(a_log_that_is_damaged_inside_is_refused_with_the_place),
        cmocka_unit_test(a_bad_camera_message_does_not_end_the_log),
        cmocka_unit_test(a_video_is_dated_by_its_own_rate),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
