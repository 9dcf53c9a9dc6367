"""Pictures that show nothing, or nothing new, through the whole daemon: none gets a VALID answer; and a
flood of messages that are no pictures leaves the good frames their place.

Environment: VDNA_BIN, VDNA_ALL (set: a hundred scripts of each fault, otherwise ten), PYTHONPATH with
test/support.
"""
import functools
import os
import random
import shutil
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import own_network
from selectord import Camera, Selectord, Watch, grey_message, image_message, lcm_log, vdna
from selectord import selectord
from tiny_network import write_tiny_network

WORK = os.path.abspath("unusable_pictures")
MAP, TINY = os.path.join(WORK, "map"), os.path.join(WORK, "tiny.toml")
SCRIPTS = 100 if os.environ.get("VDNA_ALL") else 10
SIDE = 96
FRAMES, WARMUP = 40, 10


@functools.cache
def shades(number):
    """Shades and a square that moves, from picture to picture."""
    at = number % (SIDE - 24)
    return bytes(min(250, 37 + x + (90 if at <= x < at + 24 and 20 <= y < 60 else 0) +
                     (y if (x // 12 + y // 12) % 2 else 0))
                 for y in range(SIDE) for x in range(SIDE))


@functools.cache
def modulo(count):
    return bytes(value % count for value in range(256))


def with_noise(chance, pixels, noise):
    """Pixels of at most 255 - 2 noise, each 0..2 noise lighter."""
    lighter = chance.randbytes(len(pixels)).translate(modulo(2 * noise + 1))
    return (int.from_bytes(pixels, "big") + int.from_bytes(lighter, "big")).to_bytes(len(pixels), "big")


def scene(chance, number):
    """A picture that is worth counting, with a sensor's noise."""
    return with_noise(chance, shades(number), 2)


def even(chance, level, noise):
    return with_noise(chance, bytes([level - noise]) * (SIDE * SIDE), noise)


@functools.cache
def cap():
    return bytes(max(0, 8 - ((x - SIDE // 2) ** 2 + (y - SIDE // 2) ** 2) // 700)
                 for y in range(SIDE) for x in range(SIDE))


def lens_cap(chance, number):
    del number
    return with_noise(chance, cap(), 1)


FAULTS = {
    "black": lambda chance, number: even(chance, 2, 1),
    "white": lambda chance, number: bytes([255]) * (SIDE * SIDE),
    "grey": lambda chance, number: even(chance, 128, 2),
    "noise": lambda chance, number: chance.randbytes(SIDE * SIDE),
    "lens cap": lens_cap,
    "frozen": lambda chance, number: scene(random.Random(1), 0),
    "repeated": lambda chance, number: scene(random.Random(number % 2), number % 2),
    "1x1": lambda chance, number: chance.randbytes(1),
    "changing size": lambda chance, number: scene(chance, number)[:SIDE * (24 + number * 37 % 70)],
}


# Pictures of a fault that nobody can tell from good ones: the first of those that repeat.
NEW = {fault: {"frozen": 1, "repeated": 2}.get(fault, 0) for fault in FAULTS}


def prepare():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    write_tiny_network(WORK, ("tokens", "samples_neurons"))
    drives = []
    for name in ("summer", "winter"):
        drives.append(os.path.join(WORK, name))
        vdna("simulate", drives[-1], "--condition", name, "--frames", 24)
    vdna("build", "--backbone", TINY, MAP, *drives)


def answers_to(log):
    """The validities that a replay gives."""
    answers = log + ".jsonl"
    result = selectord("--map", MAP, "--backbone", TINY, "--warmup-frames", WARMUP, "-l",
                       f"file://{log}?speed=0", "--answers", answers)
    with open(answers, encoding="utf-8") as file:
        lines = file.read().splitlines()
    return result.returncode, [line.split('"validity":"')[1].split('"')[0] for line in lines
                               if '"type":"localisation"' in line]


class UnusablePictures(unittest.TestCase):

    def log_of(self, name, pictures):
        return lcm_log(os.path.join(WORK, name), [
            ("CAMERA", grey_message(number * 100000, pixels))
            for number, pixels in enumerate(pictures)])

    def test_scenes_are_answered(self):
        """The control."""
        chance = random.Random(7)
        code, answers = answers_to(self.log_of("control", [scene(chance, number)
                                                            for number in range(FRAMES)]))
        self.assertEqual(code, 0)
        self.assertGreater(sum(answer in ("VALID", "UNSURE") for answer in answers), FRAMES // 2)

    def answers_to_script(self, fault, script):
        chance = random.Random(f"{fault} {script}")
        # Half of the scripts begin with a warmup of good pictures, so something is chosen.
        good = script % 2 * 2 * WARMUP
        log = self.log_of(f"fault{script}", [scene(chance, number) for number in range(good)] +
                          [FAULTS[fault](chance, number) for number in range(FRAMES)])
        _, answers = answers_to(log)
        os.remove(log)
        self.assertEqual(len(answers), good + FRAMES)
        return answers[good + NEW[fault]:]

    def test_no_script_of_a_fault_gets_a_valid_answer(self):
        for fault in FAULTS:
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                answers = sum(pool.map(lambda script, of=fault: self.answers_to_script(of, script),
                                       range(SCRIPTS)), [])
            placed = sum(answer in ("VALID", "UNSURE", "DEGRADED", "NONE_FITS") for answer in answers)
            print(f"{fault}: {SCRIPTS} scripts, {answers.count('VALID')} VALID, {placed} with a place")
            self.assertEqual(placed, 0, fault)


class Flood(unittest.TestCase):

    def test_of_messages_that_are_no_pictures_takes_at_most_a_tenth_of_the_frames(self):
        chance, ended = random.Random(3), threading.Event()

        def flood():
            with Camera() as sender:
                number = 0
                while not ended.wait(0.0005):
                    sender.send(image_message(number, b"\xff\xd8 no JPEG " + chance.randbytes(2000)))
                    number += 1

        pictures = [grey_message(number * 100000, scene(chance, number)) for number in range(100)]
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--backbone", TINY, "--warmup-frames", WARMUP):
            camera.send(pictures[0])
            watch.wait_for("localisation")
            flooding = threading.Thread(target=flood)
            flooding.start()
            for picture in pictures[1:]:
                camera.send(picture)
                time.sleep(0.05)
            ended.set()
            flooding.join()
            watch.collect(2)
        used = watch.of("status")[-1]["processed"]
        refused = watch.of("status")[-1]["refused"]
        print(f"{used} of {len(pictures)} good frames used, {refused} others refused")
        self.assertGreater(refused, 100)
        self.assertGreaterEqual(used, len(pictures) * 9 // 10)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
