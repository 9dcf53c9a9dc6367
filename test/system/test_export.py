"""`vdna export --c-array`: its files are strict C, and a program that has them and no files ranks as `vdna rank`.

Environment: VDNA_CC, VDNA_STATIC (libvdna.a), VDNA_INCLUDE.
"""

import json
import os
import random
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from tiny_network import write_tiny_network

VDNA = Path(os.environ["VDNA_BIN"]) / "vdna"
CC, LIBRARY, INCLUDE = (os.environ[name] for name in ("VDNA_CC", "VDNA_STATIC", "VDNA_INCLUDE"))
STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]
SANITIZER = [f"-fsanitize={names}" for names in [os.environ["VDNA_SANITIZE"]] if names]  # of libvdna.a
LIVE, CANDIDATES = "day-1.b", ["night", "summer"]

PROGRAM = r"""
#include <stdio.h>
#include <vdna/map.h>
#include <vdna/vdna.h>

extern const unsigned char experience_day_1_b[], experience_night[], experience_summer[];
extern const size_t experience_day_1_b_size, experience_night_size, experience_summer_size;

int main(void)
{
    static uint64_t scratch[4096];
    const unsigned char *const bytes[] = {experience_day_1_b, experience_night, experience_summer};
    const size_t sizes[] = {experience_day_1_b_size, experience_night_size, experience_summer_size};
    vdna_experience e[3];
    vdna_hist_view dna[3];
    vdna_rank_entry ranking[2];
    vdna_error error;
    for (int i = 0; i < 3; i++) {
        if (vdna_experience_open_memory(bytes[i], sizes[i], &error, &e[i]) != VDNA_OK)
            return fprintf(stderr, "%s\n", error.text), 1;
        vdna_experience_view(&e[i], &dna[i]);
    }
    if (vdna_rank(&dna[0], &dna[1], 2, scratch, sizeof scratch, ranking) != VDNA_OK)
        return 1;
    for (int i = 0; i < 2; i++)
        printf("%s %.17g\n", e[1 + ranking[i].candidate].name, ranking[i].distance_bins);
    for (int i = 0; i < 3; i++)
        vdna_experience_close(&e[i]);
    return 0;
}
"""


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vdna-export-")))
        write_tiny_network(cls.folder, ("tokens", "samples_neurons"))
        chance = random.Random(1)
        for darkest, name in enumerate((LIVE, *CANDIDATES)):
            (cls.folder / name).mkdir()
            for i in range(4):
                pixels = bytes(chance.randrange(60 * darkest, 256) for _ in range(48))
                (cls.folder / name / f"{i}.ppm").write_bytes(b"P6\n4 4\n255\n" + pixels)
        cls.vdna("build", "map", LIVE, *CANDIDATES, "--backbone", "./tiny.toml", "--no-thumbnails")

    @classmethod
    def vdna(cls, *arguments, code=0):
        done = subprocess.run([VDNA, *map(str, arguments)], cwd=cls.folder, text=True, capture_output=True,
                              check=False)
        if done.returncode != code:
            raise AssertionError(f"{arguments}: {done.returncode}, expected {code}: {done.stderr}")
        return done.stderr if code else done.stdout

    def setUp(self):
        self.out = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="vdna-export-")))

    def compile(self, *arguments):
        subprocess.run([CC, *STRICT, *map(str, arguments)], check=True, cwd=self.out)

    def test_a_program_without_files_ranks_as_vdna_rank(self):
        said = self.vdna("export", "map", "--c-array", "-o", self.out)
        sources = sorted(self.out.glob("*.c"))
        self.assertEqual([path.stem for path in sources],
                         ["experience_day_1_b", "experience_night", "experience_summer"])
        for path in sources:
            self.assertIn(f"{path}: {path.stem}, ", said)
        (self.out / "ranks.c").write_text(PROGRAM, encoding="ascii")
        self.compile("-I", INCLUDE, "ranks.c", *sources, LIBRARY, *SANITIZER, "-lmd", "-lm", "-o", "ranks")
        found = [line.split() for line in subprocess.run(
            [self.out / "ranks"], check=True, text=True, stdout=subprocess.PIPE).stdout.splitlines()]
        expected = json.loads(self.vdna(
            "rank", "--json", *(f"map/{name}.vdna" for name in (LIVE, *CANDIDATES))))["ranking"]
        self.assertEqual([(name, float(distance)) for name, distance in found],
                         [(entry["experience"], entry["distance_bins"]) for entry in expected])

    def test_the_array_has_the_file_its_size_and_its_identity(self):
        self.vdna("export", "map/night.vdna", "--c-array", "-o", self.out / "mine.c")
        text = (self.out / "mine.c").read_text(encoding="ascii")
        numbers = re.search(r"\] = \{\n([0-9, \n]*)\};", text)[1]
        data = (self.folder / "map/night.vdna").read_bytes()
        self.assertEqual(bytes(int(number) for number in numbers.split(",")[:-1]), data)
        self.assertIn(f"experience_night[{len(data)}]", text)
        (experience,) = json.loads(self.vdna("info", "--json", "map/night.vdna"))["experiences"]
        for key in ("comparable", "model_sha256", "backbone"):
            self.assertRegex(text, rf"\* {key} +{experience[key]}")
        self.assertLessEqual(max(map(len, text.splitlines())), 120)

    @unittest.skipUnless(shutil.which("objdump"), "no objdump")
    def test_a_section_may_be_chosen(self):
        self.vdna("export", "map/night.vdna", "--c-array", "-o", self.out)
        self.compile("-c", "experience_night.c", "-o", "usual.o")
        self.compile("-c", "experience_night.c", "-DVDNA_FLASH=section(\".flash\")", "-o", "flash.o")
        for name, section in (("usual.o", ".rodata"), ("flash.o", ".flash")):
            symbols = subprocess.run(["objdump", "-t", self.out / name], check=True, text=True,
                                     stdout=subprocess.PIPE).stdout
            self.assertRegex(symbols, rf"{re.escape(section)}\s+[0-9a-f]+ experience_night\n")

    def test_names_that_are_one_identifier_are_refused(self):
        for first, second in (("a-b", "a_b"), ("a", "a.size")):
            with self.subTest(first + " " + second):
                world = self.out / (first + second)
                self.vdna("build", world, "night", "--name", first, "--backbone", "./tiny.toml")
                self.vdna("build", world, "summer", "--name", second, "--backbone", "./tiny.toml")
                error = self.vdna("export", world, "--c-array", "-o", self.out / "made", code=1)
                self.assertRegex(error, "would be experience_a_(b|size) in C, as .* is; ")
                self.assertFalse((self.out / "made").exists())

    def test_a_map_does_not_fit_in_a_file(self):
        error = self.vdna("export", "map", "--c-array", "-o", self.out / "all.c", code=2)
        self.assertIn("there are 3; give a folder", error)
        self.vdna("export", "map", code=2)


if __name__ == "__main__":
    unittest.main()
