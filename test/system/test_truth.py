"""Ground truth from outside: altitudes, frames of positions, gaps, fixes that nobody can have, and
truth that ranks nothing, in rank, build, info, localise and eval."""

import csv
import json
import struct
import unicodedata
import unittest

from test_cli import Scratch

EAST_DEG = 1.3425e-5  # a metre on the ellipsoid, at 48.1 degrees north


def table(columns, rows):
    return columns + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)


def gps(frames, alt=None, first=0, lon=11.5, step=10):
    """Rows of a drive to the east, `step` metres a frame."""
    rows = [(f"{i:03}.ppm", 48.1, f"{lon + (first + i) * step * EAST_DEG:.9f}")
            for i in range(frames)]
    return table("file,lat,lon", rows) if alt is None else table(
        "file,lat,lon,alt", [(*row, alt) for row in rows])


def metres(frames, first=0):
    return table("file,x,y", [(f"{i:03}.ppm", 10 * (first + i), 0) for i in range(frames)])


class Truth(Scratch):
    def localise(self, *arguments):
        answer = self.vdna_json("localise", *arguments)
        return answer, answer["candidates"][0]


class Altitude(Truth):
    def test_the_altitude_of_another_day_does_not_spoil_recall(self):
        self.pictures("summer", range(6), gps(6, 531.8))
        self.pictures("day", range(6), gps(6, 519.3))
        self.pictures("flat", range(6), gps(6))
        self.vdna("build", "map", "summer")
        for live in ("day", "flat"):
            self.assertEqual(self.localise(live, "map")[1]["recall_percent"], 100)
        answer, in_space = self.localise("day", "map", "--with-altitude")
        self.assertEqual((in_space["recall_percent"], in_space["unreachable"]), (0, 6))
        self.assertTrue(answer["with_altitude"])
        self.assertEqual(
            self.localise("day", "map", "--with-altitude", "--tolerance", 12.6)[1]["good"], 6)
        self.assertEqual(self.localise("day", "map", "--tolerance", 0.001)[1]["good"], 6)
        self.assertIn("the live frames have no altitudes and those of summer have some",
                      self.refused("localise", "flat", "map", "--with-altitude"))

    def test_z_of_a_local_frame_is_an_altitude_too(self):
        for name, z in (("a", 0), ("b", 50)):
            self.pictures(name, range(3), table(
                "file,x,y,z", [(f"{i:03}.ppm", i, 0, z + i) for i in range(3)]))
        self.vdna("build", "map", "a")
        self.assertEqual(self.localise("b", "map")[1]["good"], 3)
        self.assertEqual(self.localise("b", "map", "--with-altitude")[1]["good"], 0)

    def test_eval_judges_horizontally_unless_told_otherwise(self):
        for name, alt in (("a", 100), ("b", 130), ("c", 160)):
            (self.folder / "set").mkdir(exist_ok=True)
            self.pictures(f"set/{name}", range(6), gps(6, alt))
        arguments = ("eval", "set", "--warmup", 2, "--tolerance", 5, "--cache", "cache", "--json",
                     "r.json")
        self.vdna(*arguments)
        result = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(result["recall"]["a"]["b"], 100)
        self.vdna(*arguments, "--with-altitude")
        result = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(result["recall"]["a"]["b"], 0)


