"""Two `vdna build --force` of one map at once: the map is that of one of them, and whoever comes too
late says so. With VDNA_ALL a hundred pairs."""

import os
import subprocess
import unittest

from tiny_maps import EXPERIENCES, FILES, NEW, OLD, TinyMaps, VDNA

PAIRS = 100 if os.environ.get("VDNA_ALL") else 10


class ConcurrentBuilds(TinyMaps):
    def begin(self, version):
        return subprocess.Popen([VDNA, *self.build_arguments("map", version)], cwd=self.folder,
                                text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def run_pair(self):
        """@return versions of the builds that succeeded"""
        pair = {version: self.begin(version) for version in (OLD, NEW)}
        made = []
        for version, build in pair.items():
            error = build.communicate(timeout=60)[1]
            if build.returncode == 0:
                made.append(version)
            else:
                self.assertEqual(build.returncode, 1, error)
                self.assertRegex(error, r"\Avdna: map: another program is changing this map; wait "
                                        r"until it has ended, then try again\n\Z")
        return made

    def test_leave_the_map_of_one_of_them(self):
        refused = 0
        for _ in range(PAIRS):
            made = self.run_pair()
            self.assertIn(self.version("map"), made)
            self.assertTrue(self.knows_itself("map"))
            self.assertEqual(self.files("map"), FILES)
            refused += len(made) == 1
        print(f"{PAIRS} pairs, in {refused} of them one was refused")
        self.assertGreater(refused, 0)

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
