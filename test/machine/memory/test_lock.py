"""memory.lock keeps the daemon's pages from being paged out. Not in a namespace, where even root
may not lock; skipped if this user may not lock either.
"""
import os
import subprocess
import sys
import tempfile
import unittest

from selectord import Selectord, memory_of, network_process

STUB = os.environ["VDNA_STUB_BACKBONE"]


class Lock(unittest.TestCase):

    def test_memory_is_locked_without_growing(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.environ["VDNA_STUB_MAP"], folder], check=True)
            path = os.path.join(folder, "lock.toml")
            with open(path, "w", encoding="ascii") as file:
                file.write("[memory]\nlock = true\n")
            options = ("--map", folder, "--backbone", STUB, "-l", "memq://")
            with Selectord(*options) as daemon:
                free = memory_of(daemon.pid)
            try:
                locked_daemon = Selectord(*options, "-c", path)
            except AssertionError as error:
                self.assertIn("cannot be locked", str(error))
                print(f"skipped: {error}")
                sys.exit(77)
            with locked_daemon:
                locked = memory_of(locked_daemon.pid)
                network = memory_of(network_process(locked_daemon.pid))
        self.assertEqual(free["VmLck"], 0)
        self.assertGreaterEqual(locked["VmLck"], locked["VmRSS"] * 3 // 4)
        self.assertGreaterEqual(network["VmLck"], network["VmRSS"] * 3 // 4)
        self.assertLess(locked["VmRSS"], free["VmRSS"] * 3 // 2)


if __name__ == "__main__":
    unittest.main()
