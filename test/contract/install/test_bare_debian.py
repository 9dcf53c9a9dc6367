"""The daemon's packages on a bare Debian 12: apt installs them with little else, and the daemon runs.

Environment: VDNA_BIN (programs that make a map), VDNA_STAGE (debs/ has the packages), VDNA_BARE_DEBIAN
(folder of the bare system, made the first time). Exit code 77 = skipped: root, a tool or the network is
missing.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
VDNA = Path(os.environ["VDNA_BIN"], "vdna")
DEBS = Path(os.environ["VDNA_STAGE"], "debs")
BARE = Path(os.environ["VDNA_BARE_DEBIAN"])
OURS = ("vdna-selectord", "vdna-networks")
FURTHER_PACKAGES_MAX = 8
MEGABYTES_MAX = 10  # without ONNX Runtime and the networks


def skip(reason):
    print(f"skipped: no {reason}")
    sys.exit(77)


def bare_debian(command, root, *arguments):
    return subprocess.run([HERE / "bare_debian.sh", command, root, *arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def make_bare_debian():
    """Once: the tests install into a copy of it."""
    if BARE.exists():
        return
    new = BARE.with_name(BARE.name + ".new")
    shutil.rmtree(new, ignore_errors=True)
    BARE.parent.mkdir(parents=True, exist_ok=True)
    made = bare_debian("make", new)
    if made.returncode:
        skip(f"bare Debian; {made.stdout}")
    new.rename(BARE)


class ABareDebian(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(dir=BARE.parent)
        cls.addClassCleanup(folder.cleanup)
        cls.root = Path(folder.name, "root")
        subprocess.run(["cp", "--archive", BARE, cls.root], check=True)
        cls.make_map(cls.root / "srv" / "map")
        debs = [next(DEBS.glob(f"{name}_*.deb")) for name in OURS]
        for deb in debs:
            shutil.copy(deb, cls.root / "root")

        cls.before = cls.installed()
        updated = bare_debian("run", cls.root, "apt-get", "-o", "APT::Update::Error-Mode=any",
                              "update")
        if updated.returncode:
            skip(f"network; apt-get update says: {updated.stdout}")
        cls.said = cls.run_inside("apt-get", "install", "--yes", "--no-install-recommends",
                                  *[f"./{deb.name}" for deb in debs])
        cls.new = {name: size for name, size in cls.installed().items() if name not in cls.before}

    @classmethod
    def make_map(cls, folder):
        pictures = cls.root / "srv" / "summer"
        for command in (("simulate", pictures, "--frames", "4", "--size", "160x120"),
                        ("build", folder, pictures)):
            subprocess.run([VDNA, *command], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def run_inside(cls, *command):
        done = bare_debian("run", cls.root, *command)
        if done.returncode:
            raise AssertionError(f"{command}: {done.stdout}")
        return done.stdout

    @classmethod
    def installed(cls):
        """Bytes of each package, as its control file tells them."""
        lines = cls.run_inside("dpkg-query", "--show", "--showformat",
                               "${db:Status-Status} ${Package} ${Installed-Size}\n").splitlines()
        return {name: int(kib) * 1024
                for status, name, kib in map(str.split, lines) if status == "installed"}

    def test_gets_few_packages_of_few_megabytes(self):
        further = sorted(set(self.new) - set(OURS))
        for name in (*OURS, *further):
            print(f"{name}: {self.new[name] / 1e6:.1f} MB")
        megabytes = sum(self.new.values()) / 1e6 - self.new["vdna-networks"] / 1e6
        print(f"{len(further)} further packages, {megabytes:.1f} MB beside vdna-networks",
              flush=True)
        self.assertLessEqual(len(further), FURTHER_PACKAGES_MAX)
        self.assertLessEqual(megabytes, MEGABYTES_MAX)

    def test_runs_the_daemon(self):
        self.assertRegex(self.run_inside("vdna_selectord", "--version"), r"\d+\.\d+\.\d+")
        self.assertIn("[map]", self.run_inside("vdna_selectord", "--print-config"))

    def test_has_the_runtime_and_the_network_that_a_map_needs(self):
        said = self.run_inside("vdna_selectord", "--map", "/srv/map", "--check")
        self.assertIn("OK: /srv/map: 1 experiences, 4 frames; ", said)


if __name__ == "__main__":
    if os.geteuid() != 0:
        skip("root; only root can make and enter a new root")
    if not shutil.which("debootstrap"):
        skip("debootstrap; ./dev test --all installs it")
    if not any(DEBS.glob("*.deb")):
        skip("dpkg-dev, so no packages; install build-essential")
    make_bare_debian()
    unittest.main()
