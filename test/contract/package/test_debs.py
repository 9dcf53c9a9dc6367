"""The Debian packages: lintian finds no error, and they hold what their names promise.

Exit code 77 = skipped: a tool is missing.
"""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

PROGRAMS = os.environ["VDNA_PROGRAMS"] == "ON"
BACKBONE = os.environ["VDNA_BACKBONE"] == "ON"
# Made where there is a Java compiler.
TYPES_JAR = ("share/java/vdna_lcmtypes.jar",) if os.environ["VDNA_TYPES_JAR"] == "1" else ()
DEBS = sorted(Path(os.environ["VDNA_STAGE"], "debs").glob("*.deb"))

if not DEBS:
    print("skipped: no dpkg-dev, so no packages; install build-essential")
    sys.exit(77)
if not shutil.which("lintian"):
    print("skipped: no lintian; ./dev test --all installs it")
    sys.exit(77)


def output_of(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def completion_of(program):
    return (f"share/bash-completion/completions/{program}",
            f"share/zsh/vendor-completions/_{program}")


def documents_of(package):
    docs = Path(__file__).resolve().parents[3] / "docs"
    pages = [path.relative_to(docs) for folder in ("start", "operating", "reference")
             for path in sorted((docs / folder).glob("*.md"))]
    assert len(pages) > 10, pages
    return [f"share/doc/{package}/{page}" for page in pages]


def field(deb, name):
    return output_of("dpkg-deb", "--field", deb, name).strip()


class TheDebs(unittest.TestCase):
    def setUp(self):
        self.debs = {field(deb, "Package"): deb for deb in DEBS}

    def test_have_no_errors(self):
        found = subprocess.run(["lintian", "--allow-root", "--fail-on", "error", *DEBS],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(found.returncode, 0, found.stdout)

    def test_are_those_that_were_built(self):
        expected = {"libvdna0", "libvdna-dev", "vdna-dbgsym"}
        if BACKBONE:
            expected |= {"libvdna-backbone0", "libvdna-backbone-dev"}
        if PROGRAMS:
            expected |= {"vdna", "vdna-selectord", "vdna-serve", "vdna-networks"}
        self.assertEqual(set(self.debs), expected)

    def test_the_library_depends_on_what_it_links(self):
        self.assertRegex(field(self.debs["libvdna0"], "Depends"), r"libc6 .*libmd0")

    @unittest.skipUnless(BACKBONE, "needs the backbone")
    def test_the_backbone_s_library_depends_on_what_it_links_and_not_on_opencv(self):
        depends = field(self.debs["libvdna-backbone0"], "Depends")
        self.assertRegex(depends, r"libjpeg.*libmd0.*libstdc\+\+6")
        self.assertNotIn("opencv", depends)
        self.assertIn("libvdna-dev (=", field(self.debs["libvdna-backbone-dev"], "Depends"))

    def test_the_development_files_go_with_one_library(self):
        version = field(self.debs["libvdna0"], "Version")
        self.assertIn(f"libvdna0 (= {version})", field(self.debs["libvdna-dev"], "Depends"))

    def test_each_has_its_licences(self):
        for package, deb in self.debs.items():
            archive = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", deb], stdout=subprocess.PIPE)
            text = subprocess.run(["tar", "-xO", f"./usr/share/doc/{package}/copyright"],
                                  stdin=archive.stdout, stdout=subprocess.PIPE, text=True).stdout
            archive.stdout.close()
            archive.wait()
            self.assertIn("Copyright: 2026 The vdna authors", text)
            self.assertIn(" Permission is hereby granted", text)
            self.assertEqual("ML Illustrated" in text and "Microsoft" in text,
                             package == "vdna-networks")

    def test_the_development_files_bring_the_amalgamation(self):
        content = output_of("dpkg-deb", "--contents", self.debs["libvdna-dev"])
        for path in ("vdna.c", "vdna.h", "freestanding/math.h", "freestanding/string.h"):
            self.assertIn(f" ./usr/share/vdna/amalgamation/{path}\n", content)

    @unittest.skipUnless(PROGRAMS, "needs the programs")
    def test_have_what_their_names_promise(self):
        for package, paths in {
            "vdna": ("bin/vdna", "share/man/man1/vdna.1.gz", *completion_of("vdna"), *TYPES_JAR,
                     *documents_of("vdna")),
            "vdna-selectord": ("sbin/vdna_selectord", "share/man/man8/vdna_selectord.8.gz",
                               "lib/systemd/system/vdna_selectord.service",
                               "share/vdna/lcmtypes/image.lcm", *completion_of("vdna_selectord"),
                               *documents_of("vdna-selectord")),
            "vdna-serve": ("bin/vdna_serve", "share/man/man1/vdna_serve.1.gz",
                           *completion_of("vdna_serve")),
            "vdna-networks": ("lib/vdna/libonnxruntime.so",
                              "share/vdna/models/efficientnet_lite0.onnx",
                              "share/doc/vdna-networks/onnxruntime/ThirdPartyNotices.txt"),
        }.items():
            content = output_of("dpkg-deb", "--contents", self.debs[package])
            for path in paths:
                self.assertIn(f" ./usr/{path}\n", content)

    @unittest.skipUnless(PROGRAMS, "needs the programs")
    def test_the_daemon_has_commented_settings_that_an_upgrade_keeps(self):
        deb = self.debs["vdna-selectord"]
        self.assertEqual(output_of("dpkg-deb", "--info", deb, "conffiles"), "/etc/vdna/vdna.toml\n")
        archive = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", deb], stdout=subprocess.PIPE)
        text = subprocess.run(["tar", "-xO", "./etc/vdna/vdna.toml"], check=True, text=True,
                              stdin=archive.stdout, stdout=subprocess.PIPE).stdout
        archive.stdout.close()
        archive.wait()
        selectord = Path(os.environ["VDNA_STAGE"], "prefix", "sbin", "vdna_selectord")
        self.assertEqual(text, output_of(selectord, "--print-config"))

    @unittest.skipUnless(PROGRAMS, "needs the programs")
    def test_the_programs_bring_their_networks(self):
        for package in ("vdna", "vdna-selectord"):
            version = field(self.debs[package], "Version")
            self.assertIn(f"vdna-networks (= {version})", field(self.debs[package], "Depends"))

    @unittest.skipUnless(PROGRAMS, "needs the programs")
    def test_the_tool_alone_needs_opencv(self):
        needing = {package for package, deb in self.debs.items()
                   if "opencv" in output_of("dpkg-deb", "--field", deb, "Depends")}
        self.assertEqual(needing, {"vdna"})


if __name__ == "__main__":
    unittest.main()
