"""A camera that shows nothing new, and what bounds the work while driving, through the whole daemon: such
frames are answered from the last one that went through the network, are flagged and counted, and a camera
that is frozen is still told.

Environment: VDNA_BIN, PYTHONPATH with test/support.
"""
import functools
import json
import os
import random
import shutil
import time
import unittest

import own_network
from selectord import Camera, Frames, Selectord, Watch, WithConfiguration
from selectord import grey_message, image_message, jpegs_in, lcm_log, selectord, vdna
from tiny_network import write_tiny_network

WORK = os.path.abspath("parked")
MAP, TINY, DRIVE = (os.path.join(WORK, name) for name in ("map", "tiny.toml", "drive"))
SIDE, WARMUP = 96, 10
KNOWN = 2 * 16 * 4  # frames of a stand after which its noise is known
FATES = ("processed", "parked", "carried", "refused", "skipped", "over_rate", "oversized", "late")


@functools.cache
def shades(number):
    """Shades and a square that moves, from picture to picture."""
    at = 3 * number % (SIDE - 24)
    return bytes(min(245, 37 + x + (90 if at <= x < at + 24 and 20 <= y < 60 else 0) +
                     (y if (x // 12 + y // 12) % 2 else 0))
                 for y in range(SIDE) for x in range(SIDE))


def scene(chance, number):
    """A view with a sensor's noise."""
    noise = chance.randbytes(SIDE * SIDE)
    return bytes(level + value % 5 for level, value in zip(shades(number), noise))


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    write_tiny_network(WORK, ("tokens", "samples_neurons"))
    drives = []
    for name in ("summer", "winter"):
        drives.append(os.path.join(WORK, name))
        vdna("simulate", drives[-1], "--condition", name, "--frames", 60)
    vdna("build", "--backbone", TINY, MAP, *drives)
    vdna("simulate", DRIVE, "--condition", "summer", "--drive", 2, "--variation", 0.6, "--frames", 240,
         "--step", 0.1, "--rate", 30)


class WithAnswers(WithConfiguration):
    work = WORK

    def settings(self, text=""):
        return self.configure(f'[map]\ndirectory = "{MAP}"\n[backbone]\nmanifest = "{TINY}"\n'
                              f"[select]\nstop_early = false\n{text}")

    def replay(self, messages, text="", warmup=WARMUP):
        """The answers to a log of camera messages."""
        log = lcm_log(os.path.join(WORK, f"{self.id()}.log"), [("CAMERA", m) for m in messages])
        answers = log + ".jsonl"
        result = selectord("-c", self.settings(text), "--warmup-frames", warmup, "-l",
                           f"file://{log}?speed=0", "--answers", answers)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(answers, encoding="utf-8") as file:
            lines = [json.loads(line) for line in file]
        return [line for line in lines if line["type"] == "localisation"]


def messages_of(pictures):
    return [grey_message(number * 33333, pixels) for number, pixels in enumerate(pictures)]


class Parked(WithAnswers):

    def setUp(self):
        self.chance = random.Random(self.id())

    def moving(self, count):
        return [scene(self.chance, number) for number in range(count)]

    def standing(self, count):
        return [scene(self.chance, 20) for _ in range(count)]

    def test_a_robot_that_stands_is_answered_from_the_last_frame_that_was_seen(self):
        answers = self.replay(messages_of(self.moving(20) + self.standing(400)))
        parked = [answer for answer in answers if answer["basis"] == "PARKED"]
        self.assertGreater(len(parked), 400 - KNOWN - 20)
        last = None
        for answer in answers:
            if answer["basis"] == "SEEN":
                last = answer
                continue
            changed = {key for key in answer if answer[key] != last[key]}
            self.assertLessEqual(changed, {"utime", "basis", "moving"})
            self.assertFalse(answer["moving"])

    def test_a_robot_that_moves_is_seen_in_every_frame(self):
        answers = self.replay(messages_of(self.moving(20) + self.standing(160) + self.moving(100)))
        self.assertEqual({answer["basis"] for answer in answers[180:]}, {"SEEN"})
        self.assertEqual({answer["basis"] for answer in answers[:20]}, {"SEEN"})

    def test_none_is_parked_if_that_is_switched_off(self):
        answers = self.replay(messages_of(self.moving(20) + self.standing(100)),
                              "[camera]\nparked = 0\n")
        self.assertEqual({answer["basis"] for answer in answers}, {"SEEN"})

    def test_a_camera_that_freezes_while_it_is_parked_is_told(self):
        frozen = self.standing(1) * 50
        answers = self.replay(messages_of(self.moving(20) + self.standing(160) + frozen))
        self.assertEqual(answers[179]["basis"], "PARKED")
        for answer in answers[182:]:
            self.assertEqual(answer["validity"], "REFUSED")
            self.assertIn("frozen", answer["reason"])

    def test_a_camera_that_repeats_pictures_while_it_is_parked_is_told(self):
        repeated = self.standing(5) * 10
        answers = self.replay(messages_of(self.moving(20) + self.standing(160) + repeated))
        self.assertEqual(answers[179]["basis"], "PARKED")
        self.assertEqual({answer["validity"] for answer in answers[190:]}, {"REFUSED"})

    def test_a_warmup_counts_what_it_is_shown(self):
        answers = self.replay(messages_of(self.standing(WARMUP + 1)))
        self.assertNotEqual(answers[WARMUP]["validity"], "WARMING_UP")

    def test_a_warmup_of_distinct_frames_waits_for_the_drive(self):
        pictures = self.moving(2) + self.standing(200) + self.moving(60)
        answers = self.replay(messages_of(pictures),
                              "[warmup]\ndistinct = true\n", warmup=160)
        standing = answers[2 + KNOWN + 10:202]
        self.assertEqual({(a["validity"], a["basis"]) for a in standing}, {("WARMING_UP", "PARKED")})

    def test_of_a_live_camera_each_frame_has_one_fate(self):
        with Watch() as watch, Selectord("-c", self.settings(), "--warmup-frames", WARMUP), \
                Frames(lambda number: scene(self.chance, min(number, 20)), rate=30):
            status = watch.wait_for("status", lambda s: s["parked"] > 60)
            watch.wait_for("localisation", lambda a: a["basis"] == "PARKED")
        self.assertEqual(status["received"], sum(status[fate] for fate in FATES), status)


class Bounded(WithAnswers):

    def drive(self):
        return [image_message(number * 33333, jpeg) for number, jpeg in enumerate(jpegs_in(DRIVE))]

    def test_frames_beyond_the_rate_are_skipped_and_counted(self):
        answers = self.replay(self.drive(), "[camera]\nmax_rate_hz = 10\n")
        self.assertAlmostEqual(len(answers), 80, delta=3)
        last = answers[-1]["utime"] // 33333
        self.assertEqual(sum(1 + answer["skipped"] for answer in answers), last + 1)

    def test_frames_near_the_last_one_are_answered_from_it(self):
        exact = self.replay(self.drive())
        answers = self.replay(self.drive(), "[localise]\nevery_m = 1\nmin_confidence = 0\n")
        self.assertEqual(len(answers), len(exact))
        carried = [answer for answer in answers if answer["basis"] == "CARRIED"]
        print(f"{len(carried)} of {len(answers)} frames carried")
        self.assertGreater(len(carried), len(answers) // 6)
        last = None
        for answer in answers:
            if answer["basis"] == "SEEN":
                last = answer
                continue
            self.assertLessEqual({key for key in answer if answer[key] != last[key]},
                                 {"utime", "basis"})

    def test_of_a_fast_camera_each_frame_has_one_fate(self):
        with Watch() as watch, Camera() as camera, \
                Selectord("-c", self.settings("[camera]\nmax_rate_hz = 10\n"),
                          "--warmup-frames", WARMUP):
            for message in self.drive()[:120]:
                camera.send(message)
                time.sleep(1 / 60)
            status = watch.wait_for("status", lambda s: s["received"] == 120)
        self.assertEqual(status["received"], sum(status[fate] for fate in FATES), status)
        self.assertGreater(status["over_rate"], 60)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
