"""Files of a map that are cut short, overwritten or changed byte by byte, in place, while the daemon
serves it or opens it: its answers are those of the map as it was, or it names the file; where files
are mapped, it may also answer FAULT from then on."""

import json
import os
import random
import shutil
import subprocess
import time
import unittest

from selectord import BIN, image_message, jpegs_in, lcm_log, vdna
from tiny_maps import EXPERIENCES, TinyMaps

FRAMES = 24
WARMUP = 12
MOMENTS = 100
STARTS = 100 if os.environ.get("VDNA_ALL") else 15


class ChangedInPlace(TinyMaps):
    versions = ()

    def setUp(self):
        super().setUp()
        self.chance = random.Random(1)
        drives = [self.folder / name for name in EXPERIENCES]
        for drive in drives:
            vdna("simulate", drive, "--condition", drive.name, "--frames", FRAMES)
        vdna("build", "--backbone", self.folder / "tiny.toml", self.folder / "good.map", *drives)
        self.log = lcm_log(str(self.folder / "log"),
                           [("CAMERA", image_message(number * 100000, picture))
                            for number, picture in enumerate(jpegs_in(drives[1]))])
        (self.folder / "mapped.toml").write_text("[map]\ncopy = false\n")
        self.answers = self.folder / "answers.jsonl"
        self.expected = self.undisturbed()

    def begin(self, speed, *options, folder="map"):
        self.restore("good")
        self.answers.unlink(missing_ok=True)
        return subprocess.Popen(
            [os.path.join(BIN, "vdna_selectord"), "--map", folder, "--backbone", "./tiny.toml",
             "--warmup-frames", str(WARMUP), "-l", f"file://{self.log}?speed={speed}",
             "--answers", self.answers, *options],
            cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def restore(self, version):
        super().restore(version)
        self.files_of_map = [self.folder / "map" / f"{name}.vdna" for name in EXPERIENCES]
        self.good = {path: path.read_bytes() for path in self.files_of_map}

    def undisturbed(self):
        with self.begin(0) as daemon:
            self.assertEqual(daemon.wait(60), 0, daemon.stderr.read())
        return self.answers.read_bytes()

    def damage(self, path):
        """One change that leaves a file that nobody wrote."""
        kind = self.chance.randrange(3)
        size = path.stat().st_size
        if kind == 0 or size == 0:
            os.truncate(path, self.chance.randrange(len(self.good[path])))
        elif kind == 1:
            with path.open("r+b") as file:
                file.seek(self.chance.randrange(size))
                file.write(b"\xa5\x5a")
        else:
            path.write_bytes(self.chance.randbytes(size))  # truncates first, as cp does

    def test_at_a_hundred_moments_of_a_drive_changes_no_answer(self):
        with self.begin(1) as daemon:
            self.assertIn("READY", daemon.stdout.readline())
            for _ in range(MOMENTS):
                path = self.chance.choice(self.files_of_map)
                if self.chance.random() < 0.7:
                    self.damage(path)
                else:
                    path.write_bytes(self.good[self.chance.choice(self.files_of_map)])
                time.sleep(self.chance.random() * 2 * FRAMES / 10 / MOMENTS * 0.8)
            self.assertIsNone(daemon.poll(), "the drive was over before the changes")
            self.assertEqual(daemon.wait(60), 0, daemon.stderr.read())
        self.assertEqual(self.answers.read_bytes(), self.expected)

    def test_of_mapped_files_at_a_random_moment_is_a_fault_from_then_on(self):
        """A log at forty times its speed, so that it ends some 60 ms after READY."""
        outcomes = {"all as before": 0, "some as before": 0, "none": 0}
        for _ in range(MOMENTS):
            with self.begin(40, "-c", "mapped.toml") as daemon:
                self.assertIn("READY", daemon.stdout.readline())
                time.sleep(self.chance.random() * 0.07)
                self.damage(self.chance.choice(self.files_of_map))
                code, error = daemon.wait(60), daemon.stderr.read()
            good = self.count_good()
            # 1: no frame of the log could be used.
            self.assertIn(code, (0, 1) if good == 0 else (0,), error)
            outcomes[{0: "none", FRAMES: "all as before"}.get(good, "some as before")] += 1
        print(f"{MOMENTS} moments, answers: {outcomes}")
        self.assertGreater(outcomes["some as before"], MOMENTS // 4)

    def count_good(self):
        """How many answers are those of the map as it was; all others must be FAULT, and later."""
        expected, found = self.expected.splitlines(), self.answers.read_bytes().splitlines()
        same = 0
        while same < len(found) and found[same] == expected[same]:
            same += 1
        for line in found[same:]:
            answer = json.loads(line)
            self.assertEqual((answer.get("validity"), answer["frame"]), ("FAULT", None), line)
            self.assertIn("changed in place", answer["reason"])
        answers = [line for line in found if b'"type":"localisation"' in line]
        self.assertEqual(len(answers), FRAMES)
        return FRAMES - (len(found) - same)

    def test_while_the_map_is_opened_leaves_the_file_out_or_changes_nothing(self):
        outcomes = {"unchanged": 0, "left out": 0}
        for _ in range(STARTS):
            with self.begin(0) as daemon:
                path = self.chance.choice(self.files_of_map)
                time.sleep(self.chance.random() * 0.015)
                self.damage(path)
                self.assertEqual(daemon.wait(60), 0)
                error = daemon.stderr.read()
            if path.name in error:
                self.check_left_out(path, error)
                outcomes["left out"] += 1
            else:
                self.assertEqual(self.answers.read_bytes(), self.expected)
                outcomes["unchanged"] += 1
        print(f"{STARTS} starts: {outcomes}")

    def check_left_out(self, path, error):
        self.assertRegex(error, rf"vdna_selectord: map/{path.name}: .+; left out, 2 of 3 experiences "
                                r"serve\n")
        self.assertNotIn(f'"{path.stem}"', self.answers.read_text())

    def run_damaged(self, *options):
        with self.begin(0, *options, folder="damaged.map") as daemon:
            return daemon.wait(60), daemon.stderr.read()

    def test_before_the_start_is_named_and_left_out_or_refused(self):
        shutil.copytree(self.folder / "good.map", self.folder / "damaged.map")
        path = self.folder / "damaged.map/summer.vdna"
        os.truncate(path, 5000)
        code, error = self.run_damaged()
        self.assertEqual(code, 0, error)
        self.assertIn("vdna_selectord: damaged.map/summer.vdna: ", error)
        self.assertIn("; left out, 2 of 3 experiences serve\n", error)
        self.assertNotIn('"summer"', self.answers.read_text())
        (self.folder / "whole.toml").write_text("[map]\nleave_out_damaged = false\n")
        code, error = self.run_damaged("-c", "whole.toml")
        self.assertEqual(code, 1)
        self.assertRegex(error, r"\Avdna_selectord: damaged.map/summer.vdna: .+\n\Z")
        self.assertFalse(self.answers.exists())


if __name__ == "__main__":
    unittest.main()
