"""Precisions of a network: they never mix, `vdna model check` compares them, models/quantise.py
makes them.

Three more bytes of documentation in its ONNX file make a network another model with the same
results; with "int8" in its manifest it stands in for an int8 network. Real int8 networks are made
if the quantiser's Python packages can be installed; otherwise those tests are skipped.
"""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import numpy as np

from selectord import SANITIZED

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "models"))
from quantise import manifest_text  # noqa: E402
BIN = Path(os.environ["VDNA_BIN"])
MODELS = Path(os.environ["VDNA_TEST_MODELS"])
NAME = "efficientnet_lite0"
CONDITIONS = ["summer", "winter", "night"]
FRAMES = 15
EMBEDDING_CHANGE_MAX = 10  # percent, median
WORK = tempfile.TemporaryDirectory(prefix="vdna-model-")
FOLDER = Path(WORK.name)
RUNS, MAP, CACHE = FOLDER / "runs", FOLDER / "map", FOLDER / "cache"


def run(program, *arguments):
    return subprocess.run([str(program), *map(str, arguments)], text=True, capture_output=True)


def vdna(*arguments):
    done = run(BIN / "vdna", *arguments)
    if done.returncode != 0:
        raise AssertionError(f"vdna {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def check(first, second, pictures=RUNS):
    return json.loads(vdna("model", "check", first, second, pictures, "--cache", CACHE, "--json"))


def evaluation(network):
    """The result of `vdna eval`, and the embeddings of all frames."""
    folder = FOLDER / f"npy_{Path(network).stem}"
    vdna("eval", RUNS, "--backbone", network, "--cache", CACHE, "--npy", folder,
         "--json", folder.with_suffix(".json"))
    embeddings = [np.load(folder / f"embeddings_{name}.npy") for name in CONDITIONS]
    return (json.loads(folder.with_suffix(".json").read_text()),
            np.concatenate(embeddings).astype(np.float64))


def stand_in(name="stand_in", precision="int8", more=""):
    """The default network as another model, with this precision in its manifest."""
    data = (MODELS / f"{NAME}.onnx").read_bytes() + b"\x32\x01" + precision[:1].encode()
    model, manifest = FOLDER / f"{name}.onnx", FOLDER / f"{name}.toml"
    model.write_bytes(data)
    text = (MODELS / f"{NAME}.toml").read_text()
    for key, value in (("name", name), ("model", model.name),
                       ("sha256", hashlib.sha256(data).hexdigest())):
        text = re.sub(rf"^{key} =.*$", f'{key} = "{value}"', text, count=1, flags=re.M)
    manifest.write_text(text.replace("\n[", f'\nprecision = "{precision}"\n{more}\n[', 1))
    return manifest


def setUpModule():
    os.environ["VDNA_MODELS"] = str(MODELS)
    for condition in CONDITIONS:
        vdna("simulate", RUNS / condition, "--condition", condition, "--frames", FRAMES)
    vdna("build", MAP, *(RUNS / condition for condition in CONDITIONS[:2]))


class OtherPrecision(unittest.TestCase):
    """A map made with fp32 and a network that calls itself int8."""

    def setUp(self):
        self.int8 = stand_in()
        tried = run(BIN / "vdna", "model", "inputs", self.int8, RUNS / "night", "--npy",
                    FOLDER / "tried.npy")
        if "this processor lacks" in tried.stderr:
            self.skipTest(tried.stderr)

    def refused(self, program, *arguments, precisions=("fp32", "int8")):
        done = run(program, *arguments)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout, "")
        for precision in precisions:
            self.assertIn(precision, done.stderr)
        self.assertIn("precision", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_is_refused_by_every_command_that_would_compare_them(self):
        night = RUNS / "night"
        self.refused(BIN / "vdna", "rank", night, MAP, "--backbone", self.int8)
        self.refused(BIN / "vdna", "localise", night, MAP, "--backbone", self.int8)
        self.refused(BIN / "vdna", "build", MAP, night, "--backbone", self.int8, "--ranges",
                     MAP / "summer.vdna")
        vdna("calibrate", FOLDER / "ranges.json", night)
        self.refused(BIN / "vdna", "build", FOLDER / "new", night, "--backbone", self.int8,
                     "--ranges", FOLDER / "ranges.json")

    def test_is_refused_by_the_daemon_before_it_is_ready(self):
        for options in ((), ("--check",)):
            self.refused(BIN / "vdna_selectord", "--map", MAP, "--backbone", self.int8, *options)

    def test_is_refused_where_files_of_both_are_compared(self):
        other = FOLDER / "other"
        vdna("build", other, RUNS / "night", "--backbone", self.int8)
        self.refused(BIN / "vdna", "rank", other / "night.vdna", MAP / "summer.vdna")
        mixed = FOLDER / "mixed"
        shutil.copytree(MAP, mixed)
        shutil.copy(other / "night.vdna", mixed)
        self.refused(BIN / "vdna", "rank", RUNS / "summer", mixed)
        self.refused(BIN / "vdna_selectord", "--map", mixed)
        [experience] = json.loads(vdna("info", "--json", other / "night.vdna"))["experiences"]
        self.assertEqual(experience["precision"], "int8")

    def test_takes_nothing_of_the_other_from_the_cache(self):
        first = evaluation(NAME)[0]
        found = evaluation(self.int8)[0]
        self.assertEqual((found["cached"], found["computed"]), (0, 3 * FRAMES))
        self.assertEqual((first["precision"], found["precision"]), ("fp32", "int8"))


class Taps(unittest.TestCase):
    def test_missing_from_the_model_are_reported_by_the_daemon_before_it_is_ready(self):
        manifest = stand_in("untapped", "fp32")
        manifest.write_text(manifest.read_text().replace('[[taps]]\noutput = "embedding"',
                                                         '[[taps]]\noutput = "block99"'))
        done = run(BIN / "vdna_selectord", "--map", MAP, "--backbone", manifest)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("untapped.onnx: has no output 'block99'; it has: embedding, feat_s16",
                      done.stderr)


def changed(name, passage, other):
    """The default network with this passage of its manifest replaced."""
    manifest = stand_in(name, "fp32")
    text = manifest.read_text()
    if text.count(passage) != 1:
        raise AssertionError(f"{passage} is {text.count(passage)} times in {text}")
    manifest.write_text(text.replace(passage, other))
    return manifest


class Golden(unittest.TestCase):
    """Mistakes that hardly change a ranking."""

    def test_numbers_of_the_shipped_networks_are_what_the_command_prints(self):
        for name in (NAME, "mobilenet_v2"):
            text = (MODELS / f"{name}.toml").read_text()
            known = tomllib.loads(text)["golden"]
            found = tomllib.loads(vdna("model", "golden", name))["golden"]
            self.assertEqual(known["tolerance"], found["tolerance"])
            for key in ("taps", "embedding", "last_layer"):
                known_list, found_list = (np.ravel(section[key]) for section in (known, found))
                apart = np.abs(known_list - found_list).max() / np.abs(known_list).max()
                self.assertLess(apart, known["tolerance"] / 10)

    def test_mistakes_before_the_network_end_the_daemon_before_it_is_ready(self):
        for name, passage, other in (
                ("swapped", 'colour = "RGB"', 'colour = "BGR"'),
                ("narrow", "std = [128.0, 128.0, 128.0]", "std = [127.0, 127.0, 127.0]"),
                ("shifted", "mean = [127.0, 127.0, 127.0]", "mean = [128.0, 128.0, 128.0]"),
                ("resized", 'interpolation = "area"', 'interpolation = "linear"')):
            manifest = changed(name, passage, other)
            for options in ((), ("--check",)):
                done = run(BIN / "vdna_selectord", "--map", MAP, "--backbone", manifest, *options)
                self.assertEqual((done.returncode, done.stdout), (1, ""))
                self.assertRegex(done.stderr, f"{manifest}: for the test picture tap 'embedding' "
                                 r"gives [-0-9.e]+ as number \d of 8, \[golden\] expects [-0-9.e]+ "
                                 r"within [-0-9.e]+; correct \[input\] or the model, or, .*`vdna "
                                 "model golden`")
                self.assertEqual(done.stderr.count("\n"), 1)

    def test_a_wrong_number_of_the_embedding_is_told(self):
        manifest = changed("off", "embedding = [", "embedding = [9, ")
        done = run(BIN / "vdna", "build", FOLDER / "never", RUNS / "night", "--backbone", manifest)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"the embedding gives \S+ as number 1 of 9, .* expects 9 within")

    def test_numbers_of_the_original_are_not_those_of_int8(self):
        text = (MODELS / f"{NAME}.toml").read_text()
        original = tomllib.loads(text)
        made = tomllib.loads(manifest_text(text + "[more]\n", "made", b"", original, "by hand"))
        self.assertEqual(made.keys() ^ original.keys(),
                         {"golden", "more", "precision", "quantised"})

    def test_a_network_without_them_runs_and_prints_its_own(self):
        manifest = changed("unknown", 'colour = "RGB"', 'colour = "BGR"')
        before = manifest.read_text().partition("[golden]")[0]
        manifest.write_text(before)
        manifest.write_text(before + vdna("model", "golden", manifest))
        vdna("model", "golden", manifest)  # and is opened with them


