"""Each public header compiles by itself, as C99 and as C++17, without a warning.

Environment: VDNA_COMPILERS, of gcc and clang those that are there, as LANGUAGE=COMPILER:...
"""

import os
import subprocess
import unittest
from pathlib import Path

INCLUDE = Path(__file__).resolve().parents[3] / "lib" / "include"
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
STANDARD = {"c": "-std=c99", "c++": "-std=c++17"}


class EachHeader(unittest.TestCase):
    def test_compiles_by_itself(self):
        headers = sorted(INCLUDE.glob("vdna/*.h"))
        self.assertTrue(headers)
        for pair in os.environ["VDNA_COMPILERS"].split(":"):
            language, compiler = pair.split("=")
            for header in headers:
                with self.subTest(compiler=compiler, header=header.name):
                    # Twice, for the guard.
                    compiled = subprocess.run(
                        [compiler, f"-x{language}", STANDARD[language], *WARNINGS, "-fsyntax-only",
                         f"-I{INCLUDE}", "-"], text=True, stdout=subprocess.PIPE,
                        stderr=subprocess.STDOUT, input=f"#include <vdna/{header.name}>\n" * 2)
                    self.assertEqual(compiled.returncode, 0, compiled.stdout)


if "clang" not in os.environ["VDNA_COMPILERS"]:
    print("skipped: no clang-19; ./dev test --all installs it")

if __name__ == "__main__":
    unittest.main()
