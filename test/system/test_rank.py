"""What `vdna rank` says of the choice: what is expected of it, that none fits, or why nothing is predicted.

A day map of rendered drives meets another day, a night, and pictures that show nothing.
"""

import json
import math
import os
import random
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from test_cli import VDNA, Scratch

DAYS = "spring", "summer", "autumn", "overcast"
FRAMES, WARMUP = 60, 30
WIDTH, HEIGHT = 160, 120


def vdna(*arguments):
    subprocess.run([VDNA, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def simulate(folder, condition, drive, frames=FRAMES, *more):
    vdna("simulate", folder, "--condition", condition, "--drive", drive, "--frames", frames, "--step", 2,
         "--variation", 0.6, "--size", f"{WIDTH}x{HEIGHT}", *more)


def write_pixels(folder, pixels):
    """A drive of WARMUP pictures; pixels() gives the bytes of each."""
    folder.mkdir()
    for i in range(WARMUP):
        (folder / f"{i:03}.ppm").write_bytes(b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + pixels())


class Rank(Scratch):
    @classmethod
    def setUpClass(cls):
        cls.drives = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vdna-rank-")))
        for i, condition in enumerate(DAYS):
            simulate(cls.drives / condition, condition, i)
            shutil.copytree(cls.drives / condition, cls.drives / "bare" / condition,
                            ignore=shutil.ignore_patterns("labels.csv"))
        simulate(cls.drives / "summer2", "summer", 11, WARMUP)
        simulate(cls.drives / "night", "night", 12, WARMUP)
        vdna("build", cls.drives / "days", *(cls.drives / day for day in DAYS))
        vdna("build", cls.drives / "unlabelled", *(cls.drives / "bare" / day for day in DAYS[:3]))

    def copy_of(self, name):
        return shutil.copytree(self.drives / name, self.folder / name)

    def rank(self, live, world, *options, code=0):
        """The text and the JSON of a ranking that ends with this code, the reason of which is no error."""
        texts = []
        for more in ((), ("--json",)):
            done = self.run_vdna("rank", self.drives / live, world, "--warmup", WARMUP, *options, *more)
            self.assertEqual((done.returncode, done.stderr), (code, ""), done.stdout)
            texts.append(done.stdout)
        told = json.loads(texts[1])
        self.assertEqual(texts[0].splitlines()[-1], told["sentence"])
        return texts[0], told

    def test_another_day_of_a_look_that_the_map_has_is_predicted(self):
        text, told = self.rank("summer2", self.drives / "days")
        self.assertEqual((told["ranked_by"], told["verdict"], told["labelled"]), ("transfer", "", 4))
        first = told["ranking"][0]
        self.assertEqual((first["experience"], first["no_prediction"]), ("summer", ""))
        self.assertTrue(0 < first["predicted_low"] <= first["predicted_recall"]
                        <= first["predicted_high"] <= 1)
        by_transfer = [entry["transfer"] for entry in told["ranking"]]
        self.assertEqual(by_transfer, sorted(by_transfer, reverse=True))
        self.assertRegex(text, r"\A.+: 30 frames, ranked by transfer\nrank +experience +distance/bins "
                               r"+transfer/% +recall/% +of 80 %\n   1 +summer +[\d.]+ +[\d.]+ +[\d.]+ "
                               r"+[\d.]+ to [\d.]+\n")
        self.assertRegex(told["sentence"], r"\Aselected summer of 4 after 30 frames: expects \d+ % "
                                           r"\(\d+ to \d+\) of frames right\Z")

    def test_the_order_of_the_paper_can_be_had_and_predictions_stay(self):
        _, transfer = self.rank("summer2", self.drives / "days")
        _, told = self.rank("summer2", self.drives / "days", "--rank", "emd")
        self.assertEqual(told["ranked_by"], "emd")
        distances = [entry["distance_bins"] for entry in told["ranking"]]
        self.assertEqual(distances, sorted(distances))
        self.assertCountEqual(told["ranking"], transfer["ranking"])

    def test_a_night_drive_fits_no_day(self):
        _, told = self.rank("night", self.drives / "days", code=3)
        self.assertEqual(told["verdict"], "unlike")
        self.assertGreater(told["unlike"], 0.1)
        for entry in told["ranking"]:
            self.assertIsNone(entry["predicted_recall"])
            self.assertEqual(entry["no_prediction"],
                             "the live frames look like none of the experiences")
        self.assertIn("none of 4 experiences looks like this run", told["sentence"])
        self.assertIn("record one now with `vdna build`", told["sentence"])

    def test_less_recall_than_is_asked_for_fits_no_better(self):
        _, told = self.rank("summer2", self.drives / "days", "--min-recall", 1, code=3)
        self.assertEqual(told["verdict"], "poor")
        self.assertIn("none of 4 experiences is good enough: the best, ", told["sentence"])
        self.assertIsNotNone(told["ranking"][0]["predicted_recall"])

    def test_pictures_that_show_nothing_fit_no_day(self):
        chance = random.Random(1)
        numbers = WIDTH * HEIGHT * 3
        for name, pixels in (("black", lambda: bytes(numbers)),
                             ("white", lambda: b"\xff" * numbers),
                             ("lens cap", lambda: bytes(chance.choices(range(8), k=numbers))),
                             ("noise", lambda: chance.randbytes(numbers))):
            write_pixels(self.folder / name, pixels)
        (self.folder / "blurred").mkdir()
        for picture in sorted((self.drives / "summer2").glob("*.jpg")):
            subprocess.run([os.environ["VDNA_TRANSCODE"], picture,
                            self.folder / "blurred" / picture.name, "blurred"], check=True)
        for name in ("black", "white", "lens cap", "noise", "blurred"):
            with self.subTest(live=name):
                _, told = self.rank(self.folder / name, self.drives / "days", code=3)
                self.assertEqual(told["verdict"], "unlike")

    def test_a_covered_lens_is_told_from_a_night_that_the_map_has(self):
        chance = random.Random(1)
        drives = [self.folder / condition for condition in ("autumn", "winter", "night")]
        for i, drive in enumerate(drives):
            simulate(drive, drive.name, i, FRAMES, "--seed", 42)
        vdna("build", self.folder / "map", *drives)
        write_pixels(self.folder / "covered", lambda: bytes(chance.choices(range(8), k=WIDTH * HEIGHT * 3)))
        _, told = self.rank(self.folder / "covered", self.folder / "map", code=3)
        self.assertEqual(told["verdict"], "blank")
        self.assertLess(told["unlike"], 0.1)
        self.assertIsNone(told["ranking"][0]["predicted_recall"])
        self.assertEqual(told["sentence"], "the frames hardly differ and look like none of 3 experiences: see "
                                           "whether the lens is covered, or the camera broken")

    def test_what_is_excluded_votes_no_more(self):
        _, told = self.rank("summer2", self.drives / "days", "--exclude", "summer")
        self.assertEqual((len(told["ranking"]), told["labelled"]), (3, 3))
        self.assertIsNotNone(told["ranking"][0]["predicted_recall"])
        _, told = self.rank("summer2", self.drives / "days", "--exclude", "summer", "overcast")
        self.assertTrue(all(entry["predicted_recall"] is None for entry in told["ranking"]))
        self.assertIn("no prediction: 3 labelled experiences are needed, the map has 2 experiences",
                      told["sentence"])
        _, told = self.rank("summer2", self.drives / "days", "--exclude", "spring", "autumn", "overcast")
        self.assertEqual((told["ranked_by"], told["unlike"]), ("emd", None))

    def test_without_labels_nothing_is_predicted_and_night_fits_no_day_all_the_same(self):
        text, told = self.rank("summer2", self.drives / "unlabelled")
        self.assertEqual((told["ranked_by"], told["labelled"], told["skill"]), ("emd", 0, None))
        for entry in told["ranking"]:
            self.assertEqual([entry[key] for key in ("predicted_recall", "predicted_low",
                                                     "predicted_high", "transfer")], [None] * 4)
            self.assertTrue(math.isfinite(entry["score"]))
        self.assertNotIn("recall/%", text)
        self.assertIn("no prediction: 3 labelled experiences are needed, 0 of 3 are; build them with "
                      "places or positions", told["sentence"])
        self.rank("night", self.drives / "unlabelled", code=3)

    def test_a_candidate_without_labels_has_no_prediction_of_its_own(self):
        world = self.copy_of("unlabelled")
        self.vdna("build", world, self.drives / "overcast", "--name", "a")
        self.vdna("build", world, self.drives / "summer", "--name", "b")
        _, told = self.rank("summer2", world)
        self.assertEqual((told["ranked_by"], told["labelled"]), ("emd", 2))
        self.assertIn("3 labelled experiences are needed, 2 of 5 are", told["sentence"])
        self.vdna("build", world, self.drives / "spring", "--name", "c")
        _, told = self.rank("summer2", world)
        self.assertEqual((told["ranked_by"], told["labelled"]), ("emd", 3))
        reasons = {entry["experience"]: entry["no_prediction"] for entry in told["ranking"]}
        self.assertEqual(reasons, dict.fromkeys("abc", "") | dict.fromkeys(
            DAYS[:3], "this experience is not labelled"))

    def test_a_map_that_knows_itself_as_it_was_says_so_and_ranks(self):
        world = self.copy_of("days")
        known = (world / "trust.safetensors").read_bytes()
        self.vdna("build", world, self.drives / "bare/summer", "--force")
        self.assertEqual(self.rank("summer2", world)[1]["labelled"], 3)
        (world / "trust.safetensors").write_bytes(known)
        for reason in ("summer", "there is no such file"):
            _, told = self.rank("summer2", world)
            self.assertEqual((told["ranked_by"], told["unlike"]), ("emd", None))
            self.assertEqual(told["ranking"][0]["experience"], "summer")
            self.assertRegex(told["sentence"], f"no prediction: .*{reason}.*`vdna calibrate --trust {world}`")
            (world / "trust.safetensors").unlink(missing_ok=True)
        self.vdna("calibrate", "--trust", world)
        self.assertEqual(self.rank("summer2", world)[1]["labelled"], 3)

    def test_usage(self):
        for option, value in (("--rank", "fd"), ("--min-recall", 1.5), ("--min-recall", "nan")):
            self.assertIn(option, self.refused("rank", "a", "map", option, value, code=2))


if __name__ == "__main__":
    unittest.main()
