"""Each shared library exports what its headers declare and what its map in lib/ pins: no more and no
less.
"""

import os
import subprocess
import unittest

import declarations
import pins

BUILT = [library for library in pins.LIBRARIES if library.path]


def output_of(tool, *arguments):
    return subprocess.run([os.environ[tool], *arguments], check=True, stdout=subprocess.PIPE,
                          text=True).stdout


class TheExportedFunctions(unittest.TestCase):
    def test_the_list_is_what_the_headers_declare(self):
        for library in pins.LIBRARIES:
            self.assertEqual(library.map.read_text(), library.exports_text(), pins.REMEDY)

    def test_the_library_exports_these_and_no_others(self):
        for library in BUILT:
            # Ours look like vdna_emd@@VDNA_0; the version's own symbol differs from nm to nm.
            names = output_of("VDNA_NM", "-D", "--defined-only", "--format=posix", library.path)
            exported = sorted(line.split()[0] for line in names.splitlines()
                              if not line.startswith(library.node))
            declared = sorted(declarations.functions(library.headers))
            self.assertEqual(exported, [f"{name}@@{library.node}" for name in declared])

    def test_the_library_names_its_major_version(self):
        for library in BUILT:
            dynamic = output_of("VDNA_READELF", "--dynamic", library.path)
            self.assertIn(f"Library soname: [{library.name}.so.0]", dynamic)


if __name__ == "__main__":
    unittest.main()
