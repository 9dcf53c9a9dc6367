"""Experience files against another implementation of their layout: the safetensors package.

    test_map.py EXPERIENCE_DUMP SPEC_MAP_MD

The package opens files of our writer; our reader opens files of the package and of the recipe in
the specification. Exit code 77 = skipped: the package is missing.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    from safetensors import safe_open
    from safetensors.numpy import load_file
except ImportError as missing:
    print(f"skipped: {missing}; numpy is Debian's python3-numpy, ./dev fetches safetensors")
    sys.exit(77)

DUMP, SPEC = sys.argv[1:3]

SHA256 = "0123456789abcdef" * 4

# As in test/support/map_files.h.
SAMPLE_METADATA = {
    "name": "winter",
    "backbone": "tiny-net_1.0",
    "model_sha256": SHA256,
    "preprocessing": 'rgb 8x8 "area" mean=0 std=1 \\',
    "taps": "mid:2:4,top:1:1",
    "position_frame": "local",
    "order": "utime",
}
SAMPLE = {
    "frame_utime": np.array([1000000, 1033333], np.int64),
    "frame_place": np.array([17, 18], np.int64),
    "frame_position": np.array([[0, 0, 0], [1.5, -2, 0.25]], np.float64),
    "counts": np.array([[1, 8, 0], [2, 0, 0], [3, 0, 1], [2, 0, 1]], np.uint32),
    "mass": np.array([8, 8, 2], np.uint32),
    "range": np.array([[-1, 1], [0, 6], [-2.5, 2.5]], np.float32),
    "embeddings": np.array([[1, 0, 0, 0, 0], [0, 0.5, -0.5, 0.5, -0.5]], np.float32),
    "frame_grey": np.array([0, 127.5], np.float32),
}


CODED = {name: array for name, array in SAMPLE.items() if name != "embeddings"}
CODED |= {
    "frame_embedding": np.array([[127, 0, 0, 0, 0], [0, 64, -64, 64, -64]], np.int8),
    "frame_embedding_scale": np.array([0.5, 0.25], np.float32),
    "frame_last_layer": np.array([[127, 0, -64, 1, 2, 3, 4], [-127, 3, 127, 0, 0, 9, 0]], np.int8),
    "frame_last_layer_scale": np.array([0.5, 0], np.float32),
}


def spec_block(language, holding):
    """The code block of the specification that contains some text."""
    with open(SPEC, encoding="utf-8") as spec:
        blocks = re.findall(rf"```{language}\n(.*?)```", spec.read(), re.DOTALL)
    (block,) = [text for text in blocks if holding in text]
    return block


RECIPE = {}
exec(spec_block("python", "def write_experience"), RECIPE)  # pylint: disable=exec-used


class Experience(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = os.path.join(directory.name, "experience.vdna")

    def dump(self, mode):
        return subprocess.run([DUMP, mode, self.path], capture_output=True, text=True, check=False)

    def read_with_ours(self):
        result = self.dump("read")
        self.assertEqual(result.stderr, "")
        return dict(line.partition(" ")[::2] for line in result.stdout.splitlines())

    def assert_ours_reads(self, tensors, metadata):
        found = self.read_with_ours()
        for key, text in metadata.items():
            self.assertEqual(found[key], text, key)
        for name, expected in tensors.items():
            numbers = np.array(found[name].split()).astype(expected.dtype)
            np.testing.assert_array_equal(numbers, expected.ravel(), name)

    def test_what_ours_writes_opens_with_the_package(self):
        self.assertEqual(self.dump("write").stderr, "")
        tensors = load_file(self.path)
        self.assertEqual(set(tensors), set(SAMPLE) | {"crc32c"})
        for name, expected in SAMPLE.items():
            self.assertEqual(tensors[name].dtype, expected.dtype, name)
            np.testing.assert_array_equal(tensors[name], expected, name)
        with safe_open(self.path, "numpy") as file:
            metadata = file.metadata()
        for key, text in SAMPLE_METADATA.items():
            self.assertEqual(metadata[key], text, key)

    def test_the_checksum_stands_last_and_is_crc32c(self):
        self.dump("write")
        with open(self.path, "rb") as file:
            content = file.read()
        self.assertEqual(RECIPE["crc32c"](b"123456789"), 0xE3069283)
        self.assertEqual(int.from_bytes(content[-4:], "little"), RECIPE["crc32c"](content[:-4]))

    def test_the_example_of_the_specification_is_what_ours_writes(self):
        self.dump("write")
        with open(self.path, "rb") as file:
            content = file.read()
        length = int.from_bytes(content[:8], "little")
        written = json.loads(content[8 : 8 + length])
        self.assertEqual(json.loads(spec_block("json", "__metadata__")), written)
        with open(SPEC, encoding="utf-8") as spec:
            self.assertIn(
                f"With padding, N = {length} bytes, so the data begins at byte {8 + length}"
                f" and the file has {len(content)} bytes.",
                " ".join(spec.read().split()),
            )

    def test_what_the_recipe_writes_opens_with_ours(self):
        RECIPE["write_experience"](self.path, SAMPLE, SAMPLE_METADATA)
        self.assert_ours_reads(SAMPLE, SAMPLE_METADATA)

    def test_both_writers_agree_on_what_compares(self):
        self.dump("write")
        ours = self.read_with_ours()["comparable"]
        RECIPE["write_experience"](self.path, SAMPLE, SAMPLE_METADATA)
        self.assertEqual(self.read_with_ours()["comparable"], ours)

    def test_tensors_and_texts_of_others_are_ignored(self):
        tensors = {name: SAMPLE[name] for name in SAMPLE if not name.startswith("frame_p")}
        extra = {
            "acme_mean": np.arange(5, dtype=np.float64),
            "acme_flags": np.ones(3, np.uint8),
            "acme_empty": np.zeros((0, 4), np.float32),
        }
        metadata = dict(SAMPLE_METADATA, acme_note='Příliš žluťoučký\n"kůň" \U0001f40e')
        RECIPE["write_experience"](self.path, {**tensors, **extra}, metadata)
        self.assert_ours_reads(tensors, dict(SAMPLE_METADATA, position_frame=""))
        self.assertEqual(self.read_with_ours()["frame_place"], "")

    def test_thumbnails_that_the_recipe_writes_open_with_ours(self):
        pictures = {
            "thumbnails": np.frombuffer(b"onethree", np.uint8),
            "frame_thumbnail_end": np.array([3, 8], np.uint32),
        }
        RECIPE["write_experience"](self.path, {**SAMPLE, **pictures}, dict(SAMPLE_METADATA, source="a.mp4"))
        self.assert_ours_reads(SAMPLE, SAMPLE_METADATA)

    def test_a_large_random_experience_opens_with_ours(self):
        random = np.random.default_rng(1)
        frames, samples, neurons, bins, dim = 7, 9, 1300, 50, 33
        counts = random.multinomial(frames * samples, [1 / bins] * bins, neurons).T
        low = random.normal(size=neurons)
        tensors = {
            "frame_utime": random.integers(-(2**62), 2**62, frames),
            "counts": np.ascontiguousarray(counts, np.uint32),
            "mass": np.full(neurons, frames * samples, np.uint32),
            "range": np.stack([low, low + 1], 1).astype(np.float32),
            "embeddings": random.normal(size=(frames, dim)).astype(np.float32),
            "frame_grey": random.uniform(0, 255, frames).astype(np.float32),
        }
        metadata = dict(SAMPLE_METADATA, taps=f"layer:3:{neurons}:{samples}")
        RECIPE["write_experience"](self.path, tensors, metadata)
        self.assert_ours_reads(tensors, dict(metadata, position_frame=""))

    def test_frames_without_truth_are_of_version_2(self):
        tensors = dict(
            SAMPLE,
            frame_place=np.array([-(2**63), 18], np.int64),
            frame_position=np.array([[0, 0, 0], [np.nan] * 3], np.float64),
        )
        RECIPE["write_experience"](self.path, tensors, SAMPLE_METADATA)
        with safe_open(self.path, "numpy") as file:
            self.assertEqual(file.metadata()["format_version"], "2")
        self.assert_ours_reads(tensors, SAMPLE_METADATA)

    def test_codes_and_a_second_embedding_are_of_version_3(self):
        self.assertEqual(self.dump("write-codes").stderr, "")
        written = load_file(self.path)
        self.assertEqual(set(written), set(CODED) | {"crc32c"})
        for name, expected in CODED.items():
            self.assertEqual(written[name].dtype, expected.dtype, name)
            np.testing.assert_array_equal(written[name], expected, name)
        ours = self.read_with_ours()["comparable"]

        metadata = dict(SAMPLE_METADATA, embedding="mid grid=1x5 last=top centred")
        RECIPE["write_experience"](self.path, CODED, metadata)
        with safe_open(self.path, "numpy") as file:
            self.assertEqual(file.metadata()["format_version"], "3")
        self.assert_ours_reads(CODED, metadata)
        found = self.read_with_ours()
        self.assertEqual(found["comparable"], ours)
        decoded = CODED["frame_embedding"] * CODED["frame_embedding_scale"][:, None]
        np.testing.assert_array_equal(np.float32(found["embeddings"].split()), decoded.ravel())

    def test_a_projection_is_of_version_4(self):
        self.assertEqual(self.dump("write-projected").stderr, "")
        written = load_file(self.path)
        projection = np.zeros((5, 6), np.float32)
        projection[[0, 1, 2, 3, 3, 4, 4], [0, 1, 3, 4, 5, 4, 5]] = [1, -1, 0.5, 1, 1, -1, 1]
        np.testing.assert_array_equal(written["projection"], projection)
        ours = self.read_with_ours()["comparable"]

        del written["crc32c"]
        metadata = dict(SAMPLE_METADATA, embedding="mid grid=1x3 last=top centred")
        RECIPE["write_experience"](self.path, written, metadata)
        with safe_open(self.path, "numpy") as file:
            self.assertEqual(file.metadata()["format_version"], "4")
        self.assert_ours_reads(written, metadata)
        self.assertEqual(self.read_with_ours()["comparable"], ours)

    def test_a_bit_behind_the_checksum_counts_as_well(self):
        RECIPE["write_experience"](self.path, SAMPLE, SAMPLE_METADATA)
        with open(self.path, "rb+") as file:
            file.seek(-5, os.SEEK_END)
            byte = file.read(1)[0]
            file.seek(-5, os.SEEK_END)
            file.write(bytes([byte ^ 1]))
        result = self.dump("read")
        self.assertEqual(result.returncode, 1)
        self.assertIn("CRC-32C", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
