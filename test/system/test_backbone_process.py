"""The daemon beside a network in a process of its own that hangs, crashes, asks for all memory, or is
killed: every frame is answered, statuses come once a second, and nothing outlives the daemon.

Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub), VDNA_SHARED (hostile networks; tests that need them are skipped without).
"""
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

import own_network
from selectord import (SANITIZED, SLOWER, Camera, Frames, Selectord, Watch, WithConfiguration, grey_message,
                       network_process, selectord, vdna)

WORK = os.path.abspath("backbone_process")
STUB_MAP = os.path.join(WORK, "stub")
UNRULY = os.environ["VDNA_UNRULY_BACKBONE"]
NETS = os.path.join(os.environ["VDNA_SHARED"], "cases", "hostile", "nets")
BUDGET = 0.3  # seconds
SETTINGS = "[camera]\nhealth = false\n" \
    f"[backbone]\nbudget_ms = {BUDGET * 1000:.0f}\n"
DARK, BRIGHT = bytes(64 * 64), b"\xff" * (64 * 64)


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    subprocess.run([os.environ["VDNA_STUB_MAP"], STUB_MAP], check=True)
    if os.path.isdir(NETS):
        drive = os.path.join(WORK, "summer")
        vdna("simulate", drive, "--frames", 5)
        for name in ("hang", "mem"):
            vdna("build", map_of(name), drive, "--backbone", network(name))


def network(name):
    return os.path.join(NETS, f"{name}.toml")


def map_of(name):
    return os.path.join(WORK, f"map_{name}")


def is_alive(pid):
    """Not even a zombie."""
    return os.path.exists(f"/proc/{pid}")