class Frames(Truth):
    def setUp(self):
        super().setUp()
        self.pictures("site", range(4), metres(4))
        self.pictures("gps", range(4), gps(4))
        self.vdna("build", "map", "site")

    def test_metres_and_degrees_are_not_labelled_alike(self):
        answer, found = self.localise("gps", "map")
        self.assertIsNone(found["recall_percent"])
        self.assertEqual(found["not_labelled_alike"], "live in frame wgs84, map in local")
        self.assertIsNone(answer["all"]["unit"])
        self.assertIn("not labelled alike: live in frame wgs84, map in local",
                      self.vdna("localise", "gps", "map"))

    def test_local_frames_have_names(self):
        self.vdna("build", "named", "site", "--frame", "hall-3")
        self.assertEqual(self.vdna_json("info", "named")["experiences"][0]["labels"]
                         ["position_frame"], "hall-3")
        self.assertIn("live in frame local, map in hall-3",
                      self.vdna("localise", "site", "named"))
        self.assertIn("tolerance 5 metres",
                      self.vdna("localise", "site", "named", "--frame", "hall-3"))
        self.assertIn("--frame", self.refused("build", "m", "site", "--frame", "hall 3", code=2))
        self.assertIn("leave out --frame", self.refused("build", "m", "gps", "--frame", "hall"))

    def test_a_map_has_one_frame(self):
        sentence = self.refused("build", "map", "gps")
        self.assertIn("not labelled alike: its positions are in frame wgs84, those of "
                      "map/site.vdna in local", sentence)
        self.assertEqual(self.map_files(), ["site.vdna"])
        self.assertIn("not labelled alike", self.refused("build", "both", "site", "gps"))

    def test_info_tells_frames_that_differ_in_maps_of_others(self):
        self.vdna("build", "other", "gps", "--ranges", "map/site.vdna")
        (self.folder / "other/gps.vdna").rename(self.folder / "map/gps.vdna")
        self.assertIn("not labelled alike", self.vdna_json("info", "map")["warnings"][0])
        self.assertIn("not labelled alike", self.run_vdna("info", "map").stderr)

    def test_eval_names_the_traversals_of_two_frames(self):
        (self.folder / "set").mkdir()
        for name in ("site", "gps"):
            (self.folder / name).rename(self.folder / "set" / name)
        self.assertIn("gps is in frame wgs84, site in local",
                      self.refused("eval", "set", "--warmup", 2, "--cache", "cache"))

    def test_positions_come_back_as_they_came(self):
        self.vdna("build", "gps-map", "gps")
        labels = self.vdna_json("info", "gps-map")["experiences"][0]["labels"]
        self.assertEqual(labels["position_frame"], "wgs84")
        self.assertEqual(labels["lat"], [48.1, 48.1])
        for found, expected in zip(labels["lon"], (11.5, 11.5 + 30 * EAST_DEG)):
            self.assertAlmostEqual(found, expected, delta=1e-9)
        self.assertEqual(labels["alt"], [0, 0])
        match = self.localise("gps", "gps-map", "--matches")[1]["matches"][2]
        self.assertEqual(match["position"]["frame"], "wgs84")
        self.assertAlmostEqual(match["position"]["lat"], 48.1, delta=1e-9)
        self.assertAlmostEqual(match["position"]["lon"], 11.5 + 20 * EAST_DEG, delta=1e-9)
        match = self.localise("site", "map", "--matches")[1]["matches"][2]
        self.assertEqual(match["position"], {"frame": "local", "x": 20, "y": 0, "z": 0})


