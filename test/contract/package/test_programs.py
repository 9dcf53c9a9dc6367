"""The installed programs work where they were moved to, with what was installed beside them, and
the manual pages and the unit of the service fit them.
"""

import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PREFIX = Path(os.environ["VDNA_STAGE"], "prefix")
VDNA, SELECTORD = PREFIX / "bin" / "vdna", PREFIX / "sbin" / "vdna_selectord"
UNIT = ROOT / "apps" / "selectord" / "vdna_selectord.service"


def run(*command, **environment):
    """Run with nothing of ours in the environment."""
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("VDNA")}
    return subprocess.run(command, env=inherited | environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)


class TheInstalledPrograms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def succeed(self, *command, **environment):
        done = run(*command, **environment)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def test_make_a_map_and_check_it_with_the_installed_runtime_and_network(self):
        pictures, map_ = self.folder / "summer", self.folder / "map"
        self.succeed(VDNA, "simulate", pictures, "--frames", "4", "--size", "160x120")
        self.succeed(VDNA, "build", map_, pictures)
        here = self.folder / "here.toml"  # a process of the network's own would say nothing
        here.write_text("[backbone]\nprocess = false\n", encoding="ascii")
        said = self.succeed(SELECTORD, "-c", here, "--map", map_, "--check", LD_DEBUG="files")
        self.assertIn("OK: ", said)
        opened = set(re.findall(r"file=(\S*libonnxruntime\S*) \[0\];  dynamically loaded", said))
        self.assertEqual(opened, {str(PREFIX / "lib" / "vdna" / "libonnxruntime.so")})

    def test_look_for_networks_first_in_their_own_installation(self):
        said = run(VDNA, "build", self.folder / "map", self.folder, "--backbone", "none").stdout
        self.assertIn(f"looked in {PREFIX}/share/vdna/models (has efficientnet_lite0, ", said)

    def test_come_with_the_messages(self):
        for message in (ROOT / "lcmtypes").glob("*.lcm"):
            installed = PREFIX / "share" / "vdna" / "lcmtypes" / message.name
            self.assertEqual(installed.read_text(), message.read_text())


class TheManual(unittest.TestCase):
    def page(self, name):
        return (PREFIX / "share" / "man" / name).read_text().replace("\\-", "-")

    def test_tells_every_sub_command(self):
        commands = re.findall(r"^  (\w+) +\S", run(VDNA, "--help").stdout.partition(
            "Subcommands:")[2], re.M)
        self.assertGreater(len(commands), 5)
        self.assertEqual(commands, re.findall(r"^\.TP\n\.B (\w+)$", self.page("man1/vdna.1")
                                              .partition(".SH EXIT")[0], re.M))

    def test_tells_every_option_of_the_daemon(self):
        page = self.page("man8/vdna_selectord.8")
        options = set(re.findall(r"--[\w-]+", run(SELECTORD, "--help").stdout)) - {"--help"}
        self.assertGreater(len(options), 5)
        for option in options:
            self.assertIn(option, page)


@unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is missing")
class TheService(unittest.TestCase):
    def test_gives_the_daemon_little(self):
        # The unit's exposure, of 100; what remains is that it uses the network and the host's files.
        done = run("systemd-analyze", "security", "--offline=true", "--threshold=10", UNIT)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_has_a_unit_that_systemd_understands(self):
        with tempfile.TemporaryDirectory() as folder:
            unit = Path(folder, UNIT.name)
            unit.write_text(UNIT.read_text().replace("/usr/sbin/vdna_selectord", str(SELECTORD)))
            # What systemd does not understand, it prints and ignores.
            self.assertEqual(run("systemd-analyze", "verify", "--man=no", unit).stdout, "")


if __name__ == "__main__":
    unittest.main()
