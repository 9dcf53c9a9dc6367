"""SIGHUP: the daemon opens its map again while the map from before serves.

Environment: VDNA_BIN (folder of the programs), VDNA_STUB_MAP and VDNA_UNRULY_BACKBONE (of
test/support/stub).
"""
import os
import random
import shutil
import signal
import subprocess
import time

import own_network
from selectord import SANITIZED, SLOWER, Frames, Selectord, Watch, WithLinkedMap, memory_of, vdna

WORK = os.path.abspath("reload")
SMALL, LARGE, OTHER = (os.path.join(WORK, name) for name in ("small", "large", "other"))
NAMES = ["spring", "winter", "autumn"]
UNRULY = os.environ["VDNA_UNRULY_BACKBONE"]
PICTURE = bytes(64 * 64)
MIB = 1 << 20


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    for path, names in ((SMALL, NAMES[:2]), (LARGE, NAMES)):
        subprocess.run([os.environ["VDNA_STUB_MAP"], path, *names], check=True)
    drive = os.path.join(WORK, "drive")
    vdna("simulate", drive, "--frames", 3)
    vdna("build", OTHER, drive)


def mapped_experiences(pid):
    """Experience files in the memory of a process."""
    with open(f"/proc/{pid}/maps", encoding="utf-8") as file:
        return len({line.split()[-1] for line in file if ".vdna" in line})


def has_place(answer):
    """One picture for ever is a place, but not a sure one."""
    return answer["validity"] in ("VALID", "UNSURE")


