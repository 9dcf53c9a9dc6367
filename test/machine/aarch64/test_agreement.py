"""vdna and vdna_selectord for 64-bit ARM, with the default network under emulation, agree with
those of this machine on a few pictures.

A network rounds differently on another processor, so embeddings and distances agree within bounds,
at least ten times the differences found; the network's input, and all results computed from the
same experience files, agree to the last bit.

Environment: VDNA_BIN (scripts that run the programs under emulation), VDNA_NATIVE_BIN (programs of
this machine), VDNA_EMULATED (command line of vdna under emulation), VDNA_TEST_MODELS (folder of the
networks). Works in the current directory.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import struct
import subprocess
import sys
import unittest

import own_network
from selectord import PATIENCE, Camera, Selectord, Watch, jpegs_in, vdna

NATIVE = pathlib.Path(os.environ["VDNA_NATIVE_BIN"]) / "vdna"
EMULATED = shlex.split(os.environ["VDNA_EMULATED"])
MODELS = pathlib.Path(os.environ["VDNA_TEST_MODELS"])
NAME = "efficientnet_lite0"
WORK = pathlib.Path("agreement").absolute()
LIVE, NATIVE_MAP, ARM_MAP = WORK / "live", WORK / "native_map", WORK / "arm_map"
CONDITIONS = ["summer", "winter", "night"]
FRAMES, WARMUP = 3, 2

# Relative to the length of the embedding, and to the distance of experiences and of frames.
EMBEDDING_BOUND, DISTANCE_BOUND, MATCH_BOUND = 1e-5, 1e-4, 1e-5


def native(*arguments):
    """Run the `vdna` of this machine: its standard output."""
    done = subprocess.run([NATIVE, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"vdna {' '.join(map(str, arguments))}: exit {done.returncode}: "
                             f"{done.stderr}")
    return done.stdout


def emulated(*arguments):
    return vdna(*arguments).stdout


def prepare():
    """A live drive of ARM's making and pictures of this machine's, and a map of those by each."""
    if not NATIVE.exists():
        print(f"skipped: there is no {NATIVE} to compare with; ./dev build makes it")
        sys.exit(77)
    shutil.rmtree(WORK, ignore_errors=True)
    drives = [WORK / condition for condition in CONDITIONS]
    for drive, condition in zip(drives, CONDITIONS):
        native("simulate", drive, "--condition", condition, "--frames", FRAMES)
    native("build", NATIVE_MAP, *drives)
    emulated("build", ARM_MAP, *drives)
    emulated("simulate", LIVE, "--condition", "winter", "--frames", FRAMES, "--drive", 7,
             "--variation", 0.5)


def embeddings(path):
    """Rows of the tensor `embeddings` of an experience file."""
    data = path.read_bytes()
    size, = struct.unpack_from("<Q", data)
    tensor = json.loads(data[8:8 + size])["embeddings"]
    begin, end = tensor["data_offsets"]
    rows, dim = tensor["shape"]
    values = struct.unpack(f"<{rows * dim}f", data[8 + size + begin:8 + size + end])
    return [values[dim * row:dim * (row + 1)] for row in range(rows)]


def length(vector):
    return sum(x * x for x in vector) ** 0.5


class Programs(unittest.TestCase):
    def assert_same_ranking(self, expected, found):
        self.assertEqual(len(expected), len(CONDITIONS))
        self.assertEqual([entry["experience"] for entry in found],
                         [entry["experience"] for entry in expected])
        apart = [abs(b["distance_bins"] / a["distance_bins"] - 1)
                 for a, b in zip(expected, found)]
        print(f"distances: at most {max(apart):.1e} apart")
        self.assertLess(max(apart), DISTANCE_BOUND)

    def test_give_a_network_the_same_numbers(self):
        for number, run in enumerate((native, emulated)):
            run("model", "inputs", NAME, LIVE, "--npy", WORK / f"inputs{number}.npy")
        inputs = [(WORK / f"inputs{number}.npy").read_bytes() for number in range(2)]
        self.assertGreater(len(inputs[0]), FRAMES * 3 * 224 * 224 * 4)
        self.assertTrue(inputs[0] == inputs[1], "the pictures differ as the network is given them")

    def test_compute_nearly_the_same_embeddings(self):
        furthest = 0
        for condition in CONDITIONS:
            ours = embeddings(NATIVE_MAP / f"{condition}.vdna")
            arms = embeddings(ARM_MAP / f"{condition}.vdna")
            self.assertEqual(len(ours), FRAMES)
            for a, b in zip(ours, arms, strict=True):
                apart = length([x - y for x, y in zip(a, b, strict=True)]) / length(a)
                furthest = max(furthest, apart)
        print(f"embeddings: at most {furthest:.1e} apart")
        self.assertLess(furthest, EMBEDDING_BOUND)

    def test_read_the_experience_files_of_the_other(self):
        for folder in (NATIVE_MAP, ARM_MAP):
            infos = [json.loads(run("info", folder, "--json")) for run in (native, emulated)]
            self.assertEqual(len(infos[0]["experiences"]), len(CONDITIONS))
            self.assertEqual(*infos)

    def test_rank_experience_files_to_the_last_bit(self):
        for folder in (NATIVE_MAP, ARM_MAP):
            rankings = [json.loads(run("rank", folder / "night.vdna", folder / "summer.vdna",
                                       folder / "winter.vdna", "--json"))["ranking"]
                        for run in (native, emulated)]
            self.assertEqual(len(rankings[0]), 2)
            self.assertEqual(*rankings)

    def test_rank_pictures_in_the_same_order(self):
        rankings = [json.loads(run("rank", LIVE, folder, "--warmup", FRAMES, "--json"))["ranking"]
                    for run, folder in ((native, NATIVE_MAP), (emulated, NATIVE_MAP),
                                        (native, ARM_MAP))]
        for other in rankings[1:]:
            self.assert_same_ranking(rankings[0], other)

    def test_answer_cameras_as_rank_and_localise_do_here(self):
        pictures = jpegs_in(LIVE)
        # An emulated process can neither execute itself nor confine itself.
        settings = WORK / "selectord.toml"
        settings.write_text("[backbone]\nprocess = false\n", encoding="ascii")
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", NATIVE_MAP, "--warmup-frames", WARMUP, "-c", settings):
            answers = []
            for utime, picture in enumerate(pictures):
                camera.send_jpeg(utime, picture)
                answers.append(watch.wait_for("localisation"))
            ranking, = watch.of("ranking")
        self.assertEqual([a["utime"] for a in answers], list(range(FRAMES)))
        self.assertEqual([a["validity"] for a in answers],
                         ["WARMING_UP"] * WARMUP + ["VALID"] * (FRAMES - WARMUP))
        expected = json.loads(native("rank", LIVE, NATIVE_MAP, "--warmup", WARMUP, "--json"))
        self.assert_same_ranking(expected["ranking"], ranking["ranking"])

        located = json.loads(native("localise", LIVE, NATIVE_MAP, "--in", answers[-1]["experience"],
                                    "--skip", WARMUP, "--matches", "--json"))
        match, = located["candidates"][0]["matches"]
        self.assertEqual([answers[-1][field] for field in ("experience", "frame")],
                         [match[field] for field in ("experience", "frame")])
        apart = abs(answers[-1]["distance"] / match["distance"] - 1)
        print(f"distance to the nearest frame: {apart:.1e} apart")
        self.assertLess(apart, MATCH_BOUND)


class Processor(unittest.TestCase):
    """A manifest that says int8 suffices: the processor is checked before the network."""

    def inputs_of_int8(self, processor):
        manifest = WORK / "stand_in.toml"
        text = (MODELS / f"{NAME}.toml").read_text()
        text = re.sub(r'^model = "', rf'model = "{MODELS}/', text, flags=re.M)
        manifest.write_text(text.replace("\n[", '\nprecision = "int8"\n[', 1))
        command = [*EMULATED[:-1], "-cpu", processor, EMULATED[-1]]
        return subprocess.run([*command, "model", "inputs", manifest, LIVE, "--npy",
                               WORK / "int8.npy"], capture_output=True, text=True,
                              timeout=PATIENCE)

    def test_without_dot_products_is_refused_an_int8_network(self):
        done = self.inputs_of_int8("cortex-a72")
        self.assertEqual(done.returncode, 1)
        self.assertIn("this processor lacks asimddp", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_with_dot_products_is_not(self):
        done = self.inputs_of_int8("cortex-a76")
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
