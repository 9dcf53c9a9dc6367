"""What the daemon tells systemd, here a socket of ours: READY, RELOADING, STOPPING, and WATCHDOG only
while all of it makes progress.

Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub).
"""
import contextlib
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time

import own_network
from selectord import (PATIENCE, Camera, Frames, Selectord, Watch, WithConfiguration, grey_message,
                       selectord)

WORK = os.path.abspath("service_manager")
MAP = os.path.join(WORK, "map")
UNRULY = os.environ["VDNA_UNRULY_BACKBONE"]
PICTURE = bytes(64 * 64)
BUDGET = "[backbone]\nbudget_ms = 100\n"
WITHIN = "[backbone]\nprocess = false\n"


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    subprocess.run([os.environ["VDNA_STUB_MAP"], MAP], check=True)


class Manager:
    """The socket of a service manager."""

    def __init__(self, address):
        """A path, or @ and an abstract name."""
        self.address = address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address.replace("@", "\0"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def fill(self):
        """Leave room for no message."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender, \
                contextlib.suppress(BlockingIOError):
            sender.setblocking(False)
            while True:
                sender.sendto(b"full", self.address.replace("@", "\0"))

    def next(self, seconds=PATIENCE):
        """The next message, as a dictionary; {} if there is none in this time."""
        self._socket.settimeout(seconds)
        try:
            return dict(line.split("=") for line in self._socket.recv(4096).decode().split("\n"))
        except TimeoutError:
            return {}

    def next_but_watchdog(self):
        while (message := self.next()) == {"WATCHDOG": "1"}:
            pass
        return message

    def fed(self, seconds):
        """How often the watchdog is fed in this time."""
        times, end = 0, time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            times += self.next(left) == {"WATCHDOG": "1"}
        return times


class ServiceManager(WithConfiguration):

    work = WORK

    def setUp(self):
        folder = tempfile.TemporaryDirectory()  # a short name: an address has 108 bytes
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "socket")

    def daemon(self, manager, settings=BUDGET):
        return Selectord("--map", MAP, "--backbone", UNRULY, "-c", self.configure(settings),
                         environment={"NOTIFY_SOCKET": manager.address})

    def test_hears_of_the_start_and_the_end(self):
        for address in (self.path, "@vdna/test"):
            with Manager(address) as manager, self.daemon(manager) as daemon:
                self.assertEqual(manager.next(), {"READY": "1"})
                self.assertEqual(daemon.stop()[0], 0)
                self.assertEqual(manager.next_but_watchdog(), {"STOPPING": "1"})

    def test_hears_of_each_reload_and_its_end_good_or_bad(self):
        with Manager(self.path) as manager, self.daemon(manager) as daemon:
            self.assertEqual(manager.next(), {"READY": "1"})
            for change in (lambda: None, lambda: os.rename(MAP, MAP + ".away")):
                change()
                before = time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
                os.kill(daemon.pid, signal.SIGHUP)
                begun = manager.next_but_watchdog()
                self.assertEqual(begun.pop("RELOADING"), "1")
                self.assertGreaterEqual(int(begun["MONOTONIC_USEC"]), before)
                self.assertLess(int(begun["MONOTONIC_USEC"]), before + PATIENCE * 1000000)
                self.assertEqual(manager.next_but_watchdog(), {"READY": "1"})
            os.rename(MAP + ".away", MAP)

    def test_is_fed_once_a_second_without_frames_and_with_bad_ones(self):
        with Manager(self.path) as manager, self.daemon(manager):
            manager.next()
            self.assertIn(manager.fed(3.5), (3, 4))
            with Frames(lambda _: b""):
                self.assertIn(manager.fed(3.5), (3, 4))

    def test_is_not_fed_while_the_network_answers_nothing(self):
        with Manager(self.path) as manager, Watch() as watch, self.daemon(manager):
            manager.next()
            with Frames(lambda _: b"hang\0"):
                watch.wait_for("localisation")
                manager.fed(1.2)  # the second in which the frames began
                self.assertEqual(manager.fed(3.5), 0)
            with Frames(lambda _: PICTURE):
                watch.wait_for("localisation", lambda answer: answer["validity"] != "REFUSED")
                self.assertGreaterEqual(manager.fed(3.5), 2)

    def test_is_not_fed_while_a_network_in_the_daemon_hangs(self):
        with Manager(self.path) as manager, Camera() as camera, self.daemon(manager, WITHIN):
            manager.next()
            self.assertGreaterEqual(manager.fed(2), 1)
            camera.send(grey_message(1, b"hang\0"))
            manager.fed(0.5)
            self.assertEqual(manager.fed(2.5), 0)

    def test_may_read_nothing_and_the_daemon_goes_on(self):
        with Manager(self.path) as manager, Watch() as watch:
            manager.fill()
            with self.daemon(manager):
                for _ in range(3):
                    watch.wait_for("status")

    def test_must_have_an_address_that_can_be(self):
        for address in ("socket", "@" * 109):
            result = selectord("--map", MAP, "--backbone", UNRULY, "--check",
                               environment={"NOTIFY_SOCKET": address})
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertIn("NOTIFY_SOCKET", result.stderr)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
