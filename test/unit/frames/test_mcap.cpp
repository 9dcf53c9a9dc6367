// Camera frames and positions of MCAP files.
#include <cmath>
#include <cstring>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>

#include "cmocka.hpp"
#include "folder.hpp"
#include "frames/source.hpp"
#include "mcap_bytes.hpp"

using vdna::frames::BadFrame;
using vdna::frames::Frame;
using vdna::frames::Source;
using vdna::frames::SourceOptions;

namespace
{

constexpr uint64_t utime = 1700000000123456;

struct Reading {
    std::vector<int64_t> utimes;
    std::vector<std::string> pictures;
    std::vector<vdna::frames::Label> labels;
    std::vector<std::string> complaints; // from the file's name on
    std::vector<std::string> notes;
};

std::string from_name(const std::string &sentence)
{
    return sentence.substr(sentence.find("drive.mcap"));
}

Reading read(const std::string &file, const SourceOptions &options = {})
{
    const Folder folder;
    Source source(folder.write("drive.mcap", file), options);
    Reading reading;
    for (Frame frame;;)
        try {
            if (!source.next(frame))
                break;
            reading.utimes.push_back(frame.utime);
            reading.pictures.emplace_back(reinterpret_cast<const char *>(frame.image.data),
                                          frame.image.size);
            reading.labels.push_back(frame.label);
        } catch (const BadFrame &bad) {
            reading.complaints.push_back(from_name(bad.what()));
        }
    reading.notes = source.account().notes;
    return reading;
}

std::string refusal_of(const std::string &file, const SourceOptions &options = {})
{
    try {
        read(file, options);
    } catch (const vdna::Error &error) {
        return from_name(error.what());
    }
    return "";
}

void assert_begins(const std::string &text, const std::string &begin)
{
    if (text.substr(0, begin.size()) != begin)
        fail_msg("found '%s', expected '%s...'", text.c_str(), begin.c_str());
}

const mcap::Sample &protobuf = mcap::pictures[0];

std::string described(const mcap::Sample &sample, uint16_t id, const std::string &topic)
{
    return mcap::schema(id, sample.schema) + mcap::channel(id, id, topic, sample.encoding);
}

// A picture a second on the topic "/camera".
std::string pictures(const mcap::Sample &sample, uint64_t count, uint64_t first = 0)
{
    std::string records = described(sample, 1, "/camera");
    for (uint64_t i = first; i < first + count; i++)
        records += mcap::message(1, utime, sample.of(utime + i * 1000000));
    return records;
}

std::string file_of(const std::string &records)
{
    return mcap::header() + records + mcap::end();
}

void pictures_of_all_types_are_read(void **)
{
    for (const mcap::Sample &sample : mcap::pictures) {
        const Reading reading = read(file_of(pictures(sample, 3)));
        assert_int_equal(reading.complaints.size(), 0);
        assert_true(
            (reading.utimes == std::vector<int64_t>{utime, utime + 1000000, utime + 2000000}));
        assert_true((reading.pictures == std::vector<std::string>(3, "JPEG")));
    }
}

void big_endian_cdr_is_read(void **)
{
    const std::string text("\0\0\0\7camera\0", 11), jpeg("\0\0\0\5jpeg\0", 9);
    const std::string message = std::string("\0\0\0\0\0\0\0\2\0\0\x03\xe8", 12) + text +
                                std::string(1, 0) + jpeg + std::string(3, 0) +
                                std::string("\0\0\0\4JPEG", 8);
    const mcap::Sample &sample = mcap::pictures[4];
    const Reading reading =
        read(file_of(described(sample, 1, "/camera") + mcap::message(1, utime, message)));
    assert_int_equal(reading.complaints.size(), 0);
    assert_int_equal(reading.utimes.at(0), 2000001);
    assert_string_equal(reading.pictures.at(0).c_str(), "JPEG");
}

void chunks_are_read_however_they_are_compressed(void **)
{
    for (const char *compression : {"", "lz4", "zstd"}) {
        const Reading reading = read(file_of(mcap::chunk(pictures(protobuf, 2), compression) +
                                             mcap::record(7, "an index") +
                                             mcap::chunk(pictures(protobuf, 2, 2), compression)));
        assert_int_equal(reading.complaints.size(), 0);
        assert_int_equal(reading.utimes.size(), 4);
    }
    assert_begins(refusal_of(file_of(mcap::record(6, mcap::number(0, 28) + mcap::counted("xz") +
                                                         mcap::number(0, 8)))),
                  "drive.mcap: its chunks are compressed with 'xz', expected zstd, lz4 or nothing");
}

void a_picture_without_a_stamp_has_the_time_of_logging(void **)
{
    const std::string records =
        described(protobuf, 1, "/camera") + mcap::message(1, utime, mcap::nested(2, "JPEG"));
    assert_int_equal(read(file_of(records)).utimes.at(0), utime);
}

void a_topic_is_chosen_by_name_or_because_it_is_the_only_one(void **)
{
    const std::string two = described(protobuf, 1, "/left") + described(protobuf, 2, "/right") +
                            mcap::message(1, utime, protobuf.of(5000000)) +
                            mcap::message(2, utime, protobuf.of(6000000));
    assert_begins(refusal_of(file_of(two)), "drive.mcap: no compressed pictures on topic CAMERA; "
                                            "set --camera to one of: /left /right");
    SourceOptions options;
    options.camera = "/right";
    assert_true((read(file_of(two), options).utimes == std::vector<int64_t>{6000000}));
    options.camera = "/lfet";
    assert_begins(refusal_of(file_of(pictures(protobuf, 1)), options),
                  "drive.mcap: no compressed pictures on topic /lfet; set --camera to one of: "
                  "/camera");
    const mcap::Sample raw = {"sensor_msgs/msg/Image", "cdr", nullptr};
    assert_begins(refusal_of(file_of(described(raw, 1, "/raw") + mcap::message(1, 0, "x"))),
                  "drive.mcap: no compressed pictures on topic CAMERA, expected "
                  "foxglove.CompressedImage or sensor_msgs' CompressedImage; it holds: /raw "
                  "(sensor_msgs/msg/Image, cdr)");
    assert_begins(refusal_of(file_of("")), "drive.mcap: no compressed pictures");
}

void the_file_of_a_killed_recorder_is_read_to_its_end(void **)
{
    const std::string whole = mcap::header() + mcap::chunk(pictures(protobuf, 2), "zstd");
    const Reading reading = read(whole + mcap::chunk(pictures(protobuf, 2), "zstd").substr(0, 40));
    assert_int_equal(reading.utimes.size(), 2);
    assert_int_equal(reading.complaints.size(), 0);
    assert_string_equal(reading.notes.at(0).c_str(),
                        "its last 40 bytes are half a record, left out");
    assert_int_equal(read(whole).notes.size(), 0);
}

// The complaint about records among sound pictures, of which the one after them is read too.
std::string complaint_of(const std::string &records)
{
    const Reading reading = read(file_of(pictures(protobuf, 1) + records +
                                         mcap::message(1, utime, protobuf.of(utime + 1000000))));
    assert_int_equal(reading.utimes.size(), 2);
    assert_int_equal(reading.complaints.size(), 1);
    const std::string &complaint = reading.complaints.at(0);
    const size_t at = complaint.find(": ", complaint.find("byte"));
    return at == std::string::npos ? complaint : complaint.substr(at + 2);
}

void damage_is_told_and_what_follows_is_read(void **)
{
    const std::string more = mcap::message(1, utime, protobuf.of(utime));
    assert_string_equal(complaint_of(mcap::record(5, "1234567")).c_str(), "a message that is cut");
    assert_begins(complaint_of(mcap::message(9, 0, "x")), "a message of a channel that is not");
    assert_begins(complaint_of(mcap::chunk(more.substr(0, 20), "")),
                  "a record of a chunk is longer");
    assert_begins(complaint_of(mcap::chunk(mcap::chunk("", ""), "")), "a chunk within a chunk");
    assert_begins(complaint_of(mcap::chunk(more, "lz4", 1)), "a chunk whose checksum is false");
    assert_begins(complaint_of(mcap::record(6, mcap::number(0, 20))), "a chunk that is cut");
    assert_begins(complaint_of(mcap::record(3, "123")), "a schema that is cut");
    assert_begins(complaint_of(mcap::record(4, "123")), "a channel that is cut");
    for (const char *compression : {"", "lz4", "zstd"})
        for (const uint64_t lie : {uint64_t{1}, uint64_t{1} << 28, UINT64_MAX}) {
            std::string body = mcap::number(0, 16) + mcap::number(lie, 8) + mcap::number(0, 4) +
                               mcap::counted(compression);
            const std::string bytes = mcap::packed(more, compression);
            body += mcap::number(bytes.size(), 8) + bytes;
            assert_begins(complaint_of(mcap::record(6, body)), "a chunk ");
        }
}

void a_checksum_is_zlib_s(void **)
{
    // By Python's zlib.crc32().
    const std::string records = mcap::record(0x80, "123");
    assert_int_equal(read(file_of(pictures(protobuf, 1) + mcap::chunk(records, "", 0xF5F9754E)))
                         .complaints.size(),
                     0);
}

void a_damaged_picture_is_a_bad_frame(void **)
{
    for (const mcap::Sample &sample : mcap::pictures) {
        const std::string whole = sample.of(utime);
        for (size_t size = 0; size < whole.size(); size++) {
            const std::string records =
                described(sample, 1, "/camera") + mcap::message(1, 5, whole.substr(0, size));
            // Protobuf is whole wherever a member ends.
            const Reading reading = read(file_of(records));
            assert_int_equal(reading.utimes.size() + reading.complaints.size(), 1);
            if (!reading.complaints.empty())
                assert_begins(reading.complaints[0], "drive.mcap: frame 0: a damaged message of");
        }
    }
    const mcap::Sample &json = mcap::pictures[1];
    for (const char *text :
         {"", "7", "{}", R"({"data":7})", R"({"data":"?"})", R"({"data":"","timestamp":{"sec":1}})",
          R"({"data":"","timestamp":{"sec":1e300,"nsec":0}})", R"({"data":"","timestamp":3})",
          R"({"data":"","timestamp":{"sec":9000000000000,"nsec":0}})"}) {
        const Reading reading =
            read(file_of(described(json, 1, "/camera") + mcap::message(1, 5, text)));
        assert_int_equal(reading.complaints.size(), 1);
    }
}

void positions_label_frames(void **)
{
    for (const mcap::Sample &sample : mcap::fixes) {
        const std::string records = pictures(protobuf, 3) + described(sample, 2, "/gps") +
                                    mcap::message(2, utime, sample.of(utime)) +
                                    mcap::message(2, utime, sample.of(utime + 1000000));
        SourceOptions options;
        options.pose_channel = "/gps";
        const Reading reading = read(file_of(records), options);
        double ecef[3];
        assert_int_equal(vdna_geodesy_to_ecef(51.5, -1.25, 70, ecef), VDNA_OK);
        for (size_t i = 0; i < 3; i++)
            assert_true(std::abs((*reading.labels.at(0).position)[i] - ecef[i]) < 1e-6);
        assert_string_equal(reading.labels.at(1).position_frame.c_str(), "wgs84");
        assert_false(reading.labels.at(2).position.has_value());
    }
}

void a_receiver_without_a_fix_labels_nothing(void **)
{
    const mcap::Sample &sample = mcap::fixes[4];
    const std::string records = pictures(protobuf, 2) + described(sample, 2, "/gps") +
                                mcap::message(2, 0, mcap::ros_fix(true, utime)) +
                                mcap::message(2, 0, mcap::ros_fix(true, utime + 1000000, -1));
    SourceOptions options;
    options.pose_channel = "/gps";
    const Reading reading = read(file_of(records), options);
    assert_true(reading.labels.at(0).position.has_value());
    assert_false(reading.labels.at(1).position.has_value());
    options.pose_channel = "/odometry";
    assert_begins(refusal_of(file_of(records), options),
                  "drive.mcap: no positions on topic /odometry, expected foxglove.LocationFix or "
                  "sensor_msgs' NavSatFix; set --pose-channel to one of: /gps");
    assert_begins(refusal_of(file_of(pictures(protobuf, 1)), options),
                  "drive.mcap: no positions on topic /odometry, expected foxglove.LocationFix or "
                  "sensor_msgs' NavSatFix; it holds none");
}

void files_of_one_drive_are_joined(void **)
{
    const Folder folder;
    const std::string first = folder.write("drive.mcap", file_of(pictures(protobuf, 2)));
    const std::string other = folder.write("more.mcap", file_of(pictures(protobuf, 1)));
    Source source(first + "+" + other);
    assert_int_equal(source.size(), 3);
    const std::string video = folder.write("drive.avi", "no video");
    try {
        const Source mixed(first + "+" + video);
        fail_msg("an MCAP file was joined with a video");
    } catch (const vdna::Error &error) {
        assert_non_null(std::strstr(error.what(), "LCM logs only or MCAP files only"));
    }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(pictures_of_all_types_are_read),
        cmocka_unit_test(big_endian_cdr_is_read),
        cmocka_unit_test(chunks_are_read_however_they_are_compressed),
        cmocka_unit_test(a_picture_without_a_stamp_has_the_time_of_logging),
        cmocka_unit_test(a_topic_is_chosen_by_name_or_because_it_is_the_only_one),
        cmocka_unit_test(the_file_of_a_killed_recorder_is_read_to_its_end),
        cmocka_unit_test(damage_is_told_and_what_follows_is_read),
        cmocka_unit_test(a_checksum_is_zlib_s),
        cmocka_unit_test(a_damaged_picture_is_a_bad_frame),
        cmocka_unit_test(positions_label_frames),
        cmocka_unit_test(a_receiver_without_a_fix_labels_nothing),
        cmocka_unit_test(files_of_one_drive_are_joined),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
