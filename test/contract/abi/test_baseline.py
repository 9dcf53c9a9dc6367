"""abidiff finds no difference between libvdna.so and test/contract/abi/vdna.abi.

Exit code 77 = skipped: abidiff is missing, or this is not the machine of the baseline.
"""

import platform
import shutil
import subprocess
import sys
import unittest

import pins

if platform.machine() != "x86_64":
    print("skipped: the baseline is of x86-64")
    sys.exit(77)
if not shutil.which("abidiff"):
    print("skipped: no abidiff; ./dev test --all installs it")
    sys.exit(77)


class TheBaseline(unittest.TestCase):
    def test_abidiff_finds_no_difference(self):
        # It takes a change behind a pointer for harmless, be it of double to float.
        found = subprocess.run(["abidiff", "--harmless", pins.BASELINE, pins.LIBRARY],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(found.returncode, 0, f"{found.stdout}\n{pins.REMEDY}")


if __name__ == "__main__":
    unittest.main()
