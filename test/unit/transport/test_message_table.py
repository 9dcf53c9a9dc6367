"""Tests of lcmtypes/message_table.py: its tables of .lcm files, and its refusals."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[3] / "lcmtypes" / "message_table.py"
# From lcm-gen 1.3.1, for GOOD.
PIN = "demo.beat_t 35b08472ae2a6261"
GOOD = """\
// A comment; with code in it.
package demo;

struct point_t {
    double at[2];
}
struct beat_t {
    const int32_t FAST = 1;

    int64_t utime;
    int32_t n;
    point_t points[n];
    string names[n];
    boolean is_even;
    byte raw[4];
}
"""


class MessageTable(unittest.TestCase):

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = Path(self._folder.name)

    def run_on(self, lcm, pin=PIN, write=False):
        (self.folder / "beat.lcm").write_text(lcm, encoding="utf-8")
        (self.folder / "fingerprints.txt").write_text(pin + "\n", encoding="ascii")
        return subprocess.run([sys.executable, "-B", PROGRAM, self.folder / "fingerprints.txt",
                               *([self.folder] if write else [])], capture_output=True, text=True)

    def refused(self, lcm, line, *words, name="beat.lcm", pin=PIN):
        """One line on standard error, which names the place and holds the words."""
        result = self.run_on(lcm, pin, write=True)
        self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
        self.assertTrue(result.stderr.startswith(f"{self.folder / name}:{line}: "), result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse((self.folder / "vdna_messages.c").exists())

    def changed(self, old, new):
        self.assertEqual(GOOD.count(old), 1)
        return GOOD.replace(old, new)

    def test_the_types_of_each_file_are_listed_in_their_order(self):
        result = self.run_on(GOOD)
        self.assertEqual((result.returncode, result.stdout, result.stderr),
                         (0, "beat.lcm demo_point_t demo_beat_t\n", ""))

    def test_a_member_has_its_kind_its_length_and_its_count(self):
        self.assertEqual(self.run_on(GOOD, write=True).returncode, 0)
        text = (self.folder / "vdna_messages.c").read_text(encoding="ascii")
        for row in ('{"at", VDNA_MESSAGE_DOUBLE, offsetof(demo_point_t, at), 2, 0, NULL},',
                    '{"n", VDNA_MESSAGE_COUNT, offsetof(demo_beat_t, n), 1, 0, NULL},',
                    '{"points", VDNA_MESSAGE_STRUCT, offsetof(demo_beat_t, points), 0, 1, '
                    '&vdna_message_point},',
                    '{"names", VDNA_MESSAGE_STRING, offsetof(demo_beat_t, names), 0, 1, NULL},',
                    '{"raw", VDNA_MESSAGE_BYTE, offsetof(demo_beat_t, raw), 4, 0, NULL},'):
            self.assertIn(row, text)
        self.assertNotIn("FAST", text)
        header = (self.folder / "vdna_messages.h").read_text(encoding="ascii")
        self.assertIn("extern const vdna_message_type vdna_message_beat;", header)
        self.assertIn("#define VDNA_MESSAGE_TYPES 2\n", header)

    def test_a_type_that_the_tables_do_not_know_is_refused(self):
        self.refused(self.changed("double at", "float at"), 5, "float", "double", "teach")
        self.refused(self.changed("point_t points", "line_t points"), 12, "line_t")
        self.refused(self.changed("point_t points", "demo.point_t points"), 12, "'.point_t")

    def test_a_struct_is_used_only_below_its_declaration(self):
        self.refused(self.changed("double at[2]", "beat_t at[2]"), 5, "beat_t")
        self.refused(self.changed("double at[2]", "point_t at[2]"), 5, "point_t")

    def test_a_dimension_is_one_number_or_one_earlier_int32(self):
        self.refused(self.changed("at[2]", "at[2][2]"), 5, "'['", "one dimension")
        self.refused(self.changed("at[2]", "at[0]"), 5, "'0'", "1 or more")
        self.refused(self.changed("at[2]", "at[]"), 5, "']'")
        self.refused(self.changed("names[n]", "names[m]"), 13, "'m'", "int32_t before it")
        self.refused(self.changed("names[n]", "names[utime]"), 13, "'utime'", "int32_t before it")
        self.refused(self.changed("names[n]", "names[names]"), 13, "'names'")
        self.refused(self.changed("int32_t n;", "int32_t n[1];"), 12, "'n'")

    def test_forms_that_our_files_do_not_use_are_refused(self):
        self.refused(self.changed("int64_t utime;", "int64_t utime, other;"), 10, "', other;'")
        self.refused(self.changed("FAST = 1", "FAST = -1"), 8, "'-1;'")
        self.refused(self.changed("FAST = 1", "FAST = 1, SLOW = 2"), 8, "', SLOW = 2;'")
        self.refused(self.changed("const int32_t", "const double"), 8, "'double'", "int32_t")
        self.refused("/* " + GOOD, 1, "'/* //")
        self.refused(self.changed("package demo;\n", "package a.b;\n"), 2, "'.b;'")
        self.refused(self.changed("package demo;\n", "\n"), 4, "'struct'", "package")
        self.refused(self.changed("struct beat_t", "enum beat_t"), 7, "'enum'", "struct")

    def test_a_file_that_ends_too_early_is_refused(self):
        self.refused(GOOD.rstrip().removesuffix("}"), 16, "end of the file")
        self.refused("", 1, "end of the file", "package")

    def test_names_are_unique(self):
        self.refused(self.changed("boolean is_even", "boolean utime"), 14, "utime", "twice")
        self.refused(GOOD + "struct point_t { byte a; }\n", 17, "point_t", "twice")

    def test_no_name_breaks_the_code_that_lcm_gen_writes(self):
        for name, owner in (("decode", "generated C++"), ("marshal_binary", "generated Go"),
                            ("errno", "C"), ("lambda", "Python"), ("final", "Java"),
                            ("end", "Lua"), ("params", "C#"), ("select", "Go")):
            self.refused(self.changed("boolean is_even", f"boolean {name}"), 14,
                         f"member {name} ", f"'{owner}'", "rename")
        self.refused(self.changed("FAST", "True"), 8, "constant True ")
        self.refused(self.changed("boolean is_even", "boolean FAST"), 14, "FAST", "twice")
        self.refused(self.changed("boolean is_even", "boolean _even"), 14, "_even", "begins")
        self.refused(self.changed("boolean is_even", "boolean beat_t"), 14, "beat_t", "struct")

    def test_only_the_picture_of_camera_drivers_has_a_size(self):
        self.refused(self.changed("boolean is_even", "boolean size"), 14, "member size ", "'generated Go'")

    def test_a_comment_stands_above_what_it_explains(self):
        self.refused(self.changed("int64_t utime;", "int64_t utime; // us"), 10, "'// us'", "above")

    def test_a_struct_without_members_is_refused(self):
        self.refused(self.changed("double at[2];", ""), 6, "point_t", "no members")

    def test_a_fingerprint_that_is_not_pinned_is_reported(self):
        self.refused(self.changed("utime", "time"), 1, PIN.split()[1], "demo.beat_t",
                     "docs/reference/SPEC-lcm.md", name="fingerprints.txt")
        self.refused(GOOD, 1, "35b08472ae2a6261", name="fingerprints.txt",
                     pin="demo.beat_t 0000000000000000")
        self.refused(GOOD, 1, "other.beat_t", name="fingerprints.txt",
                     pin="other.beat_t 35b08472ae2a6261")

    def test_a_malformed_line_of_the_fingerprints_is_refused(self):
        for line in ("demo.beat_t", "beat_t 35b08472ae2a6261", "demo.beat 35b08472ae2a6261",
                     PIN + "0"):
            self.refused(GOOD, 1, line, name="fingerprints.txt", pin=line)

    def test_a_message_without_its_file_is_refused(self):
        self.refused(GOOD, 2, "absent.lcm", name="fingerprints.txt",
                     pin=f"{PIN}\ndemo.absent_t 0000000000000000")

    def test_two_types_of_one_name_are_refused(self):
        (self.folder / "other.lcm").write_text("package other;\nstruct beat_t { byte a; }\n"
                                               "struct other_t { byte a; }\n", encoding="utf-8")
        result = self.run_on(GOOD, f"{PIN}\nother.other_t 0000000000000000")
        pin = result.stderr.split("other.other_t ")[-1][:16]
        self.refused(GOOD, 2, "vdna_message_beat", "demo.beat_t", name="other.lcm",
                     pin=f"{PIN}\nother.other_t {pin}")


if __name__ == "__main__":
    unittest.main()
