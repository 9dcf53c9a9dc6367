"""`vdna build --force` over a map, killed or refused at any of its system calls: the map is the old
one or the new one and can be opened, the next build works, and nothing is left over.

strace makes the calls fail. Some of the cases run, with VDNA_ALL more;
with VDNA_EVERY_CALL all of them do, which takes a quarter of an hour.
"""

import os
import re
import shutil
import subprocess
import unittest

import tools
from tiny_maps import FILES, NEW, OLD, TinyMaps, VDNA

CHANGES = ["mkdir", "openat", "flock", "fcntl", "write", "fsync", "renameat", "unlinkat"]
READS = ["newfstatat", "getdents64", "lseek", "read", "close"]
FAULTS = ["signal=KILL", "error=EIO", "error=ENOSPC"]


class InterruptedBuild(TinyMaps):
    def traced(self, *options):
        """Build NEW over the map. @return exit code, standard error, trace"""
        trace = self.folder / "trace"
        done = subprocess.run(
            ["strace", "-f", "-o", trace, *options, VDNA,
             *self.build_arguments("map", NEW)],
            cwd=self.folder, text=True, capture_output=True, check=False,
            env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})  # not while traced
        return done.returncode, done.stderr, trace.read_text()

    def calls(self):
        """(name, count) of each call that the main thread makes once it has locked the map."""
        _, _, trace = self.traced("-e", "trace=" + ",".join(CHANGES + READS))
        lines = trace.splitlines()
        main = lines[0].split()[0]
        seen, calls, is_locked = {}, [], False
        for line in lines:
            call = re.match(rf"{main}\s+(\w+)\(", line)
            if not call:
                continue
            name = call[1]
            seen[name] = seen.get(name, 0) + 1
            is_locked |= name == "flock"
            if is_locked:
                calls.append((name, seen[name]))
        return calls

    def check(self, name, count, fault):
        self.restore(OLD)
        code, error, trace = self.traced("-e", f"trace={name}",
                                         "-e", f"inject={name}:{fault}:when={count}")
        self.assertTrue(re.search(r"\(INJECTED\)|killed by SIGKILL", trace), "no fault came")
        found = self.version("map")
        self.assertIn(found, (OLD, NEW))
        if code == 0:
            self.assertEqual(found, NEW)
        elif code == 1:  # ONNX Runtime ends with SIGSEGV where it cannot read /sys
            self.assertRegex(error, r"\Avdna: .+\n\Z")
        if "the map is unchanged" in error:
            self.assertEqual(found, OLD)
        self.build("map", OLD)
        self.assertEqual(self.version("map"), OLD)
        self.assertTrue(self.knows_itself("map"))
        self.assertEqual(self.files("map"), FILES)
        return found

    def test_at_any_call_leaves_the_old_map_or_the_new_one(self):
        self.restore(OLD)
        cases = [(*call, fault) for call in self.calls() for fault in FAULTS]
        # Some of each fault, because neither step is a multiple of their number.
        step = 1 if os.environ.get("VDNA_EVERY_CALL") else 10 if os.environ.get("VDNA_ALL") else 40
        cases = cases[::step]
        found = {OLD: 0, NEW: 0}
        for case in cases:
            with self.subTest(case=case):
                found[self.check(*case)] += 1
        print(f"{len(cases)} faults: {found[OLD]} left the old map, {found[NEW]} the new one")
        self.assertGreater(min(found.values()), 0)


if __name__ == "__main__":
    if not shutil.which("strace"):
        tools.skip("no strace; ./dev test --all installs it")
    unittest.main()
