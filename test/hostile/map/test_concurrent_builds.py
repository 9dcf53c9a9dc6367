"""Two `vdna build` of one map at once, with --force, into a new map, or adding to one: what is in it
afterwards is that of those which succeeded, and whoever comes too late says so. With VDNA_ALL a
hundred pairs."""

import os
import shutil
import subprocess
import unittest

from tiny_maps import EXPERIENCES, FILES, NEW, OLD, TinyMaps, VDNA

PAIRS = 100 if os.environ.get("VDNA_ALL") else 10


class ConcurrentBuilds(TinyMaps):
    def begin(self, arguments):
        return subprocess.Popen([VDNA, *arguments], cwd=self.folder, text=True,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def run_pair(self, builds):
        """@param builds  {what it makes: its arguments}
        @return those that were made"""
        pair = {what: self.begin(arguments) for what, arguments in builds.items()}
        made = []
        for what, build in pair.items():
            error = build.communicate(timeout=60)[1]
            if build.returncode == 0:
                made.append(what)
            else:
                self.assertEqual(build.returncode, 1, error)
                self.assertRegex(error, r"\Avdna: map: another program is changing this map; wait "
                                        r"until it has ended, then try again\n\Z")
        return made

    def test_leave_the_map_of_one_of_them(self):
        refused = 0
        for _ in range(PAIRS):
            made = self.run_pair({version: self.build_arguments("map", version)
                                  for version in (OLD, NEW)})
            self.assertIn(self.version("map"), made)
            self.assertTrue(self.knows_itself("map"))
            self.assertEqual(self.files("map"), FILES)
            refused += len(made) == 1
        print(f"{PAIRS} pairs, in {refused} of them one was refused")
        self.assertGreater(refused, 0)

    def add_pairs(self, begin_map, before, names):
        """Pairs of builds that add one experience each to a map, which compare only if one finds the
        ranges of the other."""
        refused = 0
        for _ in range(PAIRS):
            shutil.rmtree(self.folder / "map", ignore_errors=True)
            begin_map()
            made = self.run_pair({name: ["build", "--backbone", "./tiny.toml", "map",
                                         f"{OLD}/{name}"] for name in names})
            there = sorted([*before, *made])
            info = self.info("map")
            self.assertEqual([e["experience"] for e in info["experiences"]], there)
            self.assertEqual(info["mismatches"], [])
            self.assertEqual(self.files("map"), sorted(
                [f"{name}.vdna" for name in there] + ["trust.safetensors"] * (len(there) > 1)))
            self.assertEqual(self.knows_itself("map"), len(there) > 1)
            self.assertGreater(len(made), 0)
            refused += len(made) == 1
        print(f"{PAIRS} pairs, in {refused} of them one was refused")
        self.assertGreater(refused, 0)

    def test_into_a_new_map_make_one_that_compares(self):
        self.add_pairs(lambda: None, [], ["night", "summer"])

    def test_that_add_leave_all_that_succeeded(self):
        self.add_pairs(lambda: self.build_one("night"), ["night"], ["summer", "winter"])

    def build_one(self, name):
        done = subprocess.run([VDNA, "build", "--backbone", "./tiny.toml", "map", f"{OLD}/{name}"],
                              cwd=self.folder, text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_a_hundred_crashes_left_is_removed(self):
        self.restore(OLD)
        for name in EXPERIENCES:
            for n in range(100):
                (self.folder / f"map/{name}.vdna.{n}.partial").write_bytes(b"x")
            (self.folder / f"map/{name}.vdna.staged").write_bytes(b"x")
        for n in range(100):
            (self.folder / f"map/trust.safetensors.{n}.partial").write_bytes(b"x")
        self.build("map", NEW)
        self.assertEqual(self.version("map"), NEW)
        self.assertEqual(self.files("map"), FILES)


if __name__ == "__main__":
    unittest.main()
