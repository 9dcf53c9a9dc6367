"""lib/core, lib/health, lib/localise, lib/trust and lib/select on a Cortex-M4 without a C library: their needs, code
size and stack.

With and without the processor's own floats. Exit code 77 = skipped: no cross compiler.
"""

import sys
import tempfile
import unittest
from pathlib import Path

from machine import SOURCES, CallGraph, Machine

TEXT_MAX = 51 * 1024  # bytes, libgcc's arithmetic included; of them 16 KB are trust, which links apart
STACK_MAX = 1280  # bytes, libgcc's arithmetic included: a selector that calls a localiser

try:
    MACHINES = [Machine("cortex-m4"), Machine("cortex-m4f")]
except FileNotFoundError as missing:
    print(f"skipped: no {missing.filename}; ./dev test --all installs it")
    sys.exit(77)


class CortexM4:
    machine = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        folder = Path(cls.folder.name)
        objects = cls.machine.compile(folder, "-Os")
        cls.library, image = folder / "library", folder / "image"
        cls.machine.link(cls.library, "-r", *objects, "-lgcc")
        cls.machine.link(image, *objects, folder / "start.o", "-lgcc")
        cls.public = sorted(set().union(*(cls.machine.symbols(o, "T") for o in objects)))
        cls.graph = CallGraph(cls.machine, folder, image)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_it_needs_three_functions_of_the_c_library(self):
        self.assertEqual(
            self.machine.symbols(self.library, "U") - {"memcpy", "memset", "memcmp"}, set()
        )

    def test_it_has_no_variables_of_its_own(self):
        _, data, bss = self.machine.sizes(self.library)
        self.assertEqual((data, bss), (0, 0))

    def test_its_code_is_small(self):
        text, _, _ = self.machine.sizes(self.library)
        self.assertLessEqual(text, TEXT_MAX)

    def test_no_frame_depends_on_the_input(self):
        self.assertEqual({f for f, kind in self.graph.kinds.items() if kind != "static"}, set())

    def test_no_function_is_called_through_a_pointer(self):
        """Calls through pointers would be missing in the call graph."""
        callers = {f for f, calls in self.graph.calls.items() if "__indirect_call" in calls}
        self.assertEqual(callers, set())

    def test_its_stack_is_small_and_nothing_recurses(self):
        self.assertGreater(len(self.public), len(SOURCES))
        stack, path = max(self.graph.worst(function) for function in self.public)
        print(f"{self.machine.name}: worst stack {stack} bytes: {' > '.join(path)}")
        self.assertLessEqual(stack, STACK_MAX)


class SoftFloat(CortexM4, unittest.TestCase):
    machine = MACHINES[0]


class HardFloat(CortexM4, unittest.TestCase):
    machine = MACHINES[1]


if __name__ == "__main__":
    unittest.main()
