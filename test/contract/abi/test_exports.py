"""libvdna.so exports what its headers declare and what lib/vdna.map pins: no more and no less."""

import os
import subprocess
import unittest

import declarations
import pins


class TheExportedFunctions(unittest.TestCase):
    def test_the_list_is_what_the_headers_declare(self):
        self.assertEqual(pins.EXPORTS.read_text(), pins.exports_text(), pins.REMEDY)

    def test_the_library_exports_these_and_no_others(self):
        # Ours look like vdna_emd@@VDNA_0; the version's own symbol differs from nm to nm.
        names = subprocess.run([os.environ["VDNA_NM"], "-D", "--defined-only", "--format=posix",
                                pins.LIBRARY], check=True, stdout=subprocess.PIPE, text=True)
        exported = sorted(line.split()[0] for line in names.stdout.splitlines()
                          if not line.startswith("VDNA_0"))
        declared = sorted(declarations.functions(pins.HEADERS))
        self.assertEqual(exported, [f"{name}@@VDNA_0" for name in declared])

    def test_the_library_names_its_major_version(self):
        dynamic = subprocess.run([os.environ["VDNA_READELF"], "--dynamic", pins.LIBRARY],
                                 check=True, stdout=subprocess.PIPE, text=True)
        self.assertIn("Library soname: [libvdna.so.0]", dynamic.stdout)


if __name__ == "__main__":
    unittest.main()