class Gaps(Truth):
    def without(self, text, *rows):
        """The table with these rows of labels empty."""
        lines = text.splitlines()
        for row in rows:
            cells = lines[row + 1].split(",")
            lines[row + 1] = ",".join([cells[0]] + [""] * (len(cells) - 1))
        return "\n".join(lines) + "\n"

    def test_a_frame_without_a_fix_is_a_frame(self):
        self.pictures("whole", range(6), gps(6))
        self.pictures("gap", range(6), self.without(gps(6), 3))
        row_missing = "".join(line for line in gps(6).splitlines(True) if "003" not in line)
        self.pictures("missing", range(6), row_missing)
        self.vdna("build", "map", "whole")
        for live in ("gap", "missing"):
            ranked = self.vdna_json("rank", live, "map", "--warmup", 6)
            self.assertEqual((ranked["frames"], ranked["frames_without_truth"]), (6, 1))
            answer, found = self.localise(live, "map", "--matches")
            self.assertEqual((answer["frames"], answer["frames_without_truth"]), (6, 1))
            self.assertEqual((found["recall_percent"], found["judged"], found["good"]),
                             (100, 5, 5))
            self.assertEqual([m["good"] for m in found["matches"]],
                             [True, True, True, None, True, True])
            self.assertIn("6 frames, 1 without ground truth left out of the recall",
                          self.vdna("localise", live, "map"))
            built = self.vdna_json("build", f"of-{live}", live)["experiences"][0]
            self.assertEqual((built["frames"], built["frames_without_truth"]), (6, 1))
            told = self.vdna_json("info", f"of-{live}")["experiences"][0]["labels"]
            self.assertEqual(told["frames_without_truth"], 1)
            # A map frame without truth is no match that anybody can call good.
            found = self.localise("whole", f"of-{live}")[1]
            self.assertEqual((found["judged"], found["good"]), (6, 6 - 1))

    def test_the_gap_is_in_the_file_as_the_specification_says(self):
        self.pictures("a", range(3), "file,place,x,y\n000.ppm,1,2,3\n001.ppm,,,\n002.ppm,4,,\n")
        self.vdna("build", "map", "a", "--backbone", "efficientnet_lite0_paper")
        data = (self.folder / "map/a.vdna").read_bytes()
        size = struct.unpack_from("<Q", data)[0]
        header = json.loads(data[8:8 + size])
        self.assertEqual(header["__metadata__"]["format_version"], "2")

        def numbers(name, kind):
            begin, end = header[name]["data_offsets"]
            return [n for (n,) in struct.iter_unpack("<" + kind, data[8 + size + begin:
                                                                      8 + size + end])]
        self.assertEqual(numbers("frame_place", "q"), [1, -2**63, 4])
        self.assertEqual(numbers("frame_position", "d")[:3], [2, 3, 0])
        self.assertTrue(all(n != n for n in numbers("frame_position", "d")[3:]))

    def test_eval_leaves_frames_without_truth_out_and_counts_them(self):
        (self.folder / "set").mkdir()
        self.pictures("set/a", range(8), self.without(metres(8), 0, 5))
        self.pictures("set/b", range(8), self.without(metres(8), 6))
        self.pictures("set/c", range(40, 48), metres(8))
        self.vdna("eval", "set", "--warmup", 3, "--tolerance", 0, "--cache", "cache", "--json",
                  "r.json", "--csv", "r.csv", "--html", "r.html", "--npy", "npy")
        result = json.loads((self.folder / "r.json").read_text())
        # Of frames 3 to 7 of a, 5 has no truth, and frame 6 of b has none.
        self.assertEqual(result["counts"]["a"]["b"],
                         {"good": 3, "total": 4, "unreachable": 1, "without_truth": 1})
        self.assertEqual(result["recall"]["a"]["b"], 75)
        self.assertEqual(result["frames"]["a"]["without_truth"], 2)
        with open(self.folder / "r.csv", encoding="utf-8", newline="") as file:
            row = next(r for r in csv.DictReader(file) if (r["query"], r["reference"]) == ("a", "b"))
        self.assertEqual((row["total"], row["without_truth"], row["note"]), ("4", "1", ""))
        self.assertIn("Without truth", (self.folder / "r.html").read_text())
        self.assertIn("Live frames without ground truth, left out of the recall\n  a: 1 of 5\n",
                      self.vdna("eval", "set", "--warmup", 3, "--cache", "cache"))

    def test_eval_refuses_a_query_of_which_nothing_can_be_judged(self):
        (self.folder / "set").mkdir()
        self.pictures("set/a", range(6), self.without(metres(6), 3, 4, 5))
        self.pictures("set/b", range(6), metres(6))
        self.assertIn("a: none of the 3 frames to localise has ground truth",
                      self.refused("eval", "set", "--warmup", 3, "--cache", "cache"))


class Fixes(Truth):
    def test_fixes_that_nobody_can_have_are_left_out_and_told_once(self):
        rows = gps(8).splitlines()
        rows[1] = "000.ppm,0,0"
        rows[3] = "002.ppm,0.000,0.0"
        rows[5] = "004.ppm,95,11.5"
        rows[6] = "005.ppm,nan,nan"
        self.pictures("live", range(8), "\n".join(rows) + "\n")
        self.pictures("whole", range(8), gps(8))
        self.vdna("build", "map", "whole")
        done = self.run_vdna("build", "of-live", "live")
        self.assertEqual(done.stderr, "vdna: live/labels.csv: 4 fixes left out: 1 without a number, "
                                      "2 at 0,0, 1 beyond the globe\n")
        self.assertIn("4 without ground truth", done.stdout)
        found = self.localise("live", "map")[1]
        self.assertEqual((found["judged"], found["recall_percent"]), (4, 100))

    def test_a_receiver_that_never_had_a_fix_gives_no_recall_but_a_ranking(self):
        self.pictures("live", range(4), table("file,lat,lon", [(f"{i:03}.ppm", 0, 0)
                                                               for i in range(4)]))
        self.vdna("build", "map", "live")
        self.assertEqual(self.vdna_json("rank", "live", "map", "--warmup", 2)["frames"], 2)
        self.assertIsNone(self.localise("live", "map")[1]["recall_percent"])


