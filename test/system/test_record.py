"""`vdna record`: an experience from the running camera. What it writes is compared with what `vdna build`
makes of the same drive from a log.

Environment: VDNA_BIN (folder of the programs).
"""
import contextlib
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
import unittest

import own_network
from ends_with_us import ENDS_WITH_US
from selectord import (BIN, PATIENCE, SANITIZED, Camera, Selectord, Watch, grey_message, image_message,
                       jpegs_in, lcm_log, memory_of, vdna, vdna_json)
from test_cli import Experience

WORK = os.path.abspath("record")
FRAMES, RATE = 24, 10
START = 1714557600000000  # microseconds
LABELLED, BARE, DRIVE = (os.path.join(WORK, name) for name in ("labelled", "bare", "drive"))
LOGS = {kind: os.path.join(WORK, f"{kind}.lcm") for kind in ("POSE", "GPS")}
# These tell where an experience is from; all else is the same.
OWN_METADATA = {"order", "source"}


def utime_of(frame):
    return START + frame * 1000000 // RATE


def pose_message(utime, x, y, z=0.0):
    """A bot_core.pose_t."""
    return struct.pack(">Qq16d", 0x2E16EFB052B0105E, utime, x, y, z, *[0.0] * 13)


def gps_message(utime, lat, lon, lock=1):
    """A bot_core.gps_data_t."""
    return struct.pack(">Qqi5di6d", 0xD7D20E1E68A41516, utime, lock, lon, lat, 60.0, 1.0, 1.0, 9,
                       *[0.0] * 6)


