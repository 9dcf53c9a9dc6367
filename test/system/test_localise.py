"""`vdna localise` as a robot localises, on rendered drives: the place filter and its confidence beside
the nearest frame, and the figure of eight of `vdna simulate`.
"""

import csv
import math
import unittest

from test_cli import Scratch

FRAMES = 60
WARMUP = 10
TOLERANCE = 2.5  # metres
LEAST = 0.9      # confidence


class Drives(Scratch):
    def drive(self, name, *options, frames=FRAMES):
        self.vdna("simulate", name, "--frames", frames, "--step", 1, "--size", "96x72",
                  "--variation", 0.6, *options)

    def setUp(self):
        super().setUp()
        for number, name in enumerate(("summer", "winter", "night")):
            self.drive(name, "--condition", name, "--drive", number)
        self.vdna("build", "map", "summer", "winter")

    def localise(self, *options):
        return self.vdna_json("localise", "night", "map", "--skip", WARMUP, "--tolerance", TOLERANCE,
                              "--min-confidence", LEAST, "--matches", *options)

    def test_the_filter_finds_more_than_the_nearest_frames_and_tells_how_sure_it_is(self):
        found = self.localise()
        everything = found["candidates"] + [found["all"]]
        for answers in everything:
            matches = answers["matches"]
            self.assertEqual(len(matches), FRAMES - WARMUP)
            self.assertEqual(answers["recall_percent"], 2 * sum(m["good"] for m in matches))
            self.assertEqual(answers["nearest_recall_percent"],
                             2 * sum(m["nearest_good"] for m in matches))
            self.assertEqual(answers["unsure_percent"],
                             2 * sum(m["confidence"] < LEAST for m in matches))
            self.assertGreaterEqual(answers["recall_percent"], answers["nearest_recall_percent"])
            for match in matches:
                self.assertTrue(0 <= match["confidence"] <= 1 and match["moving"])
        self.assertGreater(sum(a["recall_percent"] for a in everything),
                           sum(a["nearest_recall_percent"] for a in everything))

    def test_a_drive_on_another_route_is_told_by_its_jumps(self):
        self.drive("elsewhere", "--condition", "summer", "--drive", 3, "--seed", 9, frames=150)
        found = self.vdna_json("localise", "elsewhere", "map", "--skip", WARMUP)
        told = [answers["lost_after_frames"] for answers in found["candidates"]]
        self.assertTrue(all(10 < frames <= 140 for frames in told), told)
        self.assertIsNone(found["all"]["lost_after_frames"])
        text = self.vdna("localise", "elsewhere", "map", "--skip", WARMUP)
        self.assertRegex(text, rf"summer .* another route, by its jumps after {told[0]} frames\n")
        for answers in self.localise()["candidates"]:
            self.assertIsNone(answers["lost_after_frames"])

    def test_all_together_are_the_surest_answer_and_the_nearest_frame(self):
        found = self.localise()
        parts = [c["matches"] for c in found["candidates"]]
        for together, *each in zip(found["all"]["matches"], *parts):
            surest = max(each, key=lambda match: match["confidence"])
            nearest = min(each, key=lambda match: match["distance"])
            for key in ("experience", "frame", "good", "confidence", "position"):
                self.assertEqual(together[key], surest[key])
            for key in ("nearest_experience", "nearest_frame", "nearest_good", "distance"):
                self.assertEqual(together[key], nearest[key])

    def test_without_the_filter_the_nearest_frames_are_the_answers(self):
        nearest = self.localise("--localiser", "nearest")
        for with_filter, without in zip(self.localise()["candidates"], nearest["candidates"]):
            self.assertEqual(without["recall_percent"], with_filter["nearest_recall_percent"])
            self.assertIsNone(without["unsure_percent"])
        text = self.vdna("localise", "night", "map", "--skip", WARMUP, "--localiser", "nearest")
        self.assertIn(f"night: {FRAMES - WARMUP} frames after {WARMUP} of warmup", text)
        self.assertRegex(text, r"experience +recall/% +nearest/% +unsure/% +good +unreachable\n"
                               r"summer +([\d.]+) +\1 +- ")


class Eight(Scratch):
    def test_a_drive_passes_its_crossing_twice_in_a_lap_and_goes_on(self):
        self.vdna("simulate", "eight", "--route", "eight", "--frames", 17, "--step", 21,
                  "--size", "16x16")
        with open(self.folder / "eight/labels.csv", encoding="utf-8", newline="") as file:
            places = [(float(row["x"]), float(row["y"])) for row in csv.DictReader(file)]
        self.assertEqual([i for i, place in enumerate(places) if math.hypot(*place) < 0.1],
                         [0, 6, 12])  # a lap has 252 m
        for i in range(5):
            self.assertLess(math.dist(places[i], places[12 + i]), 0.01)
        self.assertIn("--route", self.refused("simulate", "x", "--route", "nine", code=2))


if __name__ == "__main__":
    unittest.main()
