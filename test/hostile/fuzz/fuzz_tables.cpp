// Any bytes as one of the text files that the tools read beside pictures: labels, tracks, ranges.
// Each is refused with a sentence about the file, or read.
//
// The first byte chooses the reader, the rest is the file.
#include <cstring>
#include <iostream>
#include <iterator>

#include <vdna/cpp/error.hpp>

#include "frames/labels.hpp"
#include "frames/track.hpp"
#include "frames/track_file.hpp"
#include "memory_file.hpp"
#include "record/ranges.hpp"

using namespace vdna;

static void read_labels(const std::string &path)
{
    const frames::Labels labels(path);
    for (const char *picture : {"a.jpg", "b.jpg"}) {
        const frames::Label &label = labels.find(picture, 1);
        MUST(!label.position || !label.position_frame.empty());
    }
    labels.frame_utimes();
    labels.others_below("pics", {"a.jpg"});
    MUST(labels.numbered_frames() < UINT64_MAX);
}

static void join(const std::string &path, const frames::TrackFile &file)
{
    const frames::Track track = frames::Track::of_fixes(path, file, 1000000);
    MUST(track.size() >= 1 && track.begin_utime() <= track.end_utime() && track.spacing_us() >= 0);
    MUST(track.at(track.begin_utime()) && track.at(track.end_utime()));
}

static void read_track_table(const std::string &path)
{
    join(path, frames::read_track_table(path));
}

static void read_gpx(const std::string &path)
{
    join(path, frames::read_gpx(path));
}

static void read_ranges(const std::string &path)
{
    const record::Ranges ranges = record::read_ranges(path);
    MUST(ranges.values.size() == size_t{2} * ranges.identity.neurons);
    MUST(vdna_range_check(ranges.values.data(), ranges.identity.neurons) == VDNA_OK);
}

static void (*const readers[])(const std::string &) = {read_labels, read_track_table, read_gpx,
                                                       read_ranges};

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static MemoryFile file;
    if (size == 0)
        return 0;
    std::cerr.rdbuf(nullptr); // what was left out
    file.hold(bytes + 1, size - 1);
    try {
        readers[bytes[0] % std::size(readers)](file.path());
    } catch (const Error &error) {
        MUST(std::strstr(error.what(), file.path().c_str()) != nullptr);
    }
    return 0;
}

struct Seed {
    uint8_t reader;
    const char *text;
};

static const Seed seeds[] = {
    {0, "file,place,utime\na.jpg,1,1700000000000000\n\"b.jpg\", 2 ,1700000001000000\n"},
    {0, "frame,lat,lon,alt\n0,48.1,11.5,500\n1,48.2,11.6,\n2,0,0,0\n3,,,\n"},
    {0, "file,x,y,z,position_frame\npics/a.jpg,1.5,-2,0,hall\nb.jpg,nan,3,1e9,hall\n"},
    {1, "utime,lat,lon,alt\n1700000000000000,48.1,11.5,500\n1700000001000000,48.2,11.6,\n"},
    {1, "Timestamp,Latitude,Longitude (\xC2\xB0),elevation\n2024-05-01T12:00:00.5+02:00,48,11,1\n"
        "1714557601,48,11.0001,2\n"},
    {2, "<gpx><trk><trkseg><trkpt lat='48.1' lon='11.5'><ele>5</ele><time>2024-05-01T12:00:00Z"
        "</time></trkpt><trkpt lat='48.1' lon='11.6'><time>2024-05-01T12:00:01Z</time></trkpt>"
        "</trkseg></trk></gpx>"},
    {3, R"({"format":"vdna-ranges","version":1,"backbone":"tiny","model_sha256":"aa",)"
        R"("precision":"fp32","preprocessing":"8x8","taps":"a:1","factor":1.2,"rule":"midpoint",)"
        R"("range":[[-1.5,2],[0,1e3]]})"}};

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index >= std::size(seeds))
        return 0;
    const std::string text = seeds[index].text;
    if (text.size() >= capacity)
        return 0;
    out[0] = seeds[index].reader;
    std::memcpy(out + 1, text.data(), text.size());
    return 1 + text.size();
}
