"""Two daemons on the same channels: one answers, the other stands by until it falls silent.

Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub).
"""
import os
import shutil
import signal
import subprocess
import time

import own_network
from selectord import Frames, Selectord, Watch, WithConfiguration

WORK = os.path.abspath("two_daemons")
MAP = os.path.join(WORK, "map")
PICTURE = bytes(64 * 64)


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    subprocess.run([os.environ["VDNA_STUB_MAP"], MAP], check=True)


class TwoDaemons(WithConfiguration):

    work = WORK

    def daemon(self, *options):
        return Selectord("--map", MAP, "--backbone", os.environ["VDNA_UNRULY_BACKBONE"],
                         "--warmup-frames", 3, *options)

    def status_of(self, watch, instance, *states):
        return watch.wait_for("status", lambda status: status["instance"] == instance and
                              status["state"] in states)

    def test_the_later_one_stands_by_and_takes_over_once_the_first_is_gone(self):
        with Watch() as watch, Frames(lambda _: PICTURE) as frames, self.daemon() as first:
            instance = watch.wait_for("status", lambda status: status["state"] == "UNSURE")["instance"]
            begun = len(watch.of("localisation"))
            with self.daemon() as second:
                other = watch.wait_for("status", lambda status: status["state"] == "STANDBY")
                self.assertNotEqual(other["instance"], instance)
                self.assertEqual((other["serving_utime"], other["experience"]), (0, ""))
                self.assertIn(f"on {other['host']} (instance {instance})", other["reason"])
                self.status_of(watch, instance, "UNSURE")
                self.status_of(watch, other["instance"], "STANDBY")
                double = {answer["utime"] for answer in watch.of("localisation")[begun:]
                          if answer["validity"] == "WARMING_UP"}
                # Until it has heard the first one.
                self.assertLessEqual(len(double), 2)

                first.stop(signal.SIGKILL)
                gone = time.monotonic()
                watch.wait_for("localisation", lambda answer: answer["validity"] == "WARMING_UP")
                took = time.monotonic() - gone
                print(f"took over after {took:.1f} s")
                self.assertTrue(1.8 < took < 4.5, took)
                status = self.status_of(watch, other["instance"], "UNSURE")
                self.assertGreater(status["serving_utime"], 0)
                sent = frames.sent
                status = watch.wait_for("status", lambda status: status["received"] >= 20)
                self.assertEqual(status["received"], status["processed"] + status["skipped"])
                self.assertGreater(status["skipped"], 15)
                code, _ = second.stop()
            self.assertEqual(code, 0)
        self.assertTrue(any("this one follows 3 s" in line for line in second.log), second.log)
        self.assertTrue(any("no other daemon" in line for line in second.log), second.log)
        answered = [answer["utime"] for answer in watch.of("localisation")]
        self.assertGreater(sent, len(set(answered)))

    def test_both_answer_if_they_are_told_to(self):
        alone = self.configure("[lcm]\nstandby = false\n")
        with Watch() as watch, self.daemon("-c", alone), self.daemon("-c", alone), \
                Frames(lambda _: PICTURE):
            watch.collect(5)
        states = {(status["instance"], status["state"]) for status in watch.of("status")[-2:]}
        self.assertEqual(len({instance for instance, _ in states}), 2)
        self.assertEqual({state for _, state in states}, {"UNSURE"})

    def test_two_that_start_together_agree(self):
        with Watch() as watch, Frames(lambda _: PICTURE):
            daemons = [subprocess.Popen(
                [os.path.join(os.environ["VDNA_BIN"], "vdna_selectord"), "--map", MAP,
                 "--backbone", os.environ["VDNA_UNRULY_BACKBONE"], "--warmup-frames", "3"],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(3)]
            try:
                watch.collect(6)
            finally:
                for daemon in daemons:
                    daemon.kill()
                    daemon.wait()
        newest = {status["instance"]: status["state"] for status in watch.of("status")}
        self.assertEqual(sorted(newest.values()), ["STANDBY", "STANDBY", "UNSURE"])


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
