"""The vdna program from outside: build, calibrate, info, rank, localise, and their errors.

The test makes pictures, reads experience files (docs/reference/SPEC-map.md), and recomputes counts
and distances in plain Python, so nothing is compared with itself.
"""

import json
import math
import os
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from xml.etree import ElementTree

VDNA = Path(os.environ["VDNA_BIN"]) / "vdna"


def write_picture(path, seed, width=48, height=32):
    """A binary PPM of coloured rectangles."""
    chance = random.Random(seed)
    pixels = bytearray(bytes(chance.randrange(256) for _ in range(3)) * (width * height))
    for _ in range(6):
        colour = bytes(chance.randrange(256) for _ in range(3))
        left, top = chance.randrange(width - 8), chance.randrange(height - 8)
        span = chance.randrange(4, width - left)
        for y in range(top, chance.randrange(top + 4, height)):
            begin = 3 * (y * width + left)
            pixels[begin:begin + 3 * span] = colour * span
    path.write_bytes(b"P6\n%d %d\n255\n" % (width, height) + pixels)


# One layer is tapped and localises: the embeddings of a file are its activations.
PAPERS = "efficientnet_lite0_paper"
MODELS = VDNA.parents[1] / "share/vdna/models"


class Experience:
    """An experience file, parsed by the safetensors layout alone."""

    FORMATS = {"U32": "I", "F32": "f", "F64": "d", "I64": "q", "I8": "b", "U8": "B"}

    def __init__(self, path):
        data = Path(path).read_bytes()
        size = struct.unpack_from("<Q", data)[0]
        header = json.loads(data[8:8 + size])
        self.metadata = header.pop("__metadata__")
        self.tensors = {}
        for name, tensor in header.items():
            begin, end = tensor["data_offsets"]
            numbers = struct.iter_unpack("<" + self.FORMATS[tensor["dtype"]],
                                         data[8 + size + begin:8 + size + end])
            self.tensors[name] = [number for (number,) in numbers]
        self.bins, self.neurons = header["counts"]["shape"]
        self.frames, self.dim = header.get("embeddings", header.get("frame_embedding"))["shape"]

    def row(self, neuron):
        """The counts of one neuron."""
        return self.tensors["counts"][neuron::self.neurons]

    def recount(self, neuron):
        """The same counts from the embeddings, the activations of a PAPERS backbone."""
        lo, hi = self.tensors["range"][2 * neuron:2 * neuron + 2]
        mid, half = (lo + hi) / 2, (hi - lo) / 2
        counts = [0] * self.bins
        for value in self.tensors["embeddings"][neuron::self.dim]:
            x = min(max((value - mid) / half, -1.0), 1.0)
            counts[min(self.bins - 1, math.floor((x + 1) * self.bins / 2))] += 1
        return counts


def distance(p, q):
    """Mean Earth Mover's Distance in bins, summed in integers."""
    total = 0.0
    for neuron in range(p.neurons):
        a, b = p.row(neuron), q.row(neuron)
        mass_a, mass_b = sum(a), sum(b)
        moved = work = 0
        for i, j in zip(a, b):
            moved += i * mass_b - j * mass_a
            work += abs(moved)
        total += work / (mass_a * mass_b)
    return total / p.neurons


