"""`vdna_selectord --print-memory` states the memory that the process takes; also the memory budget,
the lock and the limits on pictures.
"""
import glob
import json
import os
import resource
import shutil
import subprocess
import time

import own_network
from selectord import (BIN, PATIENCE, Camera, Listener, Selectord, Watch, WithConfiguration,
                       answer_of, memory_of, network_process, selectord, vdna, vdna_json)

WORK = os.path.abspath("statement")
MAP = os.path.join(WORK, "map")
LARGE, TOO_LARGE = os.path.join(WORK, "large.jpg"), os.path.join(WORK, "too_large.jpg")
WIDTH, HEIGHT = 2048, 1024
LIMITS = f"[camera]\nhealth = false\n[lcm]\nmax_image_bytes = 65000\nmax_image_pixels = {WIDTH * HEIGHT}\n"
MIB = 1 << 20


def prepare():
    if os.path.exists(TOO_LARGE):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    drives = [os.path.join(WORK, name) for name in ("summer", "again", "once_more")]
    vdna("simulate", drives[0], "--condition", "summer", "--frames", 10)
    for copy in drives[1:]:
        shutil.copytree(drives[0], copy)
    vdna("build", MAP, *drives)
    for height, path in ((HEIGHT, LARGE), (HEIGHT + 1, TOO_LARGE)):
        subprocess.run([os.environ["VDNA_LARGE_JPEG"], str(WIDTH), str(height), path], check=True)


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Statement(WithConfiguration):

    work = WORK

    def state(self, text):
        """The statement for a configuration, as JSON."""
        result = selectord("--map", MAP, "-c", self.configure(text), "--print-memory", "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return json.loads(result.stdout)

    def test_the_parts_add_up_and_the_table_shows_them(self):
        stated = self.state(LIMITS)
        parts = stated["parts"]
        self.assertEqual(stated["resident_bytes_max"], sum(part["bytes"] for part in parts))
        self.assertEqual(stated["held_bytes_max"],
                         sum(part["bytes"] for part in parts if not part["evictable"]))
        self.assertEqual([part["part"] for part in parts if part["evictable"]], [])
        experiences = vdna_json("info", MAP)["experiences"]
        self.assertTrue(all(e["thumbnail_bytes"] > 10000 for e in experiences), experiences)
        self.assertIn(sum(e["bytes"] - e["thumbnail_bytes"] - 4 for e in experiences),  # nor the checksum behind
                      [part["bytes"] for part in parts if part["part"] == "map"])
        table = selectord("--map", MAP, "-c", self.configure(LIMITS), "--print-memory").stdout
        for part in parts:
            self.assertIn(part["what"], table)
            if not part["measured"]:
                self.assertIn(f" {part['bytes']} ", table)

    def test_a_map_that_is_not_copied_is_evictable(self):
        copied, mapped = (self.state(LIMITS + f"[map]\ncopy = {copy}\n")
                          for copy in ("true", "false"))
        parts = [part for part in mapped["parts"] if part["evictable"]]
        self.assertEqual([part["part"] for part in parts], ["map"])
        self.assertEqual(mapped["resident_bytes_max"] - mapped["held_bytes_max"],
                         parts[0]["bytes"])
        self.assertEqual(copied["held_bytes_max"], copied["resident_bytes_max"])

    def test_loading_the_network_takes_little_more_than_it_then_holds(self):
        stated = self.state(LIMITS)
        stays = sum(part["bytes"] for part in stated["parts"]
                    if part["part"] in ("program", "map", "backbone"))
        passing = stated["resident_bytes_so_far"] - stays
        print(f"loading took {passing / MIB:.1f} MiB beyond what stays")
        self.assertLess(passing, 10 * MIB)  # the default network's file has 12.8

    def test_the_process_stays_within_the_statement_and_comes_near_it(self):
        stated = self.state(LIMITS)
        picture = read(LARGE)
        self.assertLess(len(picture), 65000)
        with Listener("VDNA_LOCALISATION") as answers, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 3, "-c",
                          self.configure(LIMITS)) as daemon:
            camera.send_jpeg(0, picture)
            answers.next()
            # More than the receive buffer keeps, while the daemon decodes; each as large as possible.
            padded = picture + b"\0" * (65000 - len(picture))
            for utime in range(1, 60):
                camera.send_jpeg(utime, padded if utime % 2 else picture)
                time.sleep(0.001)
            # A full buffer drops the newest message: not this one.
            time.sleep(1)
            camera.send_jpeg(60, picture)
            # A slow machine's queue may be full at that moment; then older frames are answered first.
            while answer_of(answers.next())[0] != 60:
                camera.send_jpeg(60, picture)
            most = sum(memory_of(pid)["VmHWM"]
                       for pid in (daemon.pid, network_process(daemon.pid)))
        print(f"stated {stated['resident_bytes_max'] / MIB:.1f} MiB, was {most / MIB:.1f} MiB")
        self.assertLessEqual(most, stated["resident_bytes_max"])
        self.assertGreater(most, stated["resident_bytes_max"] / 2)

    def test_decoding_takes_most_of_what_is_stated_for_it_and_no_more(self):
        stated, = [part["bytes"] for part in self.state(LIMITS)["parts"]
                   if part["what"].startswith("decoding")]
        with Listener("VDNA_LOCALISATION") as answers, Camera() as camera, \
                Selectord("--map", MAP, "-c", self.configure(LIMITS)) as daemon:
            def answer(utime, path):
                camera.send_jpeg(utime, read(path))
                answers.next()
            answer(1, sorted(glob.glob(os.path.join(WORK, "summer", "*.jpg")))[0])
            decoder = network_process(daemon.pid)
            before = memory_of(decoder)["VmRSS"]
            with open(f"/proc/{decoder}/clear_refs", "w", encoding="ascii") as file:
                file.write("5")  # resets the peak; that of loading was higher
            answer(2, LARGE)
            taken = memory_of(decoder)["VmHWM"] - before
        print(f"decoding: stated {stated / MIB:.1f} MiB, took {taken / MIB:.1f} MiB")
        self.assertLessEqual(taken, stated)
        self.assertGreater(taken, stated / 2)

    def test_a_picture_with_too_many_pixels_is_refused_before_it_is_decoded(self):
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "-c", self.configure(LIMITS)):
            camera.send_jpeg(1, read(LARGE))
            self.assertEqual(watch.wait_for("localisation")["validity"], "WARMING_UP")
            camera.send_jpeg(2, read(TOO_LARGE))
            self.assertEqual(watch.wait_for("localisation")["validity"], "REFUSED")
            status = watch.wait_for("status", lambda status: status["refused"] == 1)
            self.assertIn(f"{WIDTH}x{HEIGHT + 1}", status["message"])
            self.assertIn(str(WIDTH * HEIGHT), status["message"])

    def test_a_budget_that_is_too_small_is_one_clear_error_before_ready(self):
        held = self.state(LIMITS)["held_bytes_max"]
        text = LIMITS + f"[memory]\nbudget_mb = {held // MIB - 20}\n"
        for option in ([], ["--check"]):
            result = selectord("--map", MAP, "-c", self.configure(text), *option)
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr.count("\n"), 1)
            for word in ("memory.budget_mb", str(held // MIB - 20), "backbone", "frames", "lcm",
                         "core", "program", "max_image_bytes", "map.copy"):
                self.assertIn(word, result.stderr)
        text = LIMITS + f"[memory]\nbudget_mb = {held // MIB + 20}\n"
        self.assertEqual(
            selectord("--map", MAP, "-c", self.configure(text), "--check").returncode, 0)

    def test_a_map_larger_than_what_is_left_runs_and_says_so(self):
        mapped = LIMITS + "[map]\ncopy = false\n"
        held = self.state(mapped)["held_bytes_max"]
        # The map has 15 MiB; measurements differ by some 2 MiB from run to run.
        text = mapped + f"[memory]\nbudget_mb = {held // MIB + 6}\n"
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "-c", self.configure(text)) as daemon:
            camera.send_jpeg(1, read(LARGE))
            watch.wait_for("localisation")
        self.assertTrue(any("read from the disk" in line for line in daemon.log), daemon.log)
        with Selectord("--map", MAP, "-c", self.configure(mapped)) as daemon:
            pass
        self.assertFalse(any("read from the disk" in line for line in daemon.log), daemon.log)

    def test_a_lock_that_is_not_permitted_is_an_error_that_says_what_to_do(self):
        path = self.configure(LIMITS + "[memory]\nlock = true\n")
        command = [os.path.join(BIN, "vdna_selectord"), "--map", MAP, "-c", path]

        def forbid():
            resource.setrlimit(resource.RLIMIT_MEMLOCK, (65536, 65536))
        # Within this namespace root has no power over locks.
        refused = subprocess.run(command, preexec_fn=forbid, capture_output=True, text=True,
                                 timeout=PATIENCE)
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        for word in ("memory.lock", "LimitMEMLOCK", "ulimit -l"):
            self.assertIn(word, refused.stderr)

    def test_what_is_locked_counts_with_the_map(self):
        locked = self.state(LIMITS + "[memory]\nlock = true\n")
        self.assertEqual(locked["held_bytes_max"], locked["resident_bytes_max"])


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
