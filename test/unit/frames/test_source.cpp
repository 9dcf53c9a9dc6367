// Frames from folders, videos and LCM logs.
#include <cstring>
#include <vector>

#include <opencv2/videoio.hpp>

#include "cmocka.hpp"
#include "folder.hpp"
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

void pictures_come_in_the_order_of_their_names(void **)
{
    const Folder folder;
    for (const char *name : {"b.PNG", "a10.jpg", "a9.jpeg", ".hidden.jpg", "notes.txt", "c"})
        folder.write(name, name);
    const std::vector<Frame> frames = frames_of(folder.path());
    assert_int_equal(frames.size(), 3);
    assert_string_equal(frames[0].file.filename().c_str(), "a10.jpg");
    assert_string_equal(frames[1].file.filename().c_str(), "a9.jpeg");
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
        folder.write("l", event("CAMERA", camera_message(100, 'a')) + event("POSE", "?") +
                              event("CAMERA", camera_message(200, 'b')));
    Source source(log);
    assert_int_equal(source.size(), 2);
    Frame frame;
    assert_true(source.next(frame));
    assert_int_equal(frame.utime, 100);
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
    for (const uint32_t claimed : {0x7fffffffu, 0xffffffffu})
        assert_int_equal(
            frames_of(folder.write("l", good + event("CAMERA", "abc", claimed))).size(), 1);
}

void a_log_that_is_damaged_inside_is_refused_with_the_place(void **)
{
    const Folder folder;
    const std::string good = event("CAMERA", camera_message(1, 'a'));
    const std::string at = "damaged at byte " + std::to_string(good.size());
    std::string bad = good + good;
    bad[good.size()] = 'x'; // the magic
    assert_contains(refusal_of(folder.write("l", bad)), at.c_str());
    bad = good + event(std::string(1001, 'C'), "");
    assert_contains(refusal_of(folder.write("l", bad)), at.c_str());
}

void a_bad_camera_message_does_not_end_the_log(void **)
{
    const Folder folder;
    const std::string log =
        folder.write("l", event("CAMERA", "nonsense") + event("CAMERA", camera_message(200, 'b')));
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
    assert_int_equal(frame.utime, 200);
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
        cmocka_unit_test(pictures_come_in_the_order_of_their_names),
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
