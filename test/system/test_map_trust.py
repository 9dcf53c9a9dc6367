"""What a map knows about itself: `vdna build` and `vdna calibrate --trust` write it, `vdna info` says
it, and a file that is missing, stale or damaged changes nothing else."""

import fcntl
import math
import os
import shutil
import unittest

from test_cli import Scratch
from tiny_network import write_tiny_network

FILE = "trust.safetensors"


class MapTrust(Scratch):
    def setUp(self):
        super().setUp()
        manifest = write_tiny_network(self.folder, ("mean", "samples_neurons"))
        text = manifest.read_text()
        grid = 'output = "map"\ngrid = [1, 2]\ncentre = true\nlast_layer = "mean"'
        manifest.write_text(text.replace('[embedding]\noutput = "mean"', "[embedding]\n" + grid))

    def drive(self, name, frames=24, seed=0, labelled=True):
        """A drive past the same places, which look like `seed`."""
        self.pictures(name, (100 * seed + i for i in range(frames)), None if not labelled else
                      "file,place\n" + "".join(f"{i:03}.ppm,{i}\n" for i in range(frames)))

    def build(self, *drives, options=()):
        return self.vdna("build", "--backbone", "./tiny.toml", *options, "map", *drives)

    def self_knowledge(self):
        return self.vdna_json("info", "map")["maps"][0]

    def test_three_labelled_experiences_are_needed(self):
        for i, name in enumerate("abc"):
            self.drive(name, seed=i)
        self.build("a")
        self.assertEqual(self.map_files(), ["a.vdna"])  # one alone has nothing to find out
        self.assertIn("there is no such file", self.self_knowledge()["trust"])
        self.build("b")
        self.assertEqual(self.map_files(), ["a.vdna", "b.vdna", FILE])
        self.assertIn("no predicted recall: 3 labelled experiences are needed, the map has 2 "
                      "experiences", self.vdna("info", "map"))
        self.build("c")
        known = self.self_knowledge()
        self.assertEqual((known["labelled"], known["tolerance"]), (3, 5))
        self.assertTrue(math.isfinite(known["skill"]))
        self.assertIn("predicted recall from 3 labelled of 3 experiences", known["trust"])

    def test_it_can_be_left_for_later(self):
        for i, name in enumerate("abcd"):
            self.drive(name, seed=i)
        self.build("a", "b", "c", options=["--no-trust"])
        self.assertEqual(self.map_files(), ["a.vdna", "b.vdna", "c.vdna"])
        self.vdna("calibrate", "--trust", "map")
        before = (self.folder / "map" / FILE).read_bytes()
        self.build("d", options=["--no-trust"])
        self.assertEqual((self.folder / "map" / FILE).read_bytes(), before)
        self.assertIn("does not know experience d; make it again with `vdna calibrate --trust map`",
                      self.self_knowledge()["trust"])
        self.vdna("calibrate", "--trust", "map")
        self.assertEqual(self.self_knowledge()["labelled"], 4)
        later = (self.folder / "map" / FILE).read_bytes()
        (self.folder / "map/d.vdna").unlink()
        (self.folder / "map" / FILE).write_bytes(before)
        self.build("d")  # the same as at once
        self.assertEqual((self.folder / "map" / FILE).read_bytes(), later)

    def test_too_many_experiences_are_refused_before_they_are_opened(self):
        (self.folder / "map").mkdir()
        for i in range(4097):
            (self.folder / f"map/{i}.vdna").touch()
        self.assertIn("the map has 4097 experiences, expected at most 4096",
                      self.refused("calibrate", "--trust", "map"))

    def test_one_more_keeps_the_tolerance_of_the_file(self):
        for i, name in enumerate("abcd"):
            self.drive(name, seed=i)
        self.build("a", "b", "c")
        self.assertIn(f"map/{FILE}: predicted recall from 3",
                      self.vdna("calibrate", "--trust", "map", "--tolerance", 2))
        self.build("d")
        known = self.self_knowledge()
        self.assertEqual((known["labelled"], known["tolerance"]), (4, 2))
        self.vdna("calibrate", "--trust", "map", "--tolerance", 0)
        self.assertEqual(self.self_knowledge()["tolerance"], 0)

    def test_what_remains_of_a_map_is_known_and_what_replaces_is_found_out(self):
        for i, name in enumerate("abcd"):
            self.drive(name, seed=i)
        self.build("a", "b", "c", "d")
        (self.folder / "map/d.vdna").unlink()
        self.assertEqual(self.self_knowledge()["labelled"], 3)
        shutil.rmtree(self.folder / "a")
        self.drive("a", seed=7)
        self.build("a", options=["--force"])
        self.assertEqual(self.self_knowledge()["labelled"], 3)

    def test_experiences_without_labels_predict_nothing_and_that_is_said(self):
        self.drive("a")
        self.drive("b", seed=1)
        self.drive("c", seed=2, labelled=False)
        self.build("a", "b", "c")
        self.assertIn("3 labelled experiences are needed, 2 of 3 are; build them with places",
                      self.self_knowledge()["trust"])

    def test_other_taps_predict_nothing_and_that_is_said(self):
        write_tiny_network(self.folder, ("tokens", "samples_neurons"))
        for i, name in enumerate("abc"):
            self.drive(name, seed=i)
        self.build("a", "b", "c")
        self.assertIn("last layer, which may stand for them, is not its only tap",
                      self.self_knowledge()["trust"])

    def test_identical_experiences_and_short_ones_are_defined(self):
        for name, frames in (("a", 24), ("b", 24), ("c", 24), ("short", 5), ("single", 1)):
            self.drive(name, frames)
        self.build("a", "b", "c")
        self.assertEqual(self.self_knowledge()["labelled"], 3)
        self.build("short", "single")
        known = self.self_knowledge()
        self.assertLess(known["labelled"], 5)  # no frame of the single one is outside its window
        self.assertGreaterEqual(known["labelled"], 3)

    def test_a_bad_file_is_told_apart_and_made_again(self):
        for i, name in enumerate("abc"):
            self.drive(name, seed=i)
        self.build("a", "b", "c")
        shutil.copytree(self.folder / "map", self.folder / "other")
        (self.folder / "other/a.vdna").unlink()
        path = self.folder / "map" / FILE
        good = path.read_bytes()
        for bad, reason in ((good[:-1], "cut short"), (good[:-9] + b"\1" + good[-8:], "damaged"),
                            (b"", "0 bytes")):
            path.write_bytes(bad)
            self.assertIn(reason, self.self_knowledge()["trust"])
            self.assertIn("`vdna calibrate --trust map`", self.self_knowledge()["trust"])
            self.vdna("rank", "a", "map", "--backbone", "./tiny.toml", "--warmup", 5)
            self.vdna("calibrate", "--trust", "map")
            self.assertEqual(path.read_bytes(), good)
        self.vdna("build", "--backbone", "./tiny.toml", "--bins", 50, "coarse", "a", "b", "c")
        shutil.copy(self.folder / "coarse" / FILE, path)
        self.assertIn("is of another map", self.self_knowledge()["trust"])
        self.vdna("calibrate", "--trust", "map")
        self.assertEqual(path.read_bytes(), good)

    def test_a_file_that_cannot_be_written_leaves_the_map_complete(self):
        (self.folder / "map" / FILE).mkdir(parents=True)
        for i, name in enumerate("ab"):
            self.drive(name, seed=i)
        done = self.run_vdna("build", "--backbone", "./tiny.toml", "map", "a", "b")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"\Avdna: map/trust.safetensors: .+; the map is complete, but "
                                      r"will not predict recall before `vdna calibrate --trust map`\n\Z")
        self.assertEqual(len(self.vdna_json("info", "map")["experiences"]), 2)

    def test_two_programs_do_not_change_a_map_at_once(self):
        self.drive("a")
        self.build("a")
        held = os.open(self.folder / "map", os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
        self.assertIn("another program is changing this map",
                      self.refused("calibrate", "--trust", "map"))
        os.close(held)
        self.assertIn("the map has 1 experience;", self.vdna("calibrate", "--trust", "map"))

    def test_usage(self):
        for arguments, sentence in (
                (("--trust", "map", "x.json"), "expected no OUT.json and no SOURCE"),
                (("x.json",), "expected OUT.json and SOURCE, or --trust MAP"),
                (("--tolerance", 3, "x.json", "a"), "--tolerance belongs to --trust MAP"),
                (("--trust", "map", "--tolerance", -1), "expected a number from 0")):
            self.assertIn(sentence, self.refused("calibrate", *arguments, code=2))


if __name__ == "__main__":
    unittest.main()