class Reload(WithLinkedMap):

    work = WORK
    first_map = SMALL

    def daemon(self, *options):
        if "-c" not in options:
            options += ("-c", self.configure("[map]\ncopy = false\nleave_out_damaged = false\n"))
        return Selectord("--map", self.map, "--backbone", UNRULY, "--warmup-frames", 3, *options)

    def assert_all_answered(self, watch, sent):
        status = watch.wait_for("status", lambda status: status["received"] == sent)
        skipped = status["skipped"] if SANITIZED else 0  # a slow one takes the newest frame, and says so
        self.assertEqual((status["processed"], status["refused"], status["skipped"]),
                         (sent - skipped, 0, skipped))
        self.assertEqual(len(watch.of("localisation")), sent - skipped)

    def test_takes_the_new_map_and_loses_no_frame(self):
        with Watch() as watch, self.daemon() as daemon:
            with Frames(lambda _: PICTURE) as frames:
                before = watch.wait_for("ranking")
                self.assertEqual(len(before["ranking"]), 2)
                self.use(LARGE)
                os.kill(daemon.pid, signal.SIGHUP)
                after = watch.wait_for("ranking")
                self.assertEqual(sorted(entry["experience"] for entry in after["ranking"]),
                                 sorted(NAMES))
                status = watch.wait_for("status", lambda status: status["experiences"] == 3)
                self.assertEqual(status["message"], "")
                self.assertNotEqual(before["map_hash"], after["map_hash"])
                self.assertEqual(status["map_hash"], after["map_hash"])
            self.assert_all_answered(watch, frames.sent)
        # The new map begins with a warmup, and only that.
        warming_up = [answer["validity"] == "WARMING_UP" for answer in watch.of("localisation")]
        switch = warming_up.index(True, 3)
        self.assertEqual(warming_up, [True] * 3 + [False] * (switch - 3) + [True] * 3 +
                         [False] * (len(warming_up) - switch - 3))
        self.assertTrue(any("reloaded: 3 experiences" in line for line in daemon.log), daemon.log)

    def test_a_map_that_cannot_be_used_leaves_the_one_from_before(self):
        empty, damaged = os.path.join(WORK, "empty"), os.path.join(WORK, "damaged")
        os.makedirs(empty, exist_ok=True)
        shutil.copytree(SMALL, damaged, dirs_exist_ok=True)
        with open(os.path.join(damaged, "winter.vdna"), "r+b") as file:
            file.truncate(1000)
        with Watch() as watch, self.daemon() as daemon:
            with Frames(lambda _: PICTURE) as frames:
                watch.wait_for("ranking")
                for path, words in ((empty, self.map), (damaged, "winter.vdna"),
                                    (OTHER, "does not compare with backbone"),
                                    ("/nowhere", "No such file")):
                    self.use(path)
                    os.kill(daemon.pid, signal.SIGHUP)
                    status = watch.wait_for("status", lambda status, words=words:
                                            "the old map serves" in status["message"]
                                            and words in status["message"])
                    self.assertEqual(status["experiences"], 2)
                    self.assertNotEqual(status["experience"], "")
                self.use(LARGE)
                os.kill(daemon.pid, signal.SIGHUP)
                watch.wait_for("status", lambda status: status["message"] == "" and
                               status["experiences"] == 3)
            self.assert_all_answered(watch, frames.sent)
        self.assertEqual(len(watch.of("ranking")), 2)
        self.assertTrue(any("the old map serves" in line for line in daemon.log), daemon.log)

    def test_reloads_at_random_moments_lose_nothing_and_leave_nothing(self):
        chance = random.Random(14)
        with Watch() as watch, self.daemon() as daemon:
            with Frames(lambda _: PICTURE) as frames:
                for number in range(60):
                    if number == 10:
                        early = memory_of(daemon.pid)["VmRSS"]
                    self.use(chance.choice([SMALL, LARGE, "/nowhere"]))
                    os.kill(daemon.pid, signal.SIGHUP)
                    watch.collect(chance.uniform(0, 0.15))
                files = len(os.listdir(f"/proc/{daemon.pid}/fd"))
                self.use(LARGE)
                os.kill(daemon.pid, signal.SIGHUP)
                watch.wait_for("status", lambda status: status["experiences"] == 3)
            self.assert_all_answered(watch, frames.sent)
            self.assertEqual(mapped_experiences(daemon.pid), 3)
            self.assertLessEqual(len(os.listdir(f"/proc/{daemon.pid}/fd")), files + 1)
            grown = memory_of(daemon.pid)["VmRSS"] - early
        print(f"50 reloads took {grown / MIB:.2f} MiB")
        if not SANITIZED:
            self.assertLess(grown, MIB)

    def own_map(self):
        """A copy of the small map that may be changed."""
        path = os.path.join(WORK, f"{self.id()}.own")
        shutil.copytree(SMALL, path)
        self.use(path)
        return path

    def test_a_mapped_file_changed_in_place_is_a_fault_until_the_map_is_opened_again(self):
        winter = os.path.join(self.own_map(), "winter.vdna")
        with Watch() as watch, self.daemon() as daemon:
            with Frames(lambda _: PICTURE) as frames:
                watch.wait_for("localisation", has_place)
                with open(winter, "r+b") as file:
                    good = file.read()
                    file.truncate(1000)
                fault = watch.wait_for("localisation",
                                       lambda answer: not has_place(answer))
                self.assertEqual((fault["validity"], fault["frame"]), ("FAULT", None))
                self.assertIn("winter.vdna: changed in place", fault["reason"])
                status = watch.wait_for("status", lambda status: status["state"] == "FAULT")
                self.assertEqual(status["reason"], fault["reason"])
                self.assertTrue(status["map_changed"])
                os.kill(daemon.pid, signal.SIGHUP)  # refused: the file is damaged
                status = watch.wait_for("status", lambda status: status["message"] != "" and
                                        "the old map serves" in status["message"])
                self.assertEqual(status["state"], "FAULT")
                with open(winter, "wb") as file:
                    file.write(good)
                os.kill(daemon.pid, signal.SIGHUP)
                watch.wait_for("localisation", has_place)
                status = watch.wait_for("status", lambda status: status["state"] == "UNSURE")
                self.assertFalse(status["map_changed"])
            status = watch.wait_for("status", lambda status: status["received"] == frames.sent)
        self.assertEqual(status["received"],
                         status["processed"] + status["refused"] + status["skipped"])
        self.assertGreater(status["refused"], 0)

    def test_with_copies_the_map_goes_on_and_the_status_says_that_the_directory_changed(self):
        path = self.own_map()
        copies = self.configure("[map]\ncopy = true\n")
        with Watch() as watch, self.daemon("-c", copies), Frames(lambda _: PICTURE):
            def map_changes(to):
                return watch.wait_for("status", lambda status: status["map_changed"] == to)
            map_changes(False)
            watch.wait_for("localisation", has_place)
            with open(os.path.join(path, "note"), "wb"):
                pass
            watch.collect(2)
            self.assertFalse(watch.of("status")[-1]["map_changed"])
            added = os.path.join(path, "more.vdna")
            shutil.copy(os.path.join(path, "winter.vdna"), added)
            map_changes(True)
            os.unlink(added)
            map_changes(False)
            with open(os.path.join(path, "winter.vdna"), "r+b") as file:
                file.truncate(1000)
            map_changes(True)
            watch.collect(2)
        answers = watch.of("localisation")
        self.assertTrue(all(map(has_place, answers[3:])))

    def test_an_experience_that_is_left_out_is_in_every_status(self):
        path = self.own_map()
        with open(os.path.join(path, "winter.vdna"), "r+b") as file:
            file.truncate(1000)
        with Watch() as watch, self.daemon("-c", self.configure("[map]\ncopy = false\n")):
            for _ in range(3):
                status = watch.wait_for("status")
                self.assertEqual((status["experiences"], status["left_out"]), (1, 1))
                self.assertRegex(status["message"],
                                 r"winter\.vdna: .*; left out, 1 of 2 experiences serve")
                self.assertFalse(status["map_changed"])
            with open(os.path.join(path, "winter.vdna"), "ab") as file:
                file.write(b"more")  # nothing of it is in use
            status = watch.wait_for("status", lambda status: status["map_changed"])
            self.assertEqual(status["state"], "WARMUP")

    def test_a_reload_does_not_keep_a_signal_from_ending_it(self):
        for _ in range(5):
            with self.daemon() as daemon:
                os.kill(daemon.pid, signal.SIGHUP)
                code, seconds = daemon.stop()
            self.assertEqual(code, 0)
            self.assertLess(seconds, 0.5 * SLOWER)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
