"""What is installed and packaged is stripped and holds no path of the machine where it was built; its
debug information can be installed apart.

Exit code 77 = skipped: a tool is missing.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

STAGE = Path(os.environ["VDNA_STAGE"])
PATHS = [path.encode() for path in os.environ["VDNA_MACHINE_PATHS"].split(":")]
DEBUG_INFORMATION = os.environ["VDNA_DEBUG_INFORMATION"] == "1"

if not shutil.which("readelf"):
    print("skipped: no readelf; install binutils")
    sys.exit(77)


def readelf(*arguments):
    return subprocess.run(["readelf", "--wide", *arguments], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True).stdout


def files_in(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def ours(folder):
    """What the linker made of our objects."""
    return [path for path in files_in(folder)
            if path.parent.name in ("bin", "sbin")
            or path.name.startswith(("libvdna.so", "libvdna_backbone.so"))]


def build_id(path):
    return re.search(r"Build ID: ([0-9a-f]+)", readelf("--notes", path))[1]


class Stripped:
    """What is in `prefix`, with its debug information below `debug`."""

    def test_holds_no_path_of_the_machine(self):
        for file in files_in(self.prefix):
            content = file.read_bytes()
            for path in PATHS:
                self.assertNotIn(path, content, file)

    def test_is_stripped(self):
        for path in (*ours(self.prefix), *self.prefix.rglob("libvdna.a")):
            self.assertNotIn(" .debug_", readelf("--sections", path), path)

    def test_does_not_include_debug_information(self):
        self.assertFalse(list(self.prefix.rglob("*.debug")))

    def test_has_debug_information_apart_where_debuggers_look(self):
        self.assertTrue(ours(self.prefix))
        for path in ours(self.prefix):
            name = build_id(path)
            file = self.debug / "lib" / "debug" / ".build-id" / name[:2] / f"{name[2:]}.debug"
            self.assertEqual(build_id(file), name)
            if DEBUG_INFORMATION:
                self.assertIn(" .debug_info", readelf("--sections", file))


class TheInstallation(Stripped, unittest.TestCase):
    prefix, debug = STAGE / "prefix", STAGE / "debug"


@unittest.skipUnless(list(STAGE.glob("debs/*.deb")), "no packages were made")
class ThePackages(Stripped, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(dir=STAGE)
        cls.addClassCleanup(folder.cleanup)
        for deb in STAGE.glob("debs/*.deb"):
            kind = "debug" if "-dbgsym_" in deb.name else "prefix"
            subprocess.run(["dpkg-deb", "--extract", deb, Path(folder.name, kind)], check=True)
        cls.prefix, cls.debug = Path(folder.name, "prefix"), Path(folder.name, "debug", "usr")


if __name__ == "__main__":
    unittest.main()
