"""A million frames through the daemon's loop, with a backbone that costs nothing: our own code
allocates no more often than for a few frames, and the process does not grow.

VDNA_FRAMES sets another number of frames.
"""
import os
import subprocess
import tempfile
import unittest

from allocations import Allocations

FEW, MANY = 1, int(os.environ.get("VDNA_FRAMES", 1000000))
FLAT = 256 << 10  # bytes, of some 5 MB


class ManyFrames(unittest.TestCase):

    def run_frames(self, count):
        """Frames, resident bytes after 100 of them and at the end, allocations by object."""
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.environ["VDNA_STUB_MAP"], os.path.join(folder, "map")], check=True)
            allocations = Allocations(os.path.join(folder, "allocations"))
            result = subprocess.run(
                [os.environ["VDNA_MANY_FRAMES"], os.path.join(folder, "map"), str(count)],
                env={**os.environ, **allocations.environment}, stdout=subprocess.PIPE, text=True,
                check=True)
            return (*map(int, result.stdout.split()), *allocations.read())

    def test_a_million_frames_cost_no_allocation_of_ours_and_no_memory(self):
        _, _, _, few_live, few = self.run_frames(FEW)
        frames, early, late, live, calls = self.run_frames(MANY)
        print(f"{frames} frames: resident {early} bytes after 100, {late} at the end; allocations: "
              + ", ".join(f"{name} {calls[name]} ({calls[name] - few.get(name, 0):+})"
                          for name in sorted(calls, key=calls.get, reverse=True)))
        self.assertEqual(frames, MANY)
        self.assertGreater(few["program"], 0)  # otherwise nothing is being counted
        self.assertEqual(calls["program"], few["program"])
        # LCM's queue within a process allocates for each message: the counter tells us apart.
        self.assertGreater(sum(calls.values()), MANY)
        self.assertLess(abs(late - early), FLAT)
        self.assertLess(live - few_live, 16384)  # LCM's queue keeps some blocks


if __name__ == "__main__":
    unittest.main()
