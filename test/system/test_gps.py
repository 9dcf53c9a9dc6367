"""Ground truth from a GPS track: drives of vdna simulate whose pictures have no labels, and tracks as
a phone would have recorded them.
"""

import datetime
import math
import unittest

from selectord import image_message, lcm_log
from test_cli import Experience, Scratch

FRAMES = 60
RATE = 10    # Hz
STEP = 1     # metres between frames
START = datetime.datetime(2024, 5, 1, 12, tzinfo=datetime.timezone.utc)
HOME = 51.75, -1.26  # degrees, where the route begins

# WGS84
A = 6378137.0
E2 = 2 / 298.257223563 - 1 / 298.257223563**2


def degrees_of(x, y):
    """Latitude and longitude of a point of the route, in metres from its beginning."""
    lat = math.radians(HOME[0])
    w = math.sqrt(1 - E2 * math.sin(lat)**2)
    return (HOME[0] + math.degrees(y / (A * (1 - E2) / w**3)),
            HOME[1] + math.degrees(x / (A / w * math.cos(lat))))


def earth_centred(lat, lon):
    lat, lon = math.radians(lat), math.radians(lon)
    n = A / math.sqrt(1 - E2 * math.sin(lat)**2)
    return n * math.cos(lat) * math.cos(lon), n * math.cos(lat) * math.sin(lon), n * (1 - E2) * math.sin(lat)


def microseconds(seconds):
    return round((START.timestamp() + seconds) * 1e6)


class Drives(Scratch):
    """A map and a live drive of the same route, without labels."""

    def drive(self, name, *options):
        """Render a drive and take its labels away; they are returned as (x, y) of each frame."""
        self.vdna("simulate", name, "--frames", FRAMES, "--rate", RATE, "--step", STEP,
                  "--size", "96x64", *options)
        labels = self.folder / name / "labels.csv"
        rows = [line.split(",") for line in labels.read_text().splitlines()[1:]]
        labels.unlink()
        return [(float(x), float(y)) for _, _, x, y in rows]

    def gpx(self, name, places, every=RATE):
        """A track with a fix of each `every`-th frame, and one of the last."""
        points = []
        for frame in sorted({*range(0, len(places), every), len(places) - 1}):
            lat, lon = degrees_of(*places[frame])
            time = (START + datetime.timedelta(seconds=frame / RATE)).isoformat()
            points.append(f'<trkpt lat="{lat:.9f}" lon="{lon:.9f}"><time>{time}</time></trkpt>\n')
        return self.write(name, '<gpx version="1.1"><trk><trkseg>' + "".join(points) +
                          "</trkseg></trk></gpx>")

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def setUp(self):
        super().setUp()
        self.places = self.drive("summer")


class Tracks(Drives):
    """Positions of frames."""

    def assert_labelled(self, places, within):
        """The experience summer has these positions and the times of the track."""
        experience = Experience(self.folder / "map/summer.vdna")
        found = experience.tensors["frame_position"]
        self.assertEqual(len(found), 3 * len(places))
        for i, place in enumerate(places):
            expected = earth_centred(*degrees_of(*place))
            self.assertLess(math.dist(found[3 * i:3 * i + 3], expected), within)
        self.assertEqual(experience.tensors["frame_utime"],
                         [microseconds(frame / RATE) for frame in range(len(places))])

    def test_a_gpx_track_gives_each_picture_its_position(self):
        self.vdna("build", "map", "summer", "--gps", self.gpx("a.gpx", self.places),
                  "--time-offset", "2024-05-01T14:00:00+02:00")
        self.assert_labelled(self.places, within=0.5)  # the road bends between two fixes

    def test_a_table_of_a_phone_does_so_too(self):
        rows = "".join(f"{microseconds(i / RATE) / 1e6:.6f},{lat:.9f},{lon:.9f}\n"
                       for i, (lat, lon) in enumerate(degrees_of(*place) for place in self.places))
        self.vdna("build", "map", "summer", "--gps",
                  self.write("a.csv", "Timestamp,Latitude,Longitude\n" + rows),
                  "--time-offset", START.timestamp())
        self.assert_labelled(self.places, within=0.01)

    def test_a_track_of_another_time_is_refused_with_both_times(self):
        error = self.refused("build", "map", "summer", "--gps", self.gpx("a.gpx", self.places))
        self.assertIn("a.gpx: the track is from 2024-05-01T12:00:00.000Z to "
                      "2024-05-01T12:00:05.900Z, but the frames of summer begin at "
                      "1970-01-01T00:00:00.000Z; set --time-offset", error)
        self.assertEqual(self.map_files(), [])

    def test_gaps_longer_than_allowed_are_refused_with_the_remedy(self):
        track = self.gpx("a.gpx", self.places, every=30)
        offset = "2024-05-01T12:00:00.05Z"  # so that no frame is at a fix
        self.assertIn("a.gpx: its fixes are 3 s apart",
                      self.refused("build", "map", "summer", "--gps", track, "--gps-gap", 1,
                                   "--time-offset", offset))

    def test_the_options_are_checked(self):
        for options in (["--time-offset", "soon"], ["--time-offset", "1e300"],
                        ["--gps", "a.gpx", "--gps-gap", "0"], ["--gps", "a.gpx", "--gps-gap", "nan"]):
            self.refused("build", "map", "summer", *options, code=2)


