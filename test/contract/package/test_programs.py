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
from unittest import mock

from shells import Zsh, bash_completes

ROOT = Path(__file__).resolve().parents[3]
PREFIX = Path(os.environ["VDNA_STAGE"], "prefix")
VDNA, SELECTORD = PREFIX / "bin" / "vdna", PREFIX / "sbin" / "vdna_selectord"
COMPLETION = PREFIX / "share" / "bash-completion" / "completions"
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


def names_in(heading):
    """The names of options in the heading of a help's or a page's entry."""
    return set(re.findall(r"(?<![\w-])--?[\w-]+", heading))


def options_and_commands(text):
    """Of a help: the names of its options, and its sub-commands."""
    def headings(title):
        part = re.search(rf"^{title}:\n((?:  .*\n)+)", text, re.M)
        return re.findall(r"^  (\S.*?)(?:  |$)", part[1], re.M) if part else []
    options = set().union(*(names_in(heading) for heading in headings("Options")))
    return options, [heading.split()[0] for heading in headings("Commands")]


def helps(*command):
    """(words, names of options) of a program and its sub-commands, as their help tells them."""
    text = run(*command, "--help", COLUMNS="80").stdout
    options, commands = options_and_commands(text)
    yield (Path(command[0]).name, *command[1:]), options
    for sub in commands:
        yield from helps(*command, sub)


class TheManual(unittest.TestCase):
    """Help, manual pages and completion know the same options: those of the command line."""

    PROGRAMS = ((VDNA, "man1/vdna.1"), (PREFIX / "bin" / "vdna_serve", "man1/vdna_serve.1"),
                (SELECTORD, "man8/vdna_selectord.8"))

    def page(self, name):
        return PREFIX / "share" / "man" / name

    def sections(self, name):
        """Words of a command, or () for the program -> names of its options, by the manual page."""
        text = self.page(name).read_text().replace("\\-", "-")
        sections, command = {}, None
        for title, kind, entry in re.findall(
                r"^\.(?:(?:SH (OPTIONS|\w.*))|SS (.*)|TP\n(.*))$", text, re.M):
            if title or kind:
                command = () if title == "OPTIONS" else tuple(kind.split(" [")[0].split()) or None
                sections.setdefault(command, set())
            elif command is not None:
                sections[command] |= names_in(re.sub(r"\\fI.*?\\fR|\\f.", " ", entry))
        sections.pop(None, None)
        return sections

    def test_tells_every_option_of_every_command(self):
        for program, name in self.PROGRAMS:
            told = self.sections(name)
            known = dict(helps(program))
            root, *_ = known
            expected = {words if len(words) > 1 else (): options for words, options in known.items()
                        if not any(other[:len(words)] == words != other for other in known)
                        or words == root}
            self.assertEqual(told, expected, name)

    def test_completion_tells_every_option_and_command(self):
        for program, _ in self.PROGRAMS:
            file = COMPLETION / program.name
            for words, options in helps(program):
                line = " ".join(words)
                self.assertEqual(bash_completes(file, line + " -"), options, line)
            zsh = (PREFIX / "share/zsh/site-functions" / f"_{program.name}").read_text()
            functions = dict(re.findall(r"^(_\w+)\(\)\n\{\n(.*?)\n\}$", zsh, re.M | re.S))
            for words, options in helps(program):
                body = functions["_" + "_".join(words)]
                found = set(re.findall(r"^ +'(?:\*|\(.*?\))(--?[\w-]+)", body, re.M))
                self.assertEqual(found, options, words)
        _, commands = options_and_commands(run(VDNA, "--help").stdout)
        self.assertGreater(len(commands), 10)
        self.assertEqual(bash_completes(COMPLETION / "vdna", "vdna "), set(commands))

    def test_is_roff_without_a_warning(self):
        if not shutil.which("man"):
            self.skipTest("man is missing")
        for _, name in self.PROGRAMS:
            done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", self.page(name)],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                  env={**os.environ, "MANWIDTH": "80", "MANROFFSEQ": ""})
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            self.assertIn("OPTIONS", done.stdout)


class Completion(unittest.TestCase):
    """A few lines, in real shells."""

    LINES = (("vdna bui", "vdna build"),
             ("vdna model ch", "vdna model check"),
             ("vdna command res", "vdna command reset"),
             ("vdna simulate out --cond", "vdna simulate out --condition"),
             ("vdna simulate out --condition wint", "vdna simulate out --condition winter"),
             ("vdna build --backbone mobilenet_v2_p", "vdna build --backbone mobilenet_v2_paper"),
             ("vdna model check mobilenet_v2_p", "vdna model check mobilenet_v2_paper"),
             ("vdna build park pictures/win", "vdna build park pictures/winter/"),
             ("vdna serve --por", "vdna serve --port"),
             ("vdna_selectord -c robot", "vdna_selectord -c robot.toml"),
             ("vdna_serve --addr", "vdna_serve --address"))

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "pictures" / "winter").mkdir(parents=True)
        (self.folder / "robot.toml").write_text("")
        path = mock.patch.dict(os.environ, {
            "PATH": f"{PREFIX}/bin:{PREFIX}/sbin:{os.environ['PATH']}"})
        path.start()
        self.addCleanup(path.stop)

    def test_of_bash(self):
        for line, whole in self.LINES:
            file = COMPLETION / line.split()[0]
            offered = bash_completes(file, line, self.folder)
            last = whole.split()[-1].rstrip("/")  # bash itself adds the slash of a folder
            self.assertEqual(offered, {last}, line)
        self.assertEqual(bash_completes(COMPLETION / "vdna", "vdna build --range-rule=z"), {"zero"})
        self.assertEqual(bash_completes(COMPLETION / "vdna", "vdna build --range-rule="),
                         {"zero", "midpoint"})

    @unittest.skipUnless(shutil.which("zsh"), "zsh is missing")
    def test_of_zsh(self):
        zsh = Zsh(PREFIX / "share/zsh/site-functions", os.environ["PATH"], self.folder)
        self.addCleanup(zsh.close)
        for line, whole in self.LINES:
            self.assertEqual(zsh.completes(line).rstrip(" =/"), whole.rstrip("/"), line)


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
