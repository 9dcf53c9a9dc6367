"""Maps of three small experiences, in two versions that do not compare, for tests that build them
again and again. A version is its number of frames."""

import json
import os
import random
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from tiny_network import write_tiny_network

VDNA = Path(os.environ["VDNA_BIN"]) / "vdna"
OLD, NEW = 6, 5
EXPERIENCES = ["night", "summer", "winter"]
FILES = ["night.vdna", "summer.vdna", "trust.safetensors", "winter.vdna"]


def _write_pictures(folder, count):
    folder.mkdir(parents=True)
    chance = random.Random(str(folder.name) + str(count))
    for i in range(count):
        (folder / f"{i:03}.ppm").write_bytes(b"P6\n4 4\n255\n" + chance.randbytes(48))


class TinyMaps(unittest.TestCase):
    versions = (OLD, NEW)  # of which each test has a map and its pictures

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-map-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        write_tiny_network(self.folder, ("tokens", "samples_neurons"))
        for version in self.versions:
            for name in EXPERIENCES:
                _write_pictures(self.folder / str(version) / name, version)
            self.build(str(version) + ".map", version)

    def build_arguments(self, folder, version):
        return ["build", "--force", "--backbone", "./tiny.toml", folder,
                *(f"{version}/{name}" for name in EXPERIENCES)]

    def build(self, folder, version):
        done = subprocess.run([VDNA, *self.build_arguments(folder, version)], cwd=self.folder,
                              text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def restore(self, version):
        """Make the map one of a version."""
        shutil.rmtree(self.folder / "map", ignore_errors=True)
        shutil.copytree(self.folder / f"{version}.map", self.folder / "map")

    def info(self, folder):
        done = subprocess.run([VDNA, "info", "--json", folder], cwd=self.folder, text=True,
                              capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def knows_itself(self, folder):
        """Whether the map's own file is of the experiences that are there."""
        return self.info(folder)["maps"][0]["tolerance"] is not None

    def version(self, folder):
        """The version of a map, which must be one for all its experiences."""
        found = self.info(folder)["experiences"]
        self.assertEqual([e["experience"] for e in found], EXPERIENCES)
        versions = {e["frames"] for e in found}
        self.assertEqual(len(versions), 1, found)
        return versions.pop()

    def files(self, folder):
        return sorted(path.name for path in (self.folder / folder).iterdir())