class Scratch(unittest.TestCase):
    """A folder per test, and ways to run the program in it."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-cli-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def pictures(self, name, seeds, labels=None):
        """A folder of pictures, one per seed; returns its path."""
        folder = self.folder / name
        folder.mkdir()
        for i, seed in enumerate(seeds):
            write_picture(folder / f"{i:03}.ppm", seed)
        if labels:
            (folder / "labels.csv").write_text(labels)
        return folder

    def run_vdna(self, *arguments):
        return subprocess.run([str(VDNA), *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)

    def vdna(self, *arguments):
        """The output of a run that must succeed."""
        done = self.run_vdna(*arguments)
        self.assertEqual(done.returncode, 0, f"vdna {arguments}: {done.stderr}")
        return done.stdout

    def vdna_json(self, *arguments):
        return json.loads(self.vdna(*arguments, "--json"))

    def refused(self, *arguments, code=1):
        """The error message of a run that must fail."""
        done = self.run_vdna(*arguments)
        self.assertEqual(done.returncode, code, f"vdna {arguments}: {done.stderr}")
        self.assertRegex(done.stderr, r"\Avdna: .+\n\Z")
        self.assertEqual(done.stdout, "")
        return done.stderr

    def map_files(self):
        return sorted(path.name for path in (self.folder / "map").glob("**/*"))


class Build(Scratch):
    def test_counts_are_those_of_an_independent_recount(self):
        self.pictures("a", range(5))
        self.pictures("b", range(10, 13))
        self.vdna("build", "map", "a", "b", "--bins", 50, "--backbone", PAPERS)
        for name, frames in (("a", 5), ("b", 3)):
            file = Experience(self.folder / "map" / f"{name}.vdna")
            self.assertEqual((file.frames, file.bins), (frames, 50))
            for neuron in range(file.neurons):
                self.assertEqual(file.row(neuron), file.recount(neuron), f"neuron {neuron}")

    def test_ranges_contain_what_was_seen_with_a_tenth_to_spare_on_each_side(self):
        self.pictures("a", range(4))
        self.vdna("build", "map", "a", "--backbone", PAPERS)
        file = Experience(self.folder / "map/a.vdna")
        seen = file.tensors["embeddings"][0::file.dim]
        lo, hi = file.tensors["range"][:2]
        spare = (max(seen) - min(seen)) / 10
        self.assertAlmostEqual(lo, min(seen) - spare, places=5)
        self.assertAlmostEqual(hi, max(seen) + spare, places=5)

    def test_the_rule_of_the_reference_widens_about_zero(self):
        self.pictures("a", range(4))
        self.vdna("build", "map", "a", "--range-rule", "zero", "--backbone", PAPERS)
        file = Experience(self.folder / "map/a.vdna")
        seen = file.tensors["embeddings"][0::file.dim]
        self.assertAlmostEqual(file.tensors["range"][1], 1.2 * max(seen), places=5)

    def test_an_experience_added_later_has_the_ranges_and_bins_of_the_map(self):
        self.pictures("a", range(4))
        self.pictures("b", range(20, 24))
        self.vdna("build", "map", "a", "--bins", 64)
        self.vdna("build", "map", "b")
        a, b = (Experience(self.folder / f"map/{name}.vdna") for name in "ab")
        self.assertEqual(a.tensors["range"], b.tensors["range"])
        self.assertEqual(b.bins, 64)
        self.assertEqual(self.vdna_json("info", "map")["mismatches"], [])

    def test_an_addition_reads_no_experience_but_one(self):
        for i, name in enumerate("abc"):
            self.pictures(name, range(10 * i, 10 * i + 4))
        self.vdna("build", "map", "a", "b", "--no-trust")
        path = self.folder / "map/b.vdna"
        whole = path.read_bytes()
        path.write_bytes(whole[:-8] + b"\xff" * 8)  # its numbers, not its header
        self.vdna("build", "map", "c", "--no-trust")
        self.assertIn("b.vdna: the bytes have CRC-32C",
                      self.refused("rank", "c", "map", "--warmup", 2))
        path.write_bytes(whole)
        self.assertEqual(self.vdna_json("info", "map")["mismatches"], [])

    def test_an_experience_of_a_name_that_another_file_has_is_refused(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2))
        self.vdna("build", "map", "a", "b")
        (self.folder / "map/b.vdna").rename(self.folder / "map/c.vdna")
        self.assertIn("c.vdna: is already called b", self.refused("build", "map", "b"))

    def test_other_bins_than_the_map_has_are_refused_before_the_work(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2))
        self.vdna("build", "map", "a")
        self.assertIn("bins", self.refused("build", "map", "b", "--bins", 64))
        self.assertEqual(self.map_files(), ["a.vdna"])

    def test_an_existing_experience_is_replaced_only_with_force(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        before = (self.folder / "map/a.vdna").read_bytes()
        write_picture(self.folder / "a/002.ppm", 99)
        self.assertIn("--force", self.refused("build", "map", "a"))
        self.assertEqual((self.folder / "map/a.vdna").read_bytes(), before)
        self.vdna("build", "map", "a", "--force")
        self.assertEqual(Experience(self.folder / "map/a.vdna").frames, 3)

    def test_a_map_can_be_rebuilt_with_another_backbone(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        self.vdna("build", "map", "a", "--force", "--backbone", "mobilenet_v2")
        file = Experience(self.folder / "map/a.vdna")
        self.assertEqual(file.metadata["backbone"], "mobilenet_v2")

    def test_a_map_keeps_the_layer_of_the_paper_beside_the_grid(self):
        self.pictures("a", range(3))
        self.vdna("build", "map", "a")
        self.vdna("build", "old", "a", "--backbone", PAPERS)
        new, old = (Experience(self.folder / name / "a.vdna") for name in ("map", "old"))
        self.assertEqual((new.dim, old.dim), (112 * 3 * 3, 1280))
        self.assertEqual((new.metadata["format_version"], old.metadata["format_version"]),
                         ("3", "1"))
        self.assertEqual(new.metadata["embedding"], "feat_s16 grid=3x3 last=embedding centred")
        self.assertNotIn("embedding", old.metadata)
        self.assertEqual(new.tensors["counts"], old.tensors["counts"])
        for i, scale in enumerate(new.tensors["frame_last_layer_scale"]):
            codes = new.tensors["frame_last_layer"][1280 * i:1280 * (i + 1)]
            values = old.tensors["embeddings"][1280 * i:1280 * (i + 1)]
            self.assertAlmostEqual(127 * scale, max(map(abs, values)), places=5)
            for code, value in zip(codes, values):
                self.assertLessEqual(abs(code * scale - value), 0.5001 * scale)

    def test_embeddings_stored_in_8_bits_are_those_of_floats_within_half_a_step(self):
        self.pictures("a", range(3))
        text = (MODELS / "efficientnet_lite0.toml").read_text()
        text = text.replace('model = "', f'model = "{MODELS}/', 1)
        text = text.replace("centre = true", 'centre = true\nstorage = "int8"', 1)
        (self.folder / "int8.toml").write_text(text)
        self.vdna("build", "floats", "a")
        self.vdna("build", "map", "a", "--backbone", "./int8.toml")
        told = self.vdna_json("info", "map")["experiences"][0]
        self.assertEqual((told["storage"], told["dim"], told["last_layer_dim"]),
                         ("int8", 1008, 1280))
        floats, codes = (Experience(self.folder / name / "a.vdna") for name in ("floats", "map"))
        self.assertNotIn("embeddings", codes.tensors)
        self.assertEqual(codes.metadata["comparable"], floats.metadata["comparable"])
        for i, value in enumerate(floats.tensors["embeddings"]):
            scale = codes.tensors["frame_embedding_scale"][i // 1008]
            self.assertLessEqual(abs(codes.tensors["frame_embedding"][i] * scale - value),
                                 0.5001 * scale)
        # Live frames of either manifest find themselves in either map.
        for folder in ("floats", "map"):
            for backbone in ("efficientnet_lite0", "./int8.toml"):
                matches = self.vdna_json("localise", "a", folder, "--backbone", backbone,
                                         "--matches")["candidates"][0]["matches"]
                self.assertEqual([match["frame"] for match in matches], [0, 1, 2])

    def with_dims(self, dims, more=""):
        """A manifest of the default network whose maps keep so many numbers; returns its path."""
        text = (MODELS / "efficientnet_lite0.toml").read_text()
        text = text.replace('model = "', f'model = "{MODELS}/', 1)
        text = text.replace("grid = 3", f"grid = 3\ndims = {dims}\n{more}\n", 1)
        (self.folder / f"dims{dims}.toml").write_text(text)
        return f"./dims{dims}.toml"

    def test_a_map_of_fewer_numbers_localises_as_well(self):
        for i, condition in enumerate(("spring", "overcast", "autumn", "summer")):
            self.vdna("simulate", condition, "--condition", condition, "--frames", 80, "--step", 2,
                      "--drive", i)
        few = self.with_dims(64)
        self.vdna("build", "few", "spring", "overcast", "--backbone", few)
        self.vdna("build", "few", "autumn")  # by the network's own manifest
        self.vdna("build", "few", "summer", "--name", "again", "--backbone", few)
        self.vdna("build", "all", "spring", "overcast", "autumn", "summer")
        for told in self.vdna_json("info", "few")["experiences"]:
            self.assertEqual((told["dim"], told["raw_dim"], told["last_layer_dim"]),
                             (64, 1008, 1280))
        for told in self.vdna_json("info", "all")["experiences"]:
            self.assertEqual((told["dim"], told["raw_dim"]), (1008, 1008))

        first, later = (Experience(self.folder / f"few/{name}.vdna") for name in
                        ("spring", "autumn"))
        self.assertEqual(first.metadata["format_version"], "4")
        self.assertEqual(first.tensors["projection"], later.tensors["projection"])
        self.assertEqual(first.metadata["comparable"], later.metadata["comparable"])
        whole = Experience(self.folder / "all/autumn.vdna").tensors["embeddings"]
        for d in (0, 63):
            direction = first.tensors["projection"][1008 * d:1008 * (d + 1)]
            self.assertAlmostEqual(math.hypot(*direction), 1, places=6)
            self.assertGreater(max(direction), -min(direction))
            for frame in (0, 79):
                product = math.fsum(a * b for a, b in zip(
                    direction, whole[1008 * frame:1008 * (frame + 1)]))
                self.assertAlmostEqual(later.tensors["embeddings"][64 * frame + d], product,
                                       places=4)

        recall = {}
        for folder in ("few", "all"):
            for backbone in ("efficientnet_lite0", few):
                told = self.vdna_json("localise", "summer", folder, "--backbone", backbone,
                                      "--in", "spring", "--in", "overcast", "--in", "autumn")
                recall[folder, backbone] = [c["recall_percent"] for c in told["candidates"]]
        self.assertEqual(recall["few", few], recall["few", "efficientnet_lite0"])
        self.assertEqual(recall["all", few], recall["all", "efficientnet_lite0"])
        for of_few, of_all in zip(recall["few", few], recall["all", few]):
            self.assertGreaterEqual(of_few, of_all - 2.5)  # two of 80 frames
        ranked = [self.vdna_json("rank", "summer", folder, "--warmup", 40)["ranking"][0]["experience"]
                  for folder in ("few", "all")]
        self.assertEqual(ranked, ["again" if folder == "few" else "summer" for folder in
                                  ("few", "all")])

    def test_fewer_numbers_are_those_of_the_map_or_of_the_ranges_file(self):
        self.pictures("a", range(8))
        self.pictures("b", range(8, 16))
        few, fewer = self.with_dims(4), self.with_dims(3, 'storage = "int8"')
        sentence = self.refused("build", "map", "a", "--backbone", self.with_dims(8))
        self.assertIn("backbone efficientnet_lite0: 8 numbers of each embedding are to be kept "
                      "('dims'), but the 8 frames of 1 experience vary in 7 directions", sentence)
        self.assertFalse((self.folder / "map").exists())

        self.vdna("build", "map", "a", "--backbone", few)
        sentence = self.refused("build", "map", "b", "--backbone", fewer)
        self.assertIn("keeps 3 numbers of each embedding ('dims' of its manifest), a has 4; leave "
                      "'dims' out, or rebuild all experiences of the map with --force", sentence)

        # Another map with the ranges of the first has its projection, whose files compare.
        self.vdna("build", "same", "b", "--ranges", "map/a.vdna")
        self.vdna("rank", "same/b.vdna", "map/a.vdna")
        # One that learned its own does not, whatever the ranges.
        self.vdna("calibrate", "ranges.json", "a")
        self.vdna("build", "own", "b", "--ranges", "ranges.json", "--backbone", few)
        self.vdna("build", "other", "a", "--ranges", "ranges.json", "--backbone", few)
        self.assertIn("of the projection is ", self.refused("rank", "own/b.vdna", "other/a.vdna"))

        # Codes are of the numbers that are kept.
        self.vdna("build", "coded", "a", "--backbone", fewer)
        told = self.vdna_json("info", "coded")["experiences"][0]
        self.assertEqual((told["storage"], told["dim"], told["raw_dim"]), ("int8", 3, 1008))
        matches = self.vdna_json("localise", "a", "coded", "--matches")
        self.assertEqual(len(matches["candidates"][0]["matches"]), 8)

    def test_a_map_of_one_layer_is_refused_with_both_remedies_or_used_as_it_was_made(self):
        self.pictures("a", range(3))
        self.vdna("build", "map", "a", "--backbone", PAPERS)
        for command in ("localise", "rank"):
            sentence = self.refused(command, "a", "map", "--backbone", "efficientnet_lite0")
            self.assertIn("embedding is one whole output in one and feat_s16 grid=3x3", sentence)
            self.assertIn("vdna build --force --backbone efficientnet_lite0", sentence)
            self.assertIn('protocol = "paper"', sentence)
        told = self.vdna_json("localise", "a", "map", "--matches")  # by the map's own backbone
        self.assertEqual([match["frame"] for match in told["candidates"][0]["matches"]], [0, 1, 2])
        # Ranges are of the taps, which are the same.
        self.vdna("build", "new", "a", "--ranges", "map/a.vdna")
        self.assertIn("embedding is ", self.refused("build", "map", "a", "--name", "b",
                                                    "--backbone", "efficientnet_lite0"))

    def test_adding_with_another_backbone_names_the_field_and_the_remedy(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2))
        self.vdna("build", "map", "a")
        sentence = self.refused("build", "map", "b", "--backbone", "mobilenet_v2")
        self.assertIn("model_sha256", sentence)
        self.assertIn("--force", sentence)

    def test_labels_and_times_are_kept(self):
        self.pictures("a", range(3), "file,place,x,y,utime\n"
                      "000.ppm,7,1,2,100000\n001.ppm,8,3,4,200000\n002.ppm,-9,5,6,300000\n")
        self.vdna("build", "map", "a")
        tensors = Experience(self.folder / "map/a.vdna").tensors
        self.assertEqual(tensors["frame_place"], [7, 8, -9])
        self.assertEqual(tensors["frame_position"], [1, 2, 0, 3, 4, 0, 5, 6, 0])
        self.assertEqual(tensors["frame_utime"], [100000, 200000, 300000])

    def test_every_keeps_every_nth_frame(self):
        self.pictures("a", range(5))
        self.vdna("build", "map", "a", "--every", 2, "--rate", 2)
        tensors = Experience(self.folder / "map/a.vdna").tensors
        self.assertEqual(tensors["frame_utime"], [0, 1000000, 2000000])

    def test_a_corrupt_picture_is_named_and_nothing_is_written(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2))
        (self.folder / "b/001.ppm").write_bytes(b"P6 no picture")
        self.assertIn("b/001.ppm", self.refused("build", "map", "a", "b"))
        self.assertFalse((self.folder / "map").exists())

    def test_corrupt_pictures_can_be_left_out_and_are_counted(self):
        self.pictures("a", range(3))
        (self.folder / "a/001.ppm").write_bytes(b"")
        report = self.vdna_json("build", "map", "a", "--skip-bad")["experiences"][0]
        self.assertEqual((report["frames"], report["bad_frames"]), (2, 1))
        self.assertEqual(report["expected_frames"], 3)
        self.assertIn("1 bad", self.vdna("build", "map", "a", "--skip-bad", "--force"))

    def test_a_source_without_one_good_picture_is_refused(self):
        self.pictures("a", range(1))
        (self.folder / "a/000.ppm").write_bytes(b"?")
        self.assertIn("none of its 1 frames", self.refused("build", "map", "a", "--skip-bad"))
        self.assertFalse((self.folder / "map").exists())

    def test_names_come_from_the_source_or_the_option(self):
        self.pictures("first drive", range(1))
        self.vdna("build", "map", "first drive/")
        self.vdna("build", "map", "first drive", "--name", "winter-1")
        self.assertEqual(self.map_files(),
                         ["first_drive.vdna", "trust.safetensors", "winter-1.vdna"])
        self.refused("build", "map", "first drive", "--name", "no/slash", code=2)
        self.refused("build", "map", "first drive", "--name", "n" * 64, code=2)

    def test_two_sources_cannot_become_one_experience(self):
        self.pictures("a", range(1))
        (self.folder / "x").mkdir()
        self.pictures("x/a", range(1))
        self.assertIn("--name", self.refused("build", "map", "a", "x/a", code=2))
        self.refused("build", "map", "a", "x/a", "--name", "b", code=2)

    def test_paths_that_are_no_sources_are_refused(self):
        (self.folder / "empty").mkdir()
        (self.folder / "text.txt").write_text("no video\n")
        self.assertIn("no pictures", self.refused("build", "map", "empty"))
        self.assertIn("not found", self.refused("build", "map", "nowhere"))
        self.assertIn("neither a folder", self.refused("build", "map", "text.txt"))
        self.assertIn("map", self.refused("build", "text.txt/map", self.pictures("a", [1])))

    def test_a_picture_without_a_label_is_built_and_counted(self):
        self.pictures("a", range(2), "file,place\n000.ppm,1\n")
        self.assertIn("2 frames, ", self.vdna("build", "map", "a"))
        self.assertIn(", 1 without ground truth", self.vdna("build", "map", "a", "--force"))

    def test_an_unknown_backbone_is_refused(self):
        self.pictures("a", range(1))
        self.assertIn("resnet9000",
                      self.refused("build", "map", "a", "--backbone", "resnet9000"))

    def test_an_obstacle_to_one_experience_leaves_the_map_unchanged(self):
        self.pictures("a", range(1))
        self.pictures("b", range(1))
        self.vdna("build", "map", "a")
        before = (self.folder / "map/a.vdna").read_bytes()
        (self.folder / "map/b.vdna").mkdir()
        sentence = self.refused("build", "map", "a", "b", "--force", "--bins", "50")
        self.assertIn("b.vdna: is a directory", sentence)
        self.assertIn("the map is unchanged", sentence)
        self.assertEqual((self.folder / "map/a.vdna").read_bytes(), before)
        self.assertEqual(self.map_files(), ["a.vdna", "b.vdna"])

    def test_a_map_that_cannot_be_made_leaves_no_directory(self):
        self.pictures("a", range(1))
        self.refused("build", "map", "a", "--backbone", "resnet9000")
        self.assertFalse((self.folder / "map").exists())

    def test_an_interrupt_leaves_the_map_unchanged(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        self.pictures("long", range(3))
        for i in range(3, 3000):
            os.link(self.folder / "long/000.ppm", self.folder / f"long/{i:04}.ppm")
        with subprocess.Popen([str(VDNA), "build", "map", "long"], cwd=self.folder,
                              stderr=subprocess.PIPE, text=True) as run:
            time.sleep(1)
            self.assertIsNone(run.poll(), "the build was over before the signal")
            run.send_signal(signal.SIGINT)
            sentence = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 130)
        self.assertRegex(sentence, r"\Avdna: .+\n\Z")
        self.assertEqual(self.map_files(), ["a.vdna"])


class Calibrate(Scratch):
    def test_its_ranges_are_those_that_build_would_find(self):
        self.pictures("a", range(3))
        self.vdna("calibrate", "ranges.json", "a")
        self.vdna("build", "map", "a", "--ranges", "ranges.json")
        self.vdna("build", "map2", "a")
        file, other = (Experience(self.folder / m / "a.vdna") for m in ("map", "map2"))
        self.assertEqual(file.tensors["range"], other.tensors["range"])
        ranges = json.loads((self.folder / "ranges.json").read_text())
        self.assertEqual([edge for pair in ranges["range"] for edge in pair],
                         file.tensors["range"])
        self.assertEqual((ranges["format"], ranges["version"], ranges["rule"]),
                         ("vdna-ranges", 1, "midpoint"))
        # What was observed is within the range that was made of it, and the range about its middle.
        for (low, high), (least, greatest) in zip(ranges["range"], ranges["observed"], strict=True):
            self.assertLess(low, least)
            self.assertLess(greatest, high)
            self.assertAlmostEqual(low + high, least + greatest, places=3)

    def test_ranges_of_other_pictures_saturate(self):
        self.pictures("a", [1, 1])
        self.pictures("b", range(10, 14))
        self.vdna("calibrate", "ranges.json", "a")
        report = self.vdna_json("build", "map", "b", "--ranges", "ranges.json")
        self.assertGreater(report["experiences"][0]["saturated_share"], 0)

    def test_ranges_of_an_experience_file_serve_too(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        self.vdna("build", "map2", "a", "--ranges", "map/a.vdna")
        self.vdna("rank", "map/a.vdna", "map2/a.vdna")

    def test_an_existing_file_is_replaced_only_with_force(self):
        self.pictures("a", range(2))
        (self.folder / "ranges.json").write_text("mine")
        self.assertIn("--force", self.refused("calibrate", "ranges.json", "a"))
        self.assertEqual((self.folder / "ranges.json").read_text(), "mine")
        self.vdna("calibrate", "ranges.json", "a", "--force")

    def test_ranges_of_another_backbone_are_refused(self):
        self.pictures("a", range(2))
        self.vdna("calibrate", "ranges.json", "a", "--backbone", "mobilenet_v2")
        sentence = self.refused("build", "map", "a", "--ranges", "ranges.json")
        self.assertIn("model_sha256", sentence)
        self.assertIn("mobilenet_v2", sentence)

    def test_files_that_hold_no_ranges_are_refused(self):
        self.pictures("a", range(2))
        self.vdna("calibrate", "good.json", "a")
        good = json.loads((self.folder / "good.json").read_text())
        for change in ({"version": 2}, {"range": good["range"][1:]}, {"range": [[1, "x"]]},
                       {"range": [[1, 1]] + good["range"][1:]}, {"format": None}):
            (self.folder / "bad.json").write_text(json.dumps({**good, **change}))
            self.assertIn("bad.json", self.refused("build", "map", "a", "--ranges", "bad.json"))
        for text in ("", "[]", "{", "\xff" * 3, "[" * 100000):
            (self.folder / "bad.json").write_text(text, encoding="latin-1")
            self.assertIn("bad.json", self.refused("build", "map", "a", "--ranges", "bad.json"))
        self.refused("build", "map", "a", "--ranges", "nowhere.json")
        self.assertFalse((self.folder / "map").exists())


class Info(Scratch):
    def test_it_tells_what_a_file_holds(self):
        self.pictures("a", range(3), "file,x,y\n000.ppm,1,2\n001.ppm,-3,4\n002.ppm,5,6\n")
        self.vdna("build", "map", "a")
        told = self.vdna_json("info", "map/a.vdna")["experiences"][0]
        file = Experience(self.folder / "map/a.vdna")
        self.assertEqual(told["labels"], {
            "position_frame": "local", "x": [-3, 5], "y": [2, 6], "z": [0, 0]})
        self.assertEqual(told["mass"], [3, 3])
        self.assertEqual(told["utime"], [0, 200000])
        self.assertEqual(told["bytes"], (self.folder / "map/a.vdna").stat().st_size)
        self.assertAlmostEqual(told["mean_grey"], sum(file.tensors["frame_grey"]) / 3, places=4)
        for key in ("backbone", "model_sha256", "preprocessing", "taps"):
            self.assertEqual(told[key], file.metadata[key])
        self.assertIn("frames: 3", self.vdna("info", "map/a.vdna"))
        self.assertIn("frames: 3", self.vdna("info", "--long", "map"))

    def test_a_map_is_a_table_with_a_line_for_each_experience(self):
        stamped = "file,utime,x,y\n" + "".join(f"{i:03}.ppm,{1714557600000000 + 60000000 * i},{3 * i},4\n" for i in range(3))
        self.pictures("a", range(3), stamped)
        self.pictures("b", range(2), "file,place\n000.ppm,1\n001.ppm,1\n")
        self.vdna("build", "map", "a")
        self.vdna("build", "map", "--no-thumbnails", "b")
        head, a, b, whole, trust = self.vdna("info", "map").splitlines()
        self.assertEqual(head.split()[0], "experience")
        self.assertRegex(a, r"^a +3 +2024-05-01 10:00:00 to 10:02:00 +6 m +all +[0-9.]+ MiB +a$")
        self.assertRegex(b, r"^b +2 +0.1 s, no date +1 places +none +[0-9.]+ MiB +b$")
        self.assertRegex(whole, "^map: .* neurons x .* bins")
        self.assertTrue(trust.startswith("map: "))
        told = self.vdna_json("info", "map")["experiences"]
        self.assertEqual([e["thumbnails"] for e in told], [3, 0])
        self.assertEqual([e["source"] for e in told], ["a", "b"])
        self.assertEqual([e["route_m"] for e in told], [6, None])
        self.assertEqual([e["dates"] for e in told],
                         [["2024-05-01T10:00:00.000Z", "2024-05-01T10:02:00.000Z"], None])
        self.assertEqual(told[1]["thumbnail_bytes"], 0)

    def test_thumbnails_change_nothing_that_compares_and_sources_hide_their_folders(self):
        self.pictures("a", range(3))
        self.vdna("build", "with", str(self.folder / "a"))
        self.vdna("build", "without", "a", "--no-thumbnails")
        pictured, plain = Experience(self.folder / "with/a.vdna"), Experience(self.folder / "without/a.vdna")
        self.assertEqual(pictured.metadata, plain.metadata)
        self.assertEqual(pictured.metadata["source"], "a")
        extra = {"thumbnails", "frame_thumbnail_end"}
        self.assertEqual(set(pictured.tensors) - set(plain.tensors), extra)
        for name in set(plain.tensors) - {"crc32c"}:
            self.assertEqual(list(pictured.tensors[name]), list(plain.tensors[name]), name)


class Show(Scratch):
    def test_it_writes_the_thumbnail_of_a_frame(self):
        self.pictures("a", range(3))
        self.vdna("build", "map", "a")
        self.assertIn("a-2.png", self.vdna("show", "map", "a", 2))
        self.assertEqual((self.folder / "a-2.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.vdna("show", "map/a.vdna", "a", 0, "-o", "x.png")
        self.assertNotEqual((self.folder / "x.png").read_bytes(), (self.folder / "a-2.png").read_bytes())

    def test_it_says_what_is_not_there_and_what_to_do(self):
        self.pictures("a", range(3))
        self.pictures("b", range(2))
        self.vdna("build", "map", "a")
        self.vdna("build", "map", "b", "--no-thumbnails")
        self.assertIn("expected one of: a, b", self.refused("show", "map", "c", 0))
        self.assertIn("expected 0 to 2", self.refused("show", "map", "a", 3))
        self.assertIn("without --no-thumbnails", self.refused("show", "map", "b", 0))
        self.assertEqual(self.run_vdna("show", "map", "a", -1).returncode, 2)
        self.assertEqual(self.run_vdna("show", "map", "a", 0, "--open", "-o", "-").returncode, 2)
        self.assertEqual([path.name for path in self.folder.glob("*.png")], [])

    def test_experiences_that_do_not_compare_are_reported(self):
        self.pictures("a", range(2))
        self.pictures("b", range(2))
        self.vdna("build", "map", "a")
        self.vdna("build", "map2", "b", "--bins", 10)
        os.rename(self.folder / "map2/b.vdna", self.folder / "map/b.vdna")
        done = self.run_vdna("info", "map", "--json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("bins", json.loads(done.stdout)["mismatches"][0])
        self.assertIn("map/b.vdna", done.stderr)
        self.assertIn("bins", self.refused("rank", "map/a.vdna", "map/b.vdna"))

    def test_a_corrupt_file_is_named(self):
        self.pictures("a", range(2))
        self.vdna("build", "map", "a")
        path = self.folder / "map/a.vdna"
        data = bytearray(path.read_bytes())
        data[len(data) // 2] ^= 1
        path.write_bytes(data)
        for arguments in (("info", "map"), ("rank", "a", "map"), ("localise", "a", "map")):
            self.assertIn("a.vdna", self.refused(*arguments))

    def test_an_empty_map_is_refused(self):
        self.pictures("a", range(2))
        (self.folder / "map").mkdir()
        for arguments in (("info", "map"), ("rank", "a", "map"), ("localise", "a", "map")):
            self.assertIn("vdna build", self.refused(*arguments))


class Rank(Scratch):
    def setUp(self):
        super().setUp()
        self.pictures("a", range(6))
        self.pictures("b", range(3, 9))
        self.pictures("c", range(20, 25))
        self.vdna("build", "map", "a", "b", "c", "--bins", 200)

    def test_distances_are_those_of_an_independent_computation(self):
        files = {name: Experience(self.folder / f"map/{name}.vdna") for name in "abc"}
        ranking = self.vdna_json("rank", "map/a.vdna", "map/b.vdna", "map/c.vdna")
        expected = {name: distance(files["a"], files[name]) for name in "bc"}
        for entry in ranking["ranking"]:
            self.assertAlmostEqual(entry["distance_bins"], expected[entry["experience"]],
                                   delta=1e-12 * expected[entry["experience"]])
        order = [entry["experience"] for entry in ranking["ranking"]]
        self.assertEqual(order, sorted(expected, key=expected.get))
        first, second = sorted(expected.values())
        self.assertAlmostEqual(ranking["margin_bins"], second - first, delta=1e-9)

    def test_live_frames_rank_as_their_experience_file_does(self):
        live = self.vdna_json("rank", "a", "map", "--warmup", 6)
        files = self.vdna_json("rank", "map/a.vdna", "map")
        expected = [entry.items() for entry in files["ranking"]]
        for entry, of_file in zip(live["ranking"], expected, strict=True):
            self.assertLessEqual(of_file, entry.items())
        self.assertEqual(files["ranking"][0], {"experience": "a", "distance_bins": 0,
                                               "tied": False})

    def test_the_warmup_is_the_first_frames_or_seconds(self):
        self.assertEqual(self.vdna_json("rank", "a", "map", "--warmup", 4)["frames"], 4)
        self.assertEqual(self.vdna_json("rank", "a", "map", "--warmup", "0.3s", "--warmup-min",
                                        1)["frames"], 3)
        self.assertEqual(self.vdna_json("rank", "a", "map", "--warmup", "0.3s", "--warmup-min",
                                        5)["frames"], 5)
        self.assertIn("6 frames", self.refused("rank", "a", "map"))
        self.assertIn("--warmup", self.refused("rank", "a", "map", "--warmup", "0.6s"))
        for bad in ("0", "-1", "4x", "s", "", "nans", "-1s"):
            self.refused("rank", "a", "map", f"--warmup={bad}", code=2)

    def test_equal_experiences_are_tied_in_the_order_of_the_map(self):
        self.vdna("build", "map", "a", "--name", "a2")
        ranking = self.vdna_json("rank", "a", "map", "--warmup", 6)["ranking"]
        self.assertEqual([(e["experience"], e["tied"]) for e in ranking[:3]],
                         [("a", True), ("a2", True), ("b", False)])
        self.assertIn("tied", self.vdna("rank", "a", "map", "--warmup", 6))

    def test_experiences_can_be_excluded(self):
        ranking = self.vdna_json("rank", "a", "map", "--warmup", 6, "--exclude", "a", "c")
        self.assertEqual([entry["experience"] for entry in ranking["ranking"]], ["b"])
        self.assertEqual(ranking["margin_bins"], 0)
        self.assertIn("a b c", self.refused("rank", "a", "map", "--exclude", "d"))
        self.refused("rank", "a", "map", "--exclude", "a", "b", "c")

    def test_the_distance_of_a_single_tap_is_the_distance(self):
        entry = self.vdna_json("rank", "a", "map", "--warmup", 4, "--per-tap")["ranking"][0]
        self.assertEqual(len(entry["taps"]), 1)
        self.assertAlmostEqual(entry["taps"][0]["distance_bins"], entry["distance_bins"],
                               places=9)

    def test_another_backbone_is_refused_by_field(self):
        for command in ("rank", "localise"):
            sentence = self.refused(command, "a", "map", "--backbone", "mobilenet_v2")
            self.assertIn("model_sha256", sentence)
            self.assertIn("rebuild", sentence)

    def test_paths_that_make_no_sense_are_refused(self):
        self.assertIn("nowhere", self.refused("rank", "a", "nowhere"))
        self.assertIn("nowhere", self.refused("rank", "nowhere", "map"))
        self.refused("rank", "map/a.vdna", code=2)
        self.refused("rank", "a", "map", "c", code=2)


class Localise(Scratch):
    def setUp(self):
        super().setUp()
        table = "file,place\n" + "".join(f"{name}/{i:03}.ppm,{10 * place}\n"
                                         for name, first in (("a", 0), ("b", 2), ("c", 20))
                                         for i, place in enumerate(range(first, first + 4)))
        (self.folder / "places.csv").write_text(table)
        self.pictures("a", range(4))
        self.pictures("b", range(2, 6))
        self.pictures("c", range(20, 24))
        self.vdna("build", "map", "b", "c", "--labels", "places.csv")

    def localise(self, *arguments):
        """Each frame by itself: the drives are too short for a filter."""
        return self.vdna_json("localise", "a", "map", "--labels", "places.csv",
                              "--localiser", "nearest", *arguments)

    def test_recall_is_the_share_of_frames_found_within_tolerance(self):
        answer = self.localise("--matches")
        b, c = answer["candidates"]
        # Frames 2 and 3 of a are frames 0 and 1 of b; the others were never seen by b or c.
        self.assertEqual((b["experience"], b["unreachable"]), ("b", 2))
        self.assertEqual((b["matches"][2]["frame"], b["matches"][2]["good"]), (0, True))
        self.assertEqual(b["good"], sum(match["good"] for match in b["matches"]))
        self.assertEqual(b["recall_percent"], 25 * b["good"])
        self.assertEqual(b["nearest_recall_percent"], b["recall_percent"])
        self.assertIsNone(b["unsure_percent"])
        self.assertEqual((c["good"], c["unreachable"]), (0, 4))
        self.assertEqual(answer["all"]["unreachable"], 2)

    def test_the_tolerance_is_in_places(self):
        self.assertEqual(self.localise("--tolerance", 0)["candidates"][0]["unreachable"], 2)
        self.assertEqual(self.localise("--tolerance", 20)["candidates"][0]["unreachable"], 0)

    def test_matches_name_their_frames(self):
        matches = self.localise("--matches")["candidates"][0]["matches"]
        self.assertEqual([m["live_frame"] for m in matches], [0, 1, 2, 3])
        self.assertEqual(matches[3]["utime"], 300000)
        for match in matches:
            self.assertEqual((match["frame"], match["good"]),
                             (match["nearest_frame"], match["nearest_good"]))
            self.assertEqual((match["confidence"], match["moving"]), (None, None))

    def rows(self, path):
        file = Experience(self.folder / path)
        numbers = file.tensors["embeddings"]
        return [numbers[file.dim * i:file.dim * (i + 1)] for i in range(file.frames)]

    def assert_nearest(self, matches, distances, delta):
        for match, row in zip(matches, distances):
            self.assertEqual(match["nearest_frame"], row.index(min(row)))
            self.assertAlmostEqual(match["distance"], min(row), delta=delta)

    def test_the_nearest_frame_about_the_means_is_that_of_an_independent_search(self):
        self.vdna("build", "live", "a", "--labels", "places.csv")
        live, rows = self.rows("live/a.vdna"), self.rows("map/b.vdna")
        map_mean = [sum(column) / len(rows) for column in zip(*rows)]
        mean, weight, distances = map_mean, 3, []

        def direction(row, about):
            apart = [x - y for x, y in zip(row, about)]
            return [x / math.hypot(*apart) for x in apart]
        for x in live:
            weight += 1
            mean = [m + (y - m) / weight for y, m in zip(x, mean)]
            seen = direction(x, mean)
            distances.append([1 - sum(p * q for p, q in zip(direction(row, map_mean), seen))
                              for row in rows])
        self.assert_nearest(self.localise("--matches")["candidates"][0]["matches"], distances, 1e-3)
        # With a warmup the mean is the same, and what follows it as well.
        self.assert_nearest(self.localise("--matches", "--skip", 2)["candidates"][0]["matches"],
                            distances[2:], 1e-3)

    def test_the_nearest_frame_of_one_layer_is_that_of_least_euclidean_distance(self):
        for directory, name in (("live", "a"), ("paper", "b")):
            self.vdna("build", directory, name, "--labels", "places.csv", "--backbone", PAPERS)
        live, rows = self.rows("live/a.vdna"), self.rows("paper/b.vdna")
        found = self.vdna_json("localise", "a", "paper", "--matches")
        self.assert_nearest(found["candidates"][0]["matches"],
                            [[math.dist(x, row) for row in rows] for x in live], 1e-4)

    def test_the_warmup_can_be_skipped(self):
        answer = self.localise("--skip", 2, "--matches")
        self.assertEqual((answer["frames"], answer["warmup_frames"]), (2, 2))
        self.assertEqual([m["live_frame"] for m in answer["all"]["matches"]], [2, 3])
        self.assertIn("a: has 4 frames, expected more than the 4 of the warmup; set --skip",
                      self.refused("localise", "a", "map", "--skip", 4))

    def test_experiences_can_be_named(self):
        self.assertEqual([c["experience"] for c in self.localise("--in", "c")["candidates"]],
                         ["c"])
        self.assertIn("b c", self.refused("localise", "a", "map", "--in", "d"))

    def test_without_labels_there_are_matches_but_no_recall(self):
        answer = self.vdna_json("localise", "a", "map", "--matches")
        self.assertIsNone(answer["candidates"][0]["recall_percent"])
        self.assertEqual(answer["candidates"][0]["matches"][2]["frame"], 0)
        self.assertIn("not labelled alike", self.vdna("localise", "a", "map"))

    def test_the_difference_matrices_are_drawn(self):
        self.vdna("localise", "a", "map", "--labels", "places.csv", "--matrix", "m.png")
        data = (self.folder / "m.png").read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", data[16:24])
        self.assertGreater(width, 2 * 600)  # two panels of four cells
        self.assertGreater(height, 600)
        self.assertIn("nowhere", self.refused("localise", "a", "map", "--matrix",
                                              "nowhere/m.png"))
        self.assertIn("m.gif: ends in '.gif', expected .png, .svg or .pdf",
                      self.refused("localise", "a", "map", "--matrix", "m.gif"))
        self.vdna("localise", "a", "map", "--labels", "places.csv", "--matrix", "m.pdf")
        self.assertEqual((self.folder / "m.pdf").read_bytes()[:5], b"%PDF-")

    def test_a_difference_matrix_shows_grey_matches_where_nothing_is_labelled(self):
        grey = "not known whether right"
        self.vdna("localise", "a", "map", "--matrix", "grey.svg")
        self.vdna("localise", "a", "map", "--labels", "places.csv", "--matrix", "known.svg")
        texts = {name: [e.text for e in ElementTree.parse(self.folder / name).iter()
                        if e.tag.endswith("}text")] for name in ("grey.svg", "known.svg")}
        self.assertIn("filter's answer, " + grey, texts["grey.svg"])
        self.assertNotIn("filter's answer, right", texts["grey.svg"])
        self.assertIn("filter's answer, right", texts["known.svg"])
        self.assertNotIn("filter's answer, " + grey, texts["known.svg"])
        for shown in texts.values():
            self.assertEqual(shown.count("live frame"), 2)
            self.assertEqual([text[0] for text in shown if text.endswith(("  b", "  c"))],
                             ["1", "2"])

    def test_missing_labels_are_refused(self):
        self.assertIn("nowhere.csv",
                      self.refused("localise", "a", "map", "--labels", "nowhere.csv"))
        (self.folder / "places.csv").write_text("file,place\nd/000.png,1\n")
        self.assertIn("'d/000.png'",
                      self.refused("localise", "a", "map", "--labels", "places.csv"))


class CommandLine(Scratch):
    def test_without_a_sub_command_it_prints_help(self):
        self.assertIn("build", self.vdna())
        self.assertIn("130", self.vdna("--help"))

    def test_it_tells_its_version(self):
        self.assertRegex(self.vdna("--version"), r"\Avdna \d+\.\d+\.\d+\n\Z")

    def test_wrong_usage_has_its_own_exit_code(self):
        for arguments in (("nonsense",), ("build",), ("build", "map"), ("info",),
                          ("build", "map", "a", "--bins", 1), ("build", "map", "a", "--rate", 0),
                          ("build", "map", "a", "--every", 0), ("info", "map", "--nonsense"),
                          ("localise", "a", "map", "--tolerance", -1),
                          ("localise", "a", "map", "--localiser", "gps"),
                          ("localise", "a", "map", "--min-confidence", 1.1)):
            self.refused(*arguments, code=2)

    def test_numbers_are_finite_and_decimal(self):
        for text in ("nan", "inf", "-inf", "1e999", "0x1p3", "0x10", "1,5", "", "1 ", "five"):
            for arguments in (("build", "map", "a", "--rate"), ("build", "map", "a", "--late"),
                              ("build", "map", "a", "--gps-gap"),
                              ("build", "map", "a", "--time-offset"),
                              ("localise", "a", "map", "--tolerance"),
                              ("localise", "a", "map", "--min-confidence"),
                              ("eval", "a", "--rate"), ("eval", "a", "--tolerance"),
                              ("simulate", "a", "--step"), ("simulate", "a", "--variation"),
                              ("play", "a", "--rate"), ("camera", "a", "--rate"),
                              ("watch", "--for"), ("rank", "a", "map", "--rate")):
                said = self.refused(*arguments, text, code=2)
                self.assertIn(text, said)

    def test_a_full_disk_under_the_report_is_an_error(self):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([str(VDNA), "--help"], stdout=full, stderr=subprocess.PIPE,
                                  text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("standard output", done.stderr)


if __name__ == "__main__":
    sys.exit(not unittest.main(exit=False).result.wasSuccessful())