class Names(Truth):
    def test_accents_case_and_slashes_may_be_written_otherwise(self):
        decomposed = unicodedata.normalize("NFD", "Käfer 000.ppm")
        self.pictures("live", range(3))
        for i, name in enumerate((decomposed, "B.PPM", "c.ppm")):
            (self.folder / f"live/{i:03}.ppm").rename(self.folder / "live" / name)
        (self.folder / "live/labels.csv").write_text(
            "file,place\nKäfer 000.ppm,1\nb.ppm,2\nlive\\c.ppm,3\n", encoding="utf-8")
        built = self.vdna_json("build", "map", "live")["experiences"][0]
        self.assertEqual(built["frames_without_truth"], 0)

    def test_tables_may_lie_anywhere_and_name_pictures_relative_to_them_or_to_the_folder(self):
        self.pictures("live", range(2))
        for name, prefix in (("t.csv", ""), ("u.csv", "live/"), ("live/v.csv", "live/")):
            (self.folder / name).write_text(
                "file,place\n" + "".join(f"{prefix}{i:03}.ppm,{i}\n" for i in range(2)))
            built = self.vdna_json("build", "map", "live", "--labels", name, "--force")
            self.assertEqual(built["experiences"][0]["frames_without_truth"], 0, name)

    def test_one_table_of_several_folders_is_relative_to_itself(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2, 4))
        (self.folder / "t.csv").write_text("file,place\n000.ppm,1\n001.ppm,2\n")
        self.assertIn("no row is about a picture of a",
                      self.refused("build", "map", "a", "b", "--labels", "t.csv"))

    def test_a_table_of_other_pictures_is_refused_with_both_spellings(self):
        self.pictures("live", range(2), "file,place\nframe_0.png,1\n")
        sentence = self.refused("build", "map", "live")
        self.assertIn("'frame_0.png'", sentence)
        self.assertRegex(sentence, r"'00\d\.ppm'")


class RankingNothing(Truth):
    def evaluate(self, *arguments):
        self.vdna("eval", "set", "--warmup", 2, "--cache", "cache", "--json", "r.json", "--csv",
                  "r.csv", "--html", "r.html", *arguments)
        text = self.vdna("eval", "set", "--warmup", 2, "--cache", "cache", *arguments)
        with open(self.folder / "r.csv", encoding="utf-8", newline="") as file:
            notes = [row["note"] for row in csv.DictReader(file) if row["reference"] == "all"]
        return (json.loads((self.folder / "r.json").read_text()), notes, text,
                (self.folder / "r.html").read_text())

    def test_equal_recalls_give_no_figure_but_a_sentence(self):
        (self.folder / "set").mkdir()
        for name in "abc":
            self.pictures(f"set/{name}", range(6), metres(6))
        result, notes, text, page = self.evaluate()
        for method in ("vdna", "fd", "pixel", "random"):
            del result["methods"][method]["intervals"]
            self.assertEqual(set(result["methods"][method].values()), {None}, method)
            self.assertRegex(text, rf"(?m)^{method}( +-){{8}}$")
        sentence = "The truth ranks nothing: in every query all references have the same recall"
        self.assertIn(sentence, result["note"])
        self.assertIn(sentence, text)
        self.assertIn(sentence, page)
        self.assertNotIn("*", text.replace("**", "*").split("Visual DNA")[1].split("method")[0])
        self.assertEqual(notes, ["ranks nothing: all references have the same recall"] * 3)
        self.assertEqual(result["queries_that_rank_nothing"], ["a", "b", "c"])

    def test_queries_that_rank_nothing_are_counted_and_left_out(self):
        (self.folder / "set").mkdir()
        self.pictures("set/a", range(6), metres(6))
        self.pictures("set/b", range(6), metres(6))
        self.pictures("set/c", range(50, 56), metres(6, first=900))
        # For c both others are equally wrong, for a and b they are not.
        result, notes, text, page = self.evaluate("--tolerance", 0)
        self.assertEqual(result["queries_that_rank_nothing"], ["c"])
        for place in (result["note"], text, page):
            self.assertIn("1 of 3 queries rank nothing", place)
        self.assertEqual([bool(note) for note in notes], [False, False, True])
        self.vdna("eval", "set", "--warmup", 2, "--tolerance", 0, "--cache", "cache", "--json",
                  "two.json", "--queries", "a,b")
        two = json.loads((self.folder / "two.json").read_text())
        self.assertEqual(result["methods"], two["methods"])


class Info(Truth):
    def test_a_name_that_is_there_twice_is_told(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        (self.folder / "map/b.vdna").write_bytes((self.folder / "map/a.vdna").read_bytes())
        done = self.run_vdna("info", "map", "--json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("map/b.vdna: is called a like map/a.vdna", done.stderr)
        self.assertIn("is called a like", json.loads(done.stdout)["mismatches"][0])


if __name__ == "__main__":
    unittest.main()