def positions(kind):
    """Messages at five a second, between the frames, from before the first to after the last; of the
    GPS, one leaps away."""
    messages = []
    for i in range(FRAMES // 2 + 2):
        utime = utime_of(2 * i) - 130000
        if kind == "POSE":
            messages.append(pose_message(utime, 2.0 * i, 0.3 * i * i))
        else:
            messages.append(gps_message(utime, 51.75 + 2e-5 * i + (i == 5), -1.26 + 1e-5 * i))
    return messages


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    size = ("--frames", FRAMES, "--size", "96x64", "--step", 1, "--rate", RATE)
    vdna("simulate", os.path.join(WORK, "summer"), *size)
    vdna("build", LABELLED, os.path.join(WORK, "summer"))
    os.unlink(os.path.join(WORK, "summer", "labels.csv"))
    vdna("build", BARE, os.path.join(WORK, "summer"))
    vdna("simulate", DRIVE, *size, "--condition", "winter", "--drive", 2)
    pictures = jpegs_in(DRIVE)
    for kind, path in LOGS.items():
        events = [("CAMERA", image_message(utime_of(i), picture))
                  for i, picture in enumerate(pictures)]
        events[12:12] = [(kind, message) for message in positions(kind)]
        lcm_log(path, events)


class Recording:
    """A running `vdna record`; the constructor returns once it listens."""

    def __init__(self, *arguments, file_size=None):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, resource.RLIM_INFINITY))
        self.process = subprocess.Popen(
            [*ENDS_WITH_US, os.path.join(BIN, "vdna"), "record", *map(str, arguments)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            preexec_fn=limit if file_size else None)
        self.announced = self.process.stderr.readline()
        if "listening" not in self.announced:
            self.process.kill()
            raise AssertionError(self.announced + self.process.communicate()[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def end(self, number=None):
        """What it printed, after a signal or by itself."""
        if number:
            self.process.send_signal(number)
        output, errors = self.process.communicate(timeout=PATIENCE)
        if self.process.returncode != 0:
            raise AssertionError(f"exit {self.process.returncode}: {errors}")
        return output + errors


class Records(unittest.TestCase):
    def map_of(self, path):
        copy = os.path.join(WORK, f"{self.id()}.map")
        shutil.copytree(path, copy)
        return copy

    def refused(self, *arguments, code=1):
        done = vdna("record", *arguments, check=False)
        self.assertEqual(done.returncode, code, done)
        return done.stderr

    def assert_as_built(self, recorded, *build):
        """All of the experience is what vdna build makes of the drive."""
        other = recorded + ".built"
        shutil.copytree(recorded, other, ignore=shutil.ignore_patterns("live.vdna", "trust*"))
        vdna("build", other, "--name", "live", *build)
        found, expected = (Experience(os.path.join(folder, "live.vdna"))
                           for folder in (recorded, other))
        self.assertEqual(found.tensors.keys(), expected.tensors.keys())
        for name, numbers in expected.tensors.items():
            if name != "crc32c":
                self.assertEqual(struct.pack(f"{len(numbers)}d", *found.tensors[name]),
                                 struct.pack(f"{len(numbers)}d", *numbers), name)
        for key in expected.metadata.keys() - OWN_METADATA:
            self.assertEqual(found.metadata[key], expected.metadata[key], key)
        self.assertEqual((found.metadata["order"], found.metadata["source"]),
                         ("utime", "live CAMERA"))


class Equality(Records):
    def record_log(self, kind, path):
        folder = self.map_of(path)
        report = vdna_json("record", folder, "live", "-l", f"file://{LOGS[kind]}?speed=0",
                           "--pose-channel", kind)
        self.assertEqual((report["frames"], report["end"]), (FRAMES, "the log has ended"))
        self.assert_as_built(folder, LOGS[kind], "--pose-channel", kind)
        return report

    def test_poses_and_pictures_become_what_build_makes_of_them(self):
        report = self.record_log("POSE", LABELLED)
        self.assertEqual(report["frames_labelled"], FRAMES)
        self.assertGreater(report["route_m"], 20)

    def test_fixes_of_a_gps_do_so_too_without_those_that_leap(self):
        report = self.record_log("GPS", BARE)
        self.assertTrue(0 < report["frames_labelled"] <= FRAMES)
        self.assertLess(report["route_m"], 100)

    def test_the_maps_own_file_can_be_left_for_later(self):
        folder = self.map_of(LABELLED)
        vdna("record", folder, "live", "-l", f"file://{LOGS['POSE']}?speed=0", "--no-trust")
        self.assertEqual(sorted(os.listdir(folder)), ["live.vdna", "summer.vdna"])

    def test_the_maps_own_file_knows_the_new_experience(self):
        folder = self.map_of(LABELLED)
        vdna("record", folder, "live", "-l", f"file://{LOGS['POSE']}?speed=0")
        self.assertTrue(os.path.exists(os.path.join(folder, "trust.safetensors")))
        self.assertEqual([e["experience"] for e in vdna_json("info", folder)["experiences"]],
                         ["live", "summer"])


class Live(Records):
    def send(self, camera, frame, robot=None):
        camera.send_jpeg(utime_of(frame), jpegs_in(DRIVE)[frame])
        if robot:
            robot.send(pose_message(utime_of(frame) + 50000, frame, 0))

    def test_a_drive_over_the_network_ends_by_sigterm_and_counts_what_it_left_out(self):
        folder = self.map_of(LABELLED)
        with Recording(folder, "live", "--pose-channel", "POSE") as recording, Camera() as camera, \
                Camera("POSE") as robot:
            robot.send(pose_message(utime_of(0) - 50000, -1, 0))
            for frame in range(12):
                if frame == 6:
                    camera.send(grey_message(utime_of(frame), bytes(64 * 64)))  # a lens cap
                    camera.lose(3)
                    time.sleep(0.5)
                self.send(camera, frame, robot)
                time.sleep(0.5)
            sentence = recording.end(signal.SIGTERM)
        frames, labelled, unusable, skipped, lost = map(int, re.search(
            r"live.vdna: (\d+) frames in .* m, (\d+) % labelled; left out: (\d+) unusable.*, "
            r"(\d+) that came too fast, .*; (\d+) lost by the network", sentence).groups())
        self.assertEqual(frames + unusable + skipped, 13, sentence)
        self.assertEqual((labelled, unusable, lost), (100, 1, 3), sentence)
        self.assertIn("1 uniform", sentence)
        self.assertIn("ended by a signal", sentence)
        experience = Experience(os.path.join(folder, "live.vdna"))
        self.assertTrue(set(experience.tensors["frame_utime"]) <= set(map(utime_of, range(12))))
        for i, utime in enumerate(experience.tensors["frame_utime"]):
            x = experience.tensors["frame_position"][3 * i]
            self.assertAlmostEqual(x, (utime - START) * RATE / 1e6 - 0.5, places=6)

    def test_it_keeps_frames_apart_and_ends_when_the_room_is_full(self):
        folder = self.map_of(BARE)
        with Recording(folder, "live", "--frames-max", 15, "--interval", 0.15) as recording, \
                Camera() as camera:
            for sent in range(300):
                camera.send_jpeg(utime_of(sent), jpegs_in(DRIVE)[sent % FRAMES])
                time.sleep(0.1)
                if recording.process.poll() is not None:
                    break
            sentence = recording.end()
        self.assertIn("15 frames in", sentence)
        self.assertIn("full: ended by --frames-max", sentence)
        times = Experience(os.path.join(folder, "live.vdna")).tensors["frame_utime"]
        self.assertEqual(len(times), 15)
        self.assertGreaterEqual(min(b - a for a, b in zip(times, times[1:])), 150000)

    def test_poses_in_another_frame_than_the_maps_cost_the_labels_only(self):
        folder = self.map_of(LABELLED)
        done = vdna("record", folder, "live", "-l", f"file://{LOGS['GPS']}?speed=0",
                    "--pose-channel", "GPS")
        self.assertIn("the poses are in frame wgs84, the map's positions in local", done.stderr)
        self.assertIn(", 0 % labelled", done.stdout)

    def test_the_daemon_ranks_the_new_experience_after_reload(self):
        folder = self.map_of(BARE)
        with Watch() as watch, Selectord("--map", folder, "--warmup-frames", 3):
            done = vdna("record", folder, "live", "--frames-max", 6, "--reload", "--for", 0.2,
                        check=False)
            self.assertIn("no camera frame came", done.stderr)
            with Recording(folder, "live", "--frames-max", 6, "--reload") as recording, \
                    Camera() as camera:
                frame = 0
                while recording.process.poll() is None and frame < 20 * FRAMES:
                    camera.send_jpeg(utime_of(frame), jpegs_in(DRIVE)[frame % FRAMES])
                    frame += 1
                    time.sleep(0.3)
                self.assertRegex(recording.end(), r"reload: .*2 experiences.*\(map [0-9a-f]+\)")
                for frame in range(frame, frame + FRAMES):
                    camera.send_jpeg(utime_of(frame), jpegs_in(DRIVE)[frame % FRAMES])
                    time.sleep(0.2)
            ranking = watch.wait_for("ranking", lambda ranking: len(ranking["ranking"]) == 2)
            self.assertEqual(ranking["ranking"][0]["experience"], "live")


@unittest.skipIf(SANITIZED, "memory is not the program's own")
class Memory(Records):
    SLACK = 12 << 20  # what the map's own file and the written one take for a moment

    def log_of(self, frames, poses):
        """Raw pictures, each of its own, and then poses."""
        ramp = [2 * x + y for y in range(64) for x in range(64)]
        events = [("CAMERA", grey_message(utime_of(i), bytes((level + 5 * i) % 256 for level in ramp)))
                  for i in range(frames)]
        step = frames * 1000000 // RATE // poses
        events += [("POSE", pose_message(START + i * step, 1e-3 * i, 0)) for i in range(poses + 1)]
        return lcm_log(os.path.join(WORK, f"{frames}.lcm"), events)

    def record(self, folder, log, frames, *options):
        """Most memory of its own that it held, and what was said to be taken, in bytes."""
        held = []
        with Recording(folder, "live", "--force", "--json", "-l", f"file://{log}?speed=0",
                       "--pose-channel", "POSE", "--frames-max", frames, *options) as recording:
            while recording.process.poll() is None:
                with contextlib.suppress(FileNotFoundError, KeyError):
                    held.append(memory_of(recording.process.pid)["RssAnon"])
                time.sleep(0.005)
            report = json.loads(recording.end())
        self.assertEqual((report["frames"], report["frames_labelled"]), (frames, frames))
        return max(held), report["memory_bytes"]

    def test_it_grows_with_the_room_as_stated_and_not_with_the_drive(self):
        folder = self.map_of(BARE)
        short, long = self.log_of(60, 100), self.log_of(4800, 500000)
        self.addCleanup(os.unlink, long)
        one, one_stated = self.record(folder, short, 1)
        held, stated = self.record(folder, short, 60)
        of_long, _ = self.record(folder, long, 60, "--interval", 7.95)
        figures = f"held {one} with 1 frame, {held} with 60, {of_long} with 60 of 4800; " \
                  f"stated {one_stated} and {stated}"
        print(figures)
        self.assertLessEqual(held - one, stated - one_stated + self.SLACK, figures)
        self.assertLessEqual(of_long - one, stated + self.SLACK, figures)


class Failures(Records):
    URL = f"file://{LOGS['POSE']}?speed=0"

    def test_what_would_be_found_out_after_the_drive_is_refused_before_it(self):
        folder = self.map_of(BARE)
        self.assertIn("no such map", self.refused(os.path.join(WORK, "none"), "live"))
        self.assertIn("`vdna build", self.refused(os.path.join(WORK, "none"), "live"))
        self.assertFalse(os.path.exists(os.path.join(WORK, "none")))
        self.assertIn("exists already", self.refused(folder, "summer"))
        self.assertIn("does not compare", self.refused(folder, "live", "--backbone",
                                                       "efficientnet_lite0_paper"))
        self.refused(folder, ".live", code=2)
        self.refused(folder, "live", "--frames-max", 0, code=2)
        self.assertEqual(sorted(os.listdir(folder)), sorted(os.listdir(BARE)))

    def test_a_map_can_begin_with_ranges_of_another(self):
        folder = os.path.join(WORK, "begun")
        vdna("record", folder, "live", "-l", self.URL, "--ranges", os.path.join(BARE, "summer.vdna"))
        self.assertEqual(vdna_json("info", folder)["experiences"][0]["frames"], FRAMES)

    def test_the_recording_waits_for_room_on_the_disk(self):
        folder = self.map_of(BARE)
        with Recording(folder, "live", "-l", self.URL, file_size=1 << 20) as recording:
            self.assertIn("the recording still in memory", recording.process.stderr.readline())
            self.assertEqual(os.listdir(folder), ["summer.vdna"])
            resource.prlimit(recording.process.pid, resource.RLIMIT_FSIZE,
                             (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
            self.assertIn(f"{FRAMES} frames", recording.end())
        self.assertEqual(len(vdna_json("info", folder)["experiences"]), 2)

    def test_a_kill_at_any_moment_leaves_the_map_as_it_was_or_with_all_of_the_new(self):
        folder = self.map_of(BARE)
        with open(os.path.join(folder, "summer.vdna"), "rb") as file:
            before = file.read()
        chance = random.Random(16)
        for _ in range(4):
            with Recording(folder, "live", "-l", self.URL, "--force") as recording:
                staged = os.path.join(folder, "live.vdna")
                deadline = time.monotonic() + PATIENCE
                while recording.process.poll() is None and time.monotonic() < deadline and \
                        not set(os.listdir(folder)) - {"summer.vdna", "live.vdna",
                                                       "trust.safetensors"}:
                    pass  # until it writes
                time.sleep(chance.uniform(0, 0.05))
                recording.process.kill()
                recording.process.wait()
            found = vdna_json("info", folder)["experiences"]
            self.assertIn(len(found), (1, 2))
            self.assertEqual(len(found) == 2, os.path.exists(staged))
            with open(os.path.join(folder, "summer.vdna"), "rb") as file:
                self.assertEqual(file.read(), before)
        self.assertIn(f"{FRAMES} frames", vdna("record", folder, "live", "-l", self.URL,
                                               "--force").stdout)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