class Localise(Drives):
    """Recall by tracks."""

    def test_recall_is_that_of_the_labels(self):
        live = self.drive("live", "--drive", 5, "--variation", 0.5)
        clock = ["--time-offset", START.isoformat()]
        self.vdna("build", "map", "summer", "--gps", self.gpx("a.gpx", self.places), *clock)
        found = self.vdna_json("localise", "live", "map", "--gps", self.gpx("b.gpx", live), *clock,
                               "--tolerance", 5, "--matches")["candidates"][0]
        good = [math.dist(live[match["live_frame"]], self.places[match["frame"]]) <= 5
                for match in found["matches"]]
        self.assertEqual(len(good), FRAMES)
        self.assertIn(True, good)
        self.assertEqual(found["good"], sum(good))


class ReadmeUser(Drives):
    """The four commands of the README: a video, a log and a folder of 1.jpg, 2.jpg ..., each with the
    track of a phone."""

    def test_gets_a_labelled_map_and_the_right_place(self):
        clock = ["--time-offset", START.isoformat()]
        pictures = {name: self.gpx(f"{name}.gpx", self.drive(
            name, "--condition", condition, "--drive", number, "--variation", 0.5))
            for number, (name, condition) in enumerate(
                {"today": "summer", "winter": "winter", "night": "night"}.items(), 2)}
        summer = self.gpx("summer.gpx", self.places)
        jpegs = sorted((self.folder / "summer").glob("*.jpg"))
        (self.folder / "summer.mjpeg").write_bytes(b"".join(j.read_bytes() for j in jpegs))
        lcm_log(self.folder / "winter.lcm", [
            ("CAMERA", image_message(microseconds(i / RATE), picture.read_bytes()))
            for i, picture in enumerate(sorted((self.folder / "winter").glob("*.jpg")))])
        for i, picture in enumerate(sorted((self.folder / "night").glob("*.jpg"))):
            picture.rename(picture.with_name(f"{i + 1}.jpg"))

        self.vdna("build", "map", "summer.mjpeg", "--rate", RATE, "--gps", summer, *clock)
        self.vdna("build", "map", "winter.lcm", "--gps", pictures["winter"])
        self.vdna("build", "map", "night", "--rate", RATE, "--gps", pictures["night"], *clock)
        found = self.vdna_json("localise", "today", "map", "--skip", 10, "--rate", RATE,
                               "--gps", pictures["today"], *clock)

        recall = {c["experience"]: c["recall_percent"] for c in found["candidates"]}
        self.assertGreaterEqual(recall["summer"], 90)
        orders = {e["experience"]: e["order"]
                  for e in self.vdna_json("info", "map")["experiences"]}
        self.assertEqual(orders, {"summer": "video", "winter": "log", "night": "numbers"})
        for experience in self.vdna_json("info", "map")["experiences"]:
            self.assertEqual(experience["labels"]["position_frame"], "wgs84")


if __name__ == "__main__":
    unittest.main()
