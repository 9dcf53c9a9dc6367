"""Every public struct and enumerator is as test/contract/abi/layout.txt pins it, on 64 and 32 bits."""

import shutil
import unittest

import pins


class TheLayout(unittest.TestCase):
    maxDiff = None

    def test_is_pinned_for_the_compiler_of_this_build(self):
        self.assertEqual(pins.layout(pins.NATIVE), pins.pinned_layout()[0], pins.REMEDY)

    @unittest.skipUnless(shutil.which("clang-19"), "clang-19 is missing")
    def test_is_the_same_on_aarch64(self):
        self.assertEqual(pins.layout(pins.AARCH64), pins.pinned_layout()[0], pins.REMEDY)

    @unittest.skipUnless(shutil.which("clang-19"), "clang-19 is missing")
    def test_is_pinned_for_32_bit_pointers(self):
        self.assertEqual(pins.layout(pins.ARMHF), pins.pinned_layout()[1], pins.REMEDY)


if __name__ == "__main__":
    unittest.main()