class BackboneProcess(WithConfiguration):

    work = WORK

    def daemon(self, *options, settings=SETTINGS, **arguments):
        return Selectord(*options, "-c", self.configure(settings), **arguments)

    def stub_daemon(self, **arguments):
        return self.daemon("--map", STUB_MAP, "--backbone", UNRULY, **arguments)

    def assert_beats(self, statuses, seconds):
        """A status each second, though one may wait for a picture's budget."""
        times = [status["utime"] / 1e6 for status in statuses]
        self.assertGreaterEqual(len(times), seconds - 1)
        self.assertLess(max(b - a for a, b in zip(times, times[1:])), 1 + BUDGET + 0.2)

    def assert_all_told(self, watch, sent):
        status = watch.wait_for("status", lambda status: status["received"] == sent)
        self.assertEqual(status["received"],
                         status["processed"] + status["refused"] + status["skipped"])
        self.assertEqual(len(watch.of("localisation")), status["processed"] + status["refused"])
        return status

    def test_a_network_that_hangs_is_ended_and_all_other_frames_are_answered(self):
        if not os.path.isdir(NETS):
            self.skipTest(f"no {NETS}")
        seconds, every = 8, 30  # frames: one bright picture in three seconds
        with Watch() as watch, self.daemon("--map", map_of("hang"), "--backbone", network("hang"),
                                           "--warmup-frames", 5) as daemon:
            first = network_process(daemon.pid)
            with Frames(lambda n: BRIGHT if n % every == 5 else DARK) as frames:
                watch.collect(seconds)
            self.assert_all_told(watch, frames.sent)
            self.assertNotEqual(network_process(daemon.pid), first)
            self.assertFalse(is_alive(first))
        self.assert_beats(watch.of("status"), seconds)
        self.assertTrue(any("no answer within 600 ms" in status["message"]
                            for status in watch.of("status")))
        answers = {answer["utime"] // 100000: answer["validity"]
                   for answer in watch.of("localisation")}
        self.assertEqual(answers[5], "REFUSED")
        # The picture, twice the budget, and what opening takes.
        for number in range(25, 30):
            self.assertNotEqual(answers[number], "REFUSED")

    @unittest.skipIf(SANITIZED, "a sanitizer ends what asks for so much")
    def test_a_network_that_asks_for_all_memory_is_refused_it(self):
        if not os.path.isdir(NETS):
            self.skipTest(f"no {NETS}")
        with Watch() as watch, Camera() as camera, \
                self.daemon("--map", map_of("mem"), "--backbone", network("mem")) as daemon:
            before = network_process(daemon.pid)
            validities = []
            for utime, picture in enumerate([DARK, BRIGHT, DARK]):
                camera.send(grey_message(utime, picture))
                validities.append(watch.wait_for("localisation")["validity"])
            self.assertEqual(validities, ["WARMING_UP", "REFUSED", "WARMING_UP"])
            self.assertEqual(network_process(daemon.pid), before)

    def test_the_daemon_outlives_kills_and_stops_at_random_moments(self):
        chance = random.Random(14)
        with Watch() as watch, self.stub_daemon() as daemon:
            with Frames(lambda n: DARK) as frames:
                end = time.monotonic() + (20 if SANITIZED else 5)
                while time.monotonic() < end:
                    watch.collect(chance.uniform(0, 0.3 * SLOWER))
                    process = network_process(daemon.pid)
                    if process:
                        os.kill(process, chance.choice([signal.SIGKILL, signal.SIGSTOP]))
                # A process that was stopped while it opened its network has five seconds.
                watch.wait_for("localisation", lambda answer: answer["validity"] != "REFUSED")
            status = self.assert_all_told(watch, frames.sent)
            self.assertTrue(daemon.is_running())
        self.assertGreater(status["refused"], 5)
        self.assertGreater(status["processed"], 5)
        self.assert_beats(watch.of("status"), 5)

    @unittest.skipIf(SANITIZED, "a sanitizer makes an exit of a crash")
    def test_a_crash_is_told_with_its_frame(self):
        with Watch() as watch, Camera() as camera, self.stub_daemon():
            camera.send(grey_message(1, b"crash\0"))
            self.assertEqual(watch.wait_for("localisation")["validity"], "REFUSED")
            status = watch.wait_for("status", lambda status: status["refused"] == 1)
            self.assertIn("started again after it was ended by signal 11", status["message"])

    def test_the_process_ends_with_the_daemon(self):
        with self.stub_daemon() as daemon:
            process = network_process(daemon.pid)
            self.assertEqual(daemon.stop()[0], 0)
            self.assertFalse(is_alive(process))
        # Killed, while its network hangs.
        with Camera() as camera, self.stub_daemon() as daemon:
            process = network_process(daemon.pid)
            camera.send(grey_message(1, b"hang\0"))
            time.sleep(BUDGET / 2)
            daemon.stop(signal.SIGKILL)
            # Whoever inherits it reaps it, sooner or later.
            deadline = time.monotonic() + 1
            while state_of(process) not in (None, "Z"):
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.01)

    def test_a_signal_during_a_hang_ends_both_at_once(self):
        with Camera() as camera, self.stub_daemon() as daemon:
            process = network_process(daemon.pid)
            camera.send(grey_message(1, b"hang\0"))
            time.sleep(BUDGET / 2)
            code, seconds = daemon.stop()
            self.assertEqual(code, 0)
            self.assertLess(seconds, BUDGET / 2 * SLOWER)
            if SANITIZED:  # the end of so much memory takes a moment
                time.sleep(1)
            self.assertFalse(is_alive(process))

    def test_in_the_process_of_the_daemon_there_is_no_other(self):
        with Watch() as watch, Camera() as camera, \
                self.stub_daemon(settings="[backbone]\nprocess = false\n") as daemon:
            self.assertIsNone(network_process(daemon.pid))
            camera.send(grey_message(1, DARK))
            self.assertEqual(watch.wait_for("localisation")["validity"], "WARMING_UP")

    @unittest.skipIf(SANITIZED, "a sanitizer makes an exit of a crash")
    def test_a_network_that_cannot_be_opened_is_one_clear_error(self):
        for what, words in (({"VDNA_UNRULY_OPEN": "crash"}, "ended by signal 11"),
                            ({}, "No such file")):
            manifest = UNRULY if what else "/nowhere/mine.so"
            result = selectord("--map", STUB_MAP, "--backbone", manifest, "--check",
                               environment=what)
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertIn(words, result.stderr)


def state_of(pid):
    """R, S, Z ...; None if there is no such process."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return None


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
