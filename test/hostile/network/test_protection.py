"""End-to-end protection of what `vdna play` sends, on bad networks and in bad logs: a flipped bit in each
of 100 JPEG frames; lost, repeated and reordered ones.
"""

import json
import os
import random
import shutil
import struct
import time
import unittest

import own_network
from peers import STOCK, Receiver, Sender
from selectord import Camera, Selectord, Watch, lcm_log, logger, selectord, vdna

WORK = os.path.abspath("protection")
MAP = os.path.join(WORK, "map")
DRIVE = os.path.join(WORK, "drive")
FRAMES = 100
DATA_AT = 36  # of a bot_core.image_t
PACE = 0.005  # seconds between messages, so that none is dropped
SETTLED = 0.5  # seconds after which what was sent has come


def prepare():
    if os.path.exists(MAP):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    vdna("simulate", DRIVE, "--frames", FRAMES, "--size", "160x120")
    vdna("build", MAP, DRIVE)


def read_log(path):
    """The messages of an LCM log."""
    with open(path, "rb") as file:
        data = file.read()
    at, messages = 0, []
    while at < len(data):
        _, _, _, channel, size = struct.unpack_from(">IqqII", data, at)
        at += 28 + channel + size
        messages.append(data[at - size:at])
    return messages


def played(*options):
    """What `vdna play` sends, as lcm-logger records it."""
    log = os.path.join(WORK, "played.log")
    for rate in (100, 25, 5):
        with logger(log):
            vdna("play", DRIVE, "--rate", rate, "--stamp", "recorded", *options)
            time.sleep(SETTLED)
        messages = read_log(log)
        if len(messages) == FRAMES:
            return messages
    raise AssertionError(f"lcm-logger recorded {len(messages)} of {FRAMES} frames")


def flipped(messages):
    """With one bit of each JPEG flipped."""
    choose = random.Random(1)
    changed = []
    for message in messages:
        size, = struct.unpack_from(">i", message, DATA_AT - 4)
        bit = choose.randrange(8 * size)
        copy = bytearray(message)
        copy[DATA_AT + bit // 8] ^= 1 << bit % 8
        changed.append(bytes(copy))
    return changed


def send(messages):
    sender = Sender()
    for message in messages:
        sender.send(message)
        time.sleep(PACE)
    time.sleep(SETTLED)


def received(messages):
    """The counters of a receiver for these messages."""
    with Receiver(STOCK) as receiver:
        send(messages)
        receiver.end()
    return receiver.counters


def impaired(numbers, seed):
    """An order in which a network may deliver these: some lost, some twice, some late."""
    choose = random.Random(seed)
    arrivals = []
    for number in numbers:
        for _ in range(choose.choices((0, 1, 2), (10, 80, 10))[0]):
            arrivals.append((number + choose.choice((0, 0, 0, 2.5, 7.5)), number))
    return [number for _, number in sorted(arrivals)]


def judged(numbers):
    """What becomes of frames that arrive in this order."""
    came, counts = set(), {"received": 0, "repeated_frames": 0, "reordered_frames": 0}
    for number in numbers:
        fate = ("repeated_frames" if number in came else
                "reordered_frames" if came and number < max(came) else "received")
        counts[fate] += 1
        came.add(number)
    return {**counts, "lost_frames": len(set(range(numbers[0], max(came) + 1)) - came)}


class Protection(unittest.TestCase):

    def answers(self, messages):
        """The localisations of a daemon that reads a log of these messages."""
        path = os.path.join(WORK, "answers.jsonl")
        if os.path.exists(path):
            os.unlink(path)
        log = lcm_log(os.path.join(WORK, "replay.log"), [("CAMERA", m) for m in messages])
        selectord("--map", MAP, "-l", f"file://{log}?speed=0", "--answers", path)
        with open(path, encoding="utf-8") as file:
            said = [json.loads(line) for line in file]
        return [answer for answer in said if answer["channel"] == "VDNA_LOCALISATION"]

    def test_intact_frames_come_through_a_logger_as_they_were_sent(self):
        counters = received(played())
        self.assertEqual({name: counters[name] for name in (
            "received", "rejected", "unprotected_frames", "lost_frames", "stream_count")},
            {"received": FRAMES, "rejected": 0, "unprotected_frames": 0, "lost_frames": 0,
             "stream_count": 1})

    def test_unprotected_frames_are_used_and_counted(self):
        counters = received(played("--unprotected"))
        self.assertEqual((counters["received"], counters["unprotected_frames"],
                          counters["stream_count"]), (FRAMES, FRAMES, 0))

    def test_of_frames_with_a_flipped_bit_none_is_received(self):
        counters = received(flipped(played()))
        self.assertEqual((counters["received"], counters["corrupted_frames"],
                          counters["rejected"]), (0, FRAMES, FRAMES))

    def test_of_frames_with_a_flipped_bit_none_in_a_log_is_answered(self):
        messages = played()
        self.assertEqual(len(self.answers(messages)), FRAMES)
        self.assertEqual(self.answers(flipped(messages)), [])

    def test_without_protection_most_frames_with_a_flipped_bit_are_used(self):
        answers = self.answers(flipped(played("--unprotected")))
        used = [answer for answer in answers if answer["validity"] != "REFUSED"]
        print(f"of {FRAMES} unprotected frames with a flipped bit, {len(used)} are used")
        self.assertGreater(len(used), FRAMES // 2)

    def test_a_running_daemon_answers_no_frame_with_a_flipped_bit(self):
        messages = flipped(played())
        with Watch() as watch, Selectord("--map", MAP), Camera() as camera:
            for message in messages:
                camera.send(message)
                time.sleep(PACE)
            status = watch.wait_for("status", lambda said: said["rejected"] >= FRAMES)
            self.assertEqual((status["rejected"], status["received"]), (FRAMES, 0))
            self.assertEqual(watch.of("localisation"), [])

    def test_repeated_reordered_and_lost_frames_are_counted_exactly(self):
        messages = played()
        for seed in range(5):
            order = impaired(range(FRAMES), seed)
            expected = judged(order)
            self.assertTrue(all(expected.values()), expected)
            counters = received([messages[number] for number in order])
            self.assertEqual({name: counters[name] for name in expected}, expected, f"seed {seed}")

    def test_a_second_sender_is_a_second_stream(self):
        one, other = played(), played()
        counters = received([message for pair in zip(one, other) for message in pair])
        self.assertEqual((counters["received"], counters["stream_count"],
                          counters["repeated_frames"]), (2 * FRAMES, 2, 0))


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