class Check(unittest.TestCase):
    def test_the_same_network_changes_nothing(self):
        found = check(NAME, stand_in("twin", "fp32"))
        self.assertEqual(found["pictures"], 3 * FRAMES)
        self.assertEqual(found["embedding_l2_percent"], {"median": 0, "max": 0})
        self.assertEqual(found["emd_change_percent"], {"median": 0, "max": 0})
        self.assertEqual([query["swaps"] for query in found["queries"]], [0, 0, 0])
        self.assertEqual(*found["recall_percent"])

    def test_a_folder_of_pictures_compares_embeddings_only(self):
        found = check(NAME, stand_in("twin", "fp32"), RUNS / "night")
        self.assertEqual(found["pictures"], FRAMES)
        self.assertNotIn("queries", found)
        self.assertGreater(found["inference_ratio"], 0)

    def test_other_networks_are_refused(self):
        stale = stand_in("stale", "fp32", '[quantised]\nmethod = "by hand"\nfrom_sha256 = "' +
                         64 * "0" + '"\n')
        for other, field in (("mobilenet_v2", "preprocessing"), (stale, "original")):
            done = run(BIN / "vdna", "model", "check", NAME, other, RUNS)
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"{field} is", done.stderr)


class Inputs(unittest.TestCase):
    def test_are_the_pictures_normalised(self):
        folder = FOLDER / "noise"
        folder.mkdir()
        pixels = np.random.RandomState(1).randint(0, 256, (2, 224, 224, 3)).astype(np.uint8)
        for number, picture in enumerate(pixels):
            (folder / f"{number}.ppm").write_bytes(b"P6\n224 224\n255\n" + picture.tobytes())
        vdna("model", "inputs", NAME, folder, "--npy", FOLDER / "inputs.npy")
        expected = ((pixels.astype(np.float64) - 127) / 128).astype(np.float32)
        np.testing.assert_array_equal(np.load(FOLDER / "inputs.npy"),
                                      expected.transpose(0, 3, 1, 2))


