"""The installed service under a real systemd, process 1 of a bare Debian 12: start, reload, watchdog,
restart after a crash, no restart with wrong settings.

Environment: as of test_bare_debian. Exit code 77 = skipped: root, a tool, the network or what systemd
needs of the kernel is missing.
"""

import os
import re
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from test_bare_debian import BARE, DEBS, HERE, OURS, VDNA, bare_debian, make_bare_debian, skip

UNIT = "vdna_selectord.service"
SETTINGS = "/etc/vdna/vdna.toml"


class ADebian:
    """Of a folder, with systemd as its process 1."""

    def __init__(self, root):
        self.root = root
        self._log = open(root.with_name("boot.log"), "w+", encoding="utf-8")
        self._boot = subprocess.Popen([HERE / "bare_debian.sh", "boot", root], stdout=self._log,
                                      stderr=subprocess.STDOUT)
        self._init = None

    def _descendants(self, pid):
        with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as children:
            for child in children.read().split():
                yield child
                yield from self._descendants(child)

    def wait_until_booted(self, seconds=60):
        """False, with what it says, if it does not boot."""
        end, state = time.monotonic() + seconds, ""
        while time.monotonic() < end and self._boot.poll() is None:
            time.sleep(0.5)
            for pid in self._descendants(self._boot.pid):
                command = Path(f"/proc/{pid}/cmdline").read_bytes()
                if command.startswith(b"/lib/systemd/systemd\0"):
                    self._init = pid
                    break
            if self._init:
                state = self.run("systemctl", "is-system-running").stdout.strip()
                if state in ("running", "degraded"):
                    return True, state
        self._log.seek(0)
        return False, f"{state}; {self._log.read()}"

    def run(self, *command):
        return subprocess.run(["nsenter", "--target", self._init, "--mount", "--pid", "--uts", "--ipc",
                               "--net", "--cgroup", "--root", "--wd=/", "env", "-i",
                               "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL=C.UTF-8", *command],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def end(self):
        self._boot.terminate()
        self._boot.wait()
        self._log.close()


class TheService(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(dir=BARE.parent)
        cls.addClassCleanup(folder.cleanup)
        root = Path(folder.name, "root")
        subprocess.run(["cp", "--archive", BARE, root], check=True)
        debs = [next(DEBS.glob(f"{name}_*.deb")) for name in OURS]
        for deb in debs:
            shutil.copy(deb, root / "root")
        for command in (("update",), ("install", "--yes", "--no-install-recommends", "systemd",
                                      "systemd-sysv", *[f"./{deb.name}" for deb in debs])):
            done = bare_debian("run", root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-o",
                               "APT::Update::Error-Mode=any", *command)
            if done.returncode:
                skip(f"network; apt-get says: {done.stdout}")
        pictures = root / "srv" / "summer"
        for command in (("simulate", pictures, "--frames", "4", "--size", "160x120"),
                        ("build", root / "var" / "lib" / "vdna" / "map", pictures)):
            subprocess.run([VDNA, *command], check=True, stdout=subprocess.DEVNULL)
        # Sooner than in the unit, so that the test is.
        faster = root / "etc" / "systemd" / "system" / f"{UNIT}.d" / "faster.conf"
        faster.parent.mkdir(parents=True)
        faster.write_text("[Service]\nWatchdogSec=5\n")

        cls.system = ADebian(root)
        cls.addClassCleanup(cls.system.end)
        booted, said = cls.system.wait_until_booted()
        if not booted:
            cls.doClassCleanups()
            skip(f"systemd as process 1: {said}")

    def setUp(self):
        self.system.run("systemctl", "stop", UNIT)
        self.system.run("systemctl", "reset-failed", UNIT)
        self.assertEqual(self.system.run("systemctl", "start", UNIT).stdout, "", self.journal())
        self.began = self.shown("NRestarts")

    def systemctl(self, *command):
        done = self.system.run("systemctl", *command)
        self.assertEqual(done.returncode, 0, done.stdout + self.journal())
        return done.stdout.strip()

    def shown(self, name):
        return self.systemctl("show", UNIT, "--value", "--property", name)

    def journal(self):
        return self.system.run("journalctl", "--no-pager", "--unit", UNIT).stdout

    def wait_for(self, **expected):
        """Properties of the unit, regular expressions."""
        end = time.monotonic() + 60
        while True:
            found = {name: self.shown(name) for name in expected}
            if all(re.fullmatch(expected[name], found[name]) for name in expected):
                return
            self.assertLess(time.monotonic(), end, f"{found}, expected {expected}\n{self.journal()}")
            time.sleep(0.2)

    def test_is_ready_once_the_daemon_listens_and_serves_the_map_of_its_own_folder(self):
        self.assertEqual(self.shown("ActiveState"), "active")
        self.assertIn("READY map=/var/lib/vdna/map experiences=1", self.journal())
        self.assertEqual(os.readlink(self.system.root / "var/lib/vdna"), "private/vdna")
        self.assertNotEqual((self.system.root / "var/lib/private/vdna").stat().st_uid, 0)
        self.assertEqual(self.system.run("systemctl", "is-enabled", UNIT).stdout, "disabled\n")

    def test_reloads_and_ends_at_a_stop(self):
        pid = self.shown("MainPID")
        self.systemctl("reload", UNIT)
        self.wait_for(ActiveState="active", MainPID=pid)
        self.systemctl("stop", UNIT)
        self.assertEqual((self.shown("Result"), self.shown("ExecMainStatus")), ("success", "0"))

    def test_is_started_again_after_a_crash(self):
        pid = self.shown("MainPID")
        self.systemctl("kill", "--kill-whom=main", "--signal=KILL", UNIT)
        self.wait_for(NRestarts="1", ActiveState="active", MainPID=f"(?!{pid}$)[1-9].*")

    def test_is_started_again_when_it_hangs(self):
        pid = self.shown("MainPID")
        self.systemctl("kill", "--kill-whom=main", "--signal=STOP", UNIT)
        self.wait_for(NRestarts="1", ActiveState="active", MainPID=f"(?!{pid}$)[1-9].*")
        self.assertIn("Watchdog timeout", self.journal())

    def test_is_not_started_again_with_wrong_settings(self):
        settings = self.system.root / SETTINGS[1:]
        text = settings.read_text()
        self.addCleanup(settings.write_text, text)
        settings.write_text(text.replace("threads =", "treads ="))
        self.assertNotEqual(self.system.run("systemctl", "restart", UNIT).returncode, 0)
        time.sleep(5)  # RestartSec=2
        self.assertEqual((self.shown("ActiveState"), self.shown("ExecMainStatus"),
                          self.shown("NRestarts")), ("failed", "2", "0"))
        self.assertIn("unknown key 'treads'", self.journal())

    def test_is_started_again_and_again_until_its_map_is_there(self):
        map_ = self.system.root / "var/lib/private/vdna/map"
        away = map_.with_name("away")
        map_.rename(away)
        self.system.run("systemctl", "restart", UNIT)
        self.wait_for(NRestarts="[6-9]")  # systemd's own limit is five
        away.rename(map_)
        self.wait_for(ActiveState="active")


if __name__ == "__main__":
    if os.geteuid() != 0:
        skip("root; only root can make and enter a new root")
    for tool in ("debootstrap", "nsenter", "ip"):
        if not shutil.which(tool):
            skip(f"{tool}; ./dev test --all installs it")
    if not any(DEBS.glob("*.deb")):
        skip("dpkg-dev, so no packages; install build-essential")
    make_bare_debian()
    unittest.main()