class Processor(unittest.TestCase):
    @unittest.skipIf(SANITIZED, "QEMU has no room for a sanitizer's shadow memory")
    def test_without_vnni_an_int8_network_is_refused(self):
        if not shutil.which("qemu-x86_64") or os.uname().machine != "x86_64":
            self.skipTest("no qemu-x86_64 to be a processor without VNNI")
        done = run("qemu-x86_64", "-cpu", "Haswell", BIN / "vdna", "model", "inputs", stand_in(),
                   RUNS / "night", "--npy", FOLDER / "none.npy")
        self.assertEqual(done.returncode, 1)
        self.assertIn("lacks AVX-512 VNNI and AVX-VNNI", done.stderr)


def quantised(manifest, name, *options):
    """The manifest of the int8 network that models/quantise.py makes, or a skipped test."""
    out = FOLDER / f"{name}.toml"
    done = run(sys.executable, ROOT / "models" / "quantise.py", manifest, "-o", out,
               "--vdna", BIN / "vdna", *options)
    if "pip cannot install" in done.stderr or "ensurepip" in done.stderr + done.stdout:
        raise unittest.SkipTest(done.stderr.strip())
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return out


class Quantised(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.int8 = quantised(MODELS / f"{NAME}.toml", "made_int8", "--pictures", RUNS / "summer",
                             RUNS / "winter", "--every", 2)

    def setUp(self):
        tried = run(BIN / "vdna", "model", "inputs", self.int8, RUNS / "night", "--npy",
                    FOLDER / "tried.npy")
        if "this processor lacks" in tried.stderr:
            self.skipTest(tried.stderr)

    def test_check_tells_what_two_evaluations_tell(self):
        found = check(NAME, self.int8)
        (a, of_a), (b, of_b) = evaluation(NAME), evaluation(self.int8)
        apart = np.linalg.norm(of_a - of_b, axis=1) / np.linalg.norm(of_a, axis=1)
        cosine = 1 - (of_a * of_b).sum(axis=1) / np.sqrt((of_a ** 2).sum(axis=1)
                                                         * (of_b ** 2).sum(axis=1))
        for key, values in (("embedding_l2_percent", 100 * apart),
                            ("embedding_cosine_distance", cosine)):
            self.assertAlmostEqual(found[key]["median"], np.median(values), 9)
            self.assertAlmostEqual(found[key]["max"], values.max(), 9)
        emd = [100 * abs(b["distance"]["vdna"][q][r] / row[r] - 1)
               for q, row in a["distance"]["vdna"].items() for r in row]
        self.assertAlmostEqual(found["emd_change_percent"]["median"], np.median(emd), 9)
        for query in found["queries"]:
            rows = [e["distance"]["vdna"][query["query"]] for e in (a, b)]
            firsts = [min(row, key=row.get) for row in rows]
            self.assertEqual(query["first"], firsts)
            self.assertEqual(query["recall_of_first_percent"],
                             [e["recall"][query["query"]][f] for e, f in zip((a, b), firsts)])
            [x, y] = rows[0]
            swapped = (rows[0][x] < rows[0][y]) != (rows[1][x] < rows[1][y])
            self.assertEqual(query["swaps"], int(swapped))

    def test_is_int8_and_close_to_the_original(self):
        found = check(NAME, self.int8)
        self.assertEqual([network["precision"] for network in found["networks"]],
                         ["fp32", "int8"])
        self.assertLess((FOLDER / "made_int8.onnx").stat().st_size,
                        0.4 * (MODELS / f"{NAME}.onnx").stat().st_size)
        self.assertNotIn("golden", tomllib.loads(self.int8.read_text()))
        self.assertLess(found["embedding_l2_percent"]["median"], EMBEDDING_CHANGE_MAX)
        self.assertGreater(found["embedding_l2_percent"]["median"], 0)

    def test_a_transformer_needs_no_pictures(self):
        subprocess.run([sys.executable, ROOT / "models" / "export.py", "vit",
                        ROOT / "test" / "golden" / "tiny_mugs.pth", FOLDER, "--name", "vit"],
                       check=True, capture_output=True)
        int8 = quantised(FOLDER / "vit.toml", "vit_int8")
        self.assertIn("dynamic", int8.read_text())
        found = check(FOLDER / "vit.toml", int8, RUNS / "night")
        self.assertLess(found["embedding_l2_percent"]["median"], 5)
        self.assertGreater(found["embedding_l2_percent"]["median"], 0)

    def test_a_network_that_cannot_be_quantised_is_refused(self):
        for manifest, options, sentence in (
                (MODELS / f"{NAME}.toml", (), "name pictures with --pictures"),
                (self.int8, (), "is int8, expected the fp32 network"),
                (FOLDER / "absent.toml", (), "absent.toml: No such file")):
            done = run(sys.executable, ROOT / "models" / "quantise.py", manifest, "-o",
                       FOLDER / "never.toml", *options)
            self.assertEqual(done.returncode, 1)
            self.assertIn(sentence, done.stderr)
            self.assertFalse((FOLDER / "never.toml").exists())


if __name__ == "__main__":
    unittest.main()
