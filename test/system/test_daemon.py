"""System test of vdna_selectord: real daemon, real network, real LCM, simulated pictures.

Environment: VDNA_BIN (folder of the programs), VDNA_MODELS (folder of the backbones).
Works in the current directory; an existing map is reused.
"""
import contextlib
import itertools
import json
import os
import shutil
import signal
import statistics
import struct
import subprocess
import threading
import time
import unittest

import own_network
from selectord import (BIN, SANITIZED, Camera, Selectord, Watch, WithConfiguration, image_message,
                       jpegs_in, lcm_log, localisation_message, selectord, vdna, vdna_json)

WORK = os.path.abspath("daemon")
MAP = os.path.join(WORK, "map")
LIVE = os.path.join(WORK, "live")
CONDITIONS = ["summer", "winter", "night"]
FRAMES = 24   # of the live drive
WARMUP = 12   # of them
MIN_CONFIDENCE = 0.96  # the daemon's default
RATES = (10, 5, 2)  # Hz; an idle machine manages 100


def prepare():
    """Three traversals as a map, and a drive like one of them on another day."""
    if os.path.exists(LIVE):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    drives = [os.path.join(WORK, condition) for condition in CONDITIONS]
    for drive, condition in zip(drives, CONDITIONS):
        vdna("simulate", drive, "--condition", condition, "--frames", 40)
    vdna("build", MAP, *drives)
    vdna("simulate", LIVE + ".part", "--condition", "winter", "--frames", FRAMES,
         "--drive", 7, "--variation", 0.5)
    os.rename(LIVE + ".part", LIVE)


def pictures():
    """Those of the map's drives, again and again; a camera that repeats itself sooner is refused."""
    while True:
        for condition in CONDITIONS:
            yield from jpegs_in(os.path.join(WORK, condition))


PICTURES = pictures()


def has_answered(frames):
    """True for a status that counts all of them."""
    return lambda status: status["received"] >= frames


class Network(WithConfiguration):
    """A daemon on the network."""

    work = WORK

    def drive(self, *options):
        """All messages of a fresh daemon for the live drive.

        On a busy machine the daemon may skip frames, as designed; then they are sent again, slower.
        """
        for rate in RATES:
            with Watch() as watch, Selectord("--map", MAP, *options):
                vdna("play", LIVE, "--rate", rate, "--stamp", "recorded")
                status = watch.wait_for("status", has_answered(FRAMES))
            if status["skipped"] == 0:
                return watch
        raise AssertionError(f"frames were skipped even at {RATES[-1]} Hz")

    def by_the_paper(self, more=""):
        return "-c", self.configure("[select]\nrank = 'emd'\nstop_early = false\n"
                                    f"reselect = false\n{more}")

    def test_says_what_rank_and_localise_say(self):
        said = self.drive("--warmup-frames", WARMUP, *self.by_the_paper())
        answers = said.of("localisation")
        self.assertEqual([answer["validity"] for answer in answers[:WARMUP]],
                         ["WARMING_UP"] * WARMUP)
        self.assertEqual([answer["validity"] for answer in answers[WARMUP:]],
                         ["VALID" if answer["confidence"] >= MIN_CONFIDENCE else "UNSURE"
                          for answer in answers[WARMUP:]])

        rankings = said.of("ranking")
        self.assertEqual(len(rankings), 1)
        ranked = rankings[0]["ranking"]
        expected = vdna_json("rank", LIVE, MAP, "--warmup", WARMUP)
        self.assertEqual([(entry["experience"], entry["distance_bins"]) for entry in ranked],
                         [(entry["experience"], entry["distance_bins"])
                          for entry in expected["ranking"]])
        self.assertEqual(rankings[0]["margin_bins"], expected["margin_bins"])
        self.assertEqual(rankings[0]["window_frames"], WARMUP)
        self.assertEqual(rankings[0]["utime"] - rankings[0]["window_begin_utime"],
                         answers[WARMUP - 1]["utime"] - answers[0]["utime"])

        chosen = ranked[0]["experience"]
        self.assertEqual(chosen, "winter")
        matches = vdna_json("localise", LIVE, MAP, "--in", chosen, "--skip", WARMUP,
                          "--matches")["candidates"][0]["matches"]
        fields = ("utime", "experience", "frame", "frame_utime", "confidence", "moving",
                  "nearest_frame", "distance")
        self.assertEqual([[answer[field] for field in fields] for answer in answers[WARMUP:]],
                         [[match[field] for field in fields] for match in matches])

    def test_places_behind_the_exact_ones_have_bounds(self):
        said = self.drive("--warmup-frames", WARMUP, *self.by_the_paper("exact_distances = 1\n"))
        ranked = said.of("ranking")[0]["ranking"]
        expected = vdna_json("rank", LIVE, MAP, "--warmup", WARMUP)["ranking"]
        self.assertEqual({key: ranked[0][key] for key in ("experience", "distance_bins", "bound")},
                         {"experience": expected[0]["experience"], "bound": False,
                          "distance_bins": expected[0]["distance_bins"]})
        distances = {entry["experience"]: entry["distance_bins"] for entry in expected}
        for entry in ranked:
            distance = distances[entry["experience"]]
            self.assertTrue(entry["distance_bins"] <= distance if entry["bound"]
                            else entry["distance_bins"] == distance, entry)
        self.assertTrue(ranked[-1]["bound"], ranked)

    def test_warms_up_for_a_time(self):
        said = self.drive("--warmup-seconds", 1.15, *self.by_the_paper())
        # Stamps are 0.0, 0.1, ... 1.1; the frame of 1.2 completes the window and is localised.
        self.assertEqual(said.of("ranking")[0]["window_frames"], 12)
        self.assertEqual([answer["validity"] == "WARMING_UP"
                          for answer in said.of("localisation")],
                         [True] * 12 + [False] * (FRAMES - 12))

    def test_a_reset_command_makes_it_choose_again(self):
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 4) as daemon:
            vdna("play", LIVE, "--frames", 12)
            watch.wait_for("ranking")
            vdna("command", "reset")
            watch.wait_for("status", lambda status: status["experience"] == "")
            vdna("play", LIVE, "--frames", 12)
            watch.wait_for("ranking")
            watch.wait_for("status", lambda status: status["state"] in ("VALID", "UNSURE"))
        self.assertEqual(len(watch.of("ranking")), 2)
        self.assertTrue(any("reset" in line for line in daemon.log), daemon.log)

    def test_malformed_messages_are_counted_and_harmless(self):
        good = image_message(1, b"\xff\xd8\xff")
        malformed = [
            b"", b"\0", b"garbage", good[:-1], good + b"\0", b"\0" * len(good),
            good[:36] + b"\xff\xff\xff\xff" + good[40:],  # size of the data: -1
            good[:36] + b"\x7f\xff\xff\xff" + good[40:],  # ... and 2 GiB
            good[:-4] + b"\x7f\xff\xff\xff",              # two thousand million metadata
            good[:32] + b"\0\0\0\0" + good[36:],          # pixel format 0
        ]
        not_lcm = [b"", b"LC", b"LC02", b"LC02\0\0\0\0", b"LC02\0\0\0\0CAMERA", b"\xff" * 1400,
                   b"LC03" + b"\0" * 4, b"LC03" + b"\0" * 16,
                   b"LC03" + b"\0" * 6 + b"\1\0" + b"\xff" * 4 + b"\0\1\0\2" + b"x" * 20]
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 4) as daemon:
            for data in not_lcm:
                camera.send_datagram(data)
            for message in malformed:
                camera.send(message)
            watch.wait_for("status", lambda status: status["rejected"] == len(malformed))
            camera.send_jpeg(5, next(PICTURES))
            self.assertEqual(watch.wait_for("localisation")["utime"], 5)
            self.assertTrue(daemon.is_running())
        self.assertEqual(watch.of("status")[-1]["received"], 0)

    def test_a_picture_that_cannot_be_decoded_is_answered_refused(self):
        picture = next(PICTURES)
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 4) as daemon:
            for utime, data in enumerate([b"\xff\xd8\xffnot a picture", b"", picture[:200]]):
                camera.send_jpeg(utime, data)
                answer = watch.wait_for("localisation")
                self.assertEqual((answer["utime"], answer["validity"]), (utime, "REFUSED"))
                self.assertIsNone(answer["experience"])
            status = watch.wait_for("status", lambda status: status["refused"] == 3)
            self.assertEqual((status["processed"], status["progress"]), (0, 0))
            self.assertIn("refused", status["message"])
            camera.send_jpeg(3, picture)
            self.assertEqual(watch.wait_for("localisation")["validity"], "WARMING_UP")
        self.assertTrue(any("refused" in line for line in daemon.log), daemon.log)

    def test_time_that_runs_backwards_begins_the_warmup_anew(self):
        with Watch() as watch, Camera() as camera, Selectord("--map", MAP, "--warmup-frames", 3):
            for tenths in (100, 101, 50, 51, 52):
                camera.send_jpeg(tenths * 100000, next(PICTURES))
                watch.wait_for("localisation")
            status = watch.wait_for("status", has_answered(5))
        self.assertEqual(status["restarts"], 1)
        self.assertEqual([(ranking["window_begin_utime"], ranking["utime"])
                          for ranking in watch.of("ranking")], [(5000000, 5200000)])

    def test_status_comes_once_a_second_without_frames(self):
        with Watch() as watch, Selectord("--map", MAP) as daemon:
            first = watch.wait_for("status")
            watch.collect(4.5)
            self.assertTrue(daemon.is_running())
        self.assertIn(len(watch.of("status")) - 1, (3, 4, 5))
        self.assertEqual((first["state"], first["progress"], first["experience"]),
                         ("WARMUP", 0, ""))
        self.assertEqual((first["experiences"], first["backbone"], first["message"]),
                         (len(CONDITIONS), "efficientnet_lite0", ""))
        self.assertLess(abs(first["utime"] / 1e6 - time.time()), 60)
        self.assertGreater(first["resident_bytes"], 1 << 20)
        self.assertGreaterEqual(first["resident_bytes_max"], first["resident_bytes"])
        self.assertEqual(first["total"], {"newest_us": 0, "p50_us": 0, "p99_us": 0, "max_us": 0})

    def test_every_frame_is_answered_or_declared_missed(self):
        sent = 150
        oversized = self.configure("[lcm]\nmax_image_bytes = 40000\n")
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 4, "-c", oversized):
            for utime in range(sent):
                if utime % 10 == 3:
                    camera.send_jpeg(utime, b"x" * 40001)
                else:
                    camera.send_jpeg(utime, next(PICTURES) if utime % 10 else b"no JPEG")
                time.sleep(0.002)  # faster than any network
            watch.wait_for("status", has_answered(sent))
            camera.send_jpeg(sent, next(PICTURES))
            last = watch.wait_for("localisation", lambda answer: answer["utime"] == sent)
            status = watch.wait_for("status", has_answered(sent + 1))
        answers = watch.of("localisation")
        self.assertEqual(last, answers[-1])
        self.assertEqual(sent + 1, len(answers) + sum(answer["skipped"] for answer in answers))
        for found in watch.of("status"):
            self.assertEqual(found["received"], found["processed"] + found["refused"] +
                             found["skipped"] + found["oversized"] + found["late"])
        self.assertEqual((status["received"], status["oversized"]), (sent + 1, sent // 10))
        self.assertEqual(status["processed"] + status["refused"], len(answers))
        self.assertGreater(status["skipped"], 0)
        self.assertEqual(status["picture_bytes_max"], 40001)
        self.assertGreater(status["backlog_max"], 1)

    def test_a_frozen_camera_is_degraded_and_a_silent_one_stale(self):
        quick = self.configure("[camera]\nstale_seconds = 1.5\n")
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 4, "-c", quick):
            for utime in range(8):
                camera.send_jpeg(utime * 100000, next(PICTURES))
                answer = watch.wait_for("localisation")
            self.assertIn(answer["validity"], ("VALID", "UNSURE"))
            frozen = next(PICTURES)
            for utime in range(8, 30):
                camera.send_jpeg(utime * 100000, frozen)
                answer = watch.wait_for("localisation")
            self.assertEqual(answer["validity"], "REFUSED")
            self.assertIn("the camera is frozen", answer["reason"])
            camera.send_jpeg(3000000, next(PICTURES))
            answer = watch.wait_for("localisation")
            self.assertEqual(answer["validity"], "DEGRADED")
            self.assertIn("frozen", answer["reason"])
            self.assertIsNotNone(answer["frame"])
            status = watch.wait_for("status", lambda status: status["state"] == "DEGRADED")
            self.assertEqual(status["unusable"], 21)
            for utime in range(31, 60):  # it recovers without a new warmup
                camera.send_jpeg(utime * 100000, next(PICTURES))
                answer = watch.wait_for("localisation")
            self.assertIn(answer["validity"], ("VALID", "UNSURE"))
            stale = watch.wait_for("status", lambda status: status["state"] == "STALE")
            self.assertGreater(stale["frame_age_us"], 1500000)
            self.assertIn("stale_seconds", stale["reason"])
            camera.send_jpeg(6000000, next(PICTURES))
            watch.wait_for("status", lambda status: status["state"] in ("VALID", "UNSURE"))
        self.assertEqual(len(watch.of("ranking")), 1)

    def test_two_daemons_of_one_map_have_its_hash_and_differ(self):
        said = []
        for _ in range(2):
            with Watch() as watch, Selectord("--map", MAP):
                said.append(watch.wait_for("status"))
        self.assertEqual(said[0]["map_hash"], said[1]["map_hash"])
        self.assertEqual(said[0]["boot_id"], said[1]["boot_id"])
        self.assertNotEqual(said[0]["instance"], said[1]["instance"])

    def test_the_status_tells_how_long_the_stages_take(self):
        with Watch() as watch, Camera() as camera, Selectord("--map", MAP, "--warmup-frames", 3):
            for utime in range(8):
                camera.send_jpeg(utime, next(PICTURES))
                watch.wait_for("localisation")
            status = watch.wait_for("status", has_answered(8))
        self.assertEqual(status["window_frames_max"], 3)
        for name in ("queue", "decode", "resize", "inference", "select", "rank", "publish",
                     "total"):
            stage = status[name]
            self.assertLessEqual(stage["p50_us"], stage["p99_us"])
            self.assertLessEqual(stage["p99_us"], stage["max_us"])
            self.assertLessEqual(stage["newest_us"], stage["max_us"])
        self.assertGreater(status["inference"]["p50_us"], status["resize"]["p50_us"])
        latencies = sorted(answer["latency_us"] for answer in watch.of("localisation"))
        # The total ends when the answer is sent, its latency just before.
        self.assertGreaterEqual(status["total"]["max_us"], latencies[-1])
        self.assertGreaterEqual(status["total"]["p50_us"] * 64 / 63, latencies[3])
        parts = sum(status[name]["newest_us"]
                    for name in ("queue", "decode", "resize", "inference", "select", "publish"))
        self.assertLessEqual(parts, status["total"]["newest_us"])

    @unittest.skipIf(SANITIZED, "a sanitizer keeps what is freed")
    def test_memory_stays_flat_while_frames_come(self):
        # The drive comes again and again, which a camera's pictures do not.
        repeated = self.configure("[camera]\nhealth = false\n")
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 4, "-c", repeated):
            sender = subprocess.Popen([os.path.join(BIN, "vdna"), "play", LIVE, "--rate", "100",
                                       "--loop"], stdout=subprocess.DEVNULL)
            try:
                early = watch.wait_for("status", lambda status: status["processed"] >= 50)
                late = watch.wait_for("status", lambda status: status["processed"] >= 350)
            finally:
                sender.kill()
                sender.wait()
        self.assertLess(late["resident_bytes"] - early["resident_bytes"], 2 << 20)
        self.assertEqual(late["rejected"] + late["refused"], 0)

    def test_signals_end_it_at_once_even_in_the_middle_of_an_inference(self):
        took = []
        for number in (signal.SIGTERM, signal.SIGINT) * 3:
            with Watch() as watch, Selectord("--map", MAP) as daemon:
                sender = subprocess.Popen([os.path.join(BIN, "vdna"), "play", LIVE, "--rate",
                                           "500", "--loop"], stdout=subprocess.DEVNULL)
                try:
                    watch.wait_for("localisation")
                    code, seconds = daemon.stop(number)
                finally:
                    sender.kill()
                    sender.wait()
            self.assertEqual(code, 0, daemon.log)
            took.append(seconds)
        print(f"from signal to exit: median {1000 * statistics.median(took):.0f} ms, at most "
              f"{1000 * max(took):.0f} ms")
        self.assertLess(statistics.median(took), 0.5)

    def test_nobody_has_to_read_what_it_says(self):
        reading, writing = os.pipe()
        os.set_blocking(writing, False)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(writing, b"full" * 1024)
        os.set_blocking(writing, True)  # as a parent leaves it
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 1, errors=writing):
            for frame in range(4):
                vdna("command", "reset")
                vdna("play", LIVE, "--skip", frame, "--frames", 1)
                watch.wait_for("ranking")
        os.close(reading)
        os.close(writing)

    def test_a_signal_ends_it_while_it_starts(self):
        for delay in (0, 0.02, 0.1, 0.2, 0.4):
            process = subprocess.Popen([os.path.join(BIN, "vdna_selectord"), "--map", MAP],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(delay)
            process.terminate()
            self.assertIn(process.wait(20), (0, -signal.SIGTERM))


class Sender:
    """Sends a message ten times a second, until its end."""

    def __init__(self, channel, message):
        self._channel, self._message = channel, message
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._send)

    def _send(self):
        with Camera(self._channel) as camera:
            for number in itertools.count():
                camera.send(self._message(number))
                if self._over.wait(0.1):
                    return

    def __enter__(self):
        self._thread.start()

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()


class Waiting(WithConfiguration):
    """A daemon that gets frames it cannot use, or none: within seconds it says why."""

    work = WORK

    def assert_said(self, words, senders, *options):
        """A status and one line on standard error, no more, have these words."""
        with contextlib.ExitStack() as stack:
            watch = stack.enter_context(Watch())
            daemon = stack.enter_context(Selectord("--map", MAP, *options))
            for sender in senders:
                stack.enter_context(sender)
            watch.wait_for("status", lambda status: words in status["message"], 10)
            watch.collect(2.5)
            # On a busy machine a second may pass without a frame, and so without a verdict.
            said = [status["message"] for status in watch.of("status")[-3:]
                    if words in status["message"]]
            self.assertTrue(said, watch.of("status")[-3:])
            self.assertTrue(daemon.is_running())
        self.assertEqual(len([line for line in daemon.log if words in line]), 1, daemon.log)
        return said[-1]

    def test_nothing_at_all(self):
        said = self.assert_said("nor on any other channel", [])
        self.assertIn("no message on CAMERA for ", said)

    def test_pictures_on_another_channel(self):
        said = self.assert_said("CAMERA_FRONT carries bot_core.image_t at ",
                                [Sender("CAMERA_FRONT", lambda n: image_message(n, next(PICTURES))),
                                 Sender("POSE", lambda n: b"whatever comes")])
        self.assertIn("no message on CAMERA for ", said)
        self.assertIn("set [lcm] camera", said)
        self.assertNotIn("POSE", said)
        rate = float(said.split(" at ")[1].split(" Hz")[0])
        self.assertTrue(5 < rate < 12, said)  # ten a second, on a busy machine less

    def test_anything_on_many_other_channels(self):
        noise = [Sender(f"\x1b[{n}m", lambda n: os.urandom(n % 50)) for n in range(30)]
        said = self.assert_said("none bot_core.image_t", noise)
        self.assertRegex(said, r"; \?\[\d+m carries fingerprint [0-9a-f]{16} at ")
        self.assertNotIn("\x1b", said)

    def test_another_type(self):
        images = bytes.fromhex("20ba4f05e8f5e33a") + b"several pictures"
        said = self.assert_said("found fingerprint 20ba4f05e8f5e33a (bot_core.images_t)",
                                [Sender("CAMERA", lambda n: images)])
        self.assertIn("expected bot_core.image_t", said)

    def test_oversized_frames(self):
        small = self.configure("[lcm]\nmax_image_bytes = 2000\n")
        said = self.assert_said("[lcm] max_image_bytes: found 2001 bytes, expected at most 2000",
                                [Sender("CAMERA", lambda n: image_message(n, b"x" * 2001))],
                                "-c", small)
        self.assertIn("set it to 2001 or more", said)

    def test_frames_that_cannot_be_decoded(self):
        self.assert_said("all frames are refused, the last one because: ",
                         [Sender("CAMERA", lambda n: image_message(n, b"no JPEG"))])

    def test_a_warmup_that_begins_anew_with_every_other_frame(self):
        self.assert_said("the warmup began anew ",
                         [Sender("CAMERA", lambda n: image_message(n % 2 * 10**7 - n * 2 * 10**6, next(PICTURES)))])

    def test_camera_time_that_stands_still(self):
        for options in (["--warmup-seconds", 2], ["--warmup-frames", 3]):
            self.assert_said("camera time has not moved for ",
                             [Sender("CAMERA", lambda n: image_message(0, next(PICTURES)))], *options)

    def test_it_goes_on_when_the_frames_come(self):
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 3):
            watch.wait_for("status", lambda status: status["message"], 10)
            with Sender("CAMERA", lambda n: image_message(n * 100000, next(PICTURES))):
                watch.wait_for("ranking", seconds=10)
                watch.wait_for("status", lambda status: not status["message"], 10)

    def test_without_a_route_every_program_says_the_same(self):
        for command in (["ip", "route", "del", "224.0.0.0/4", "dev", "lo"],
                        ["ip", "link", "set", "lo", "down"]):
            subprocess.run(command, check=True)
            said = {result.stderr.splitlines()[-1].split(": ", 1)[1] for result in (
                selectord("--map", MAP), vdna("watch", "--for", 1, check=False),
                vdna("command", "reset", check=False),
                vdna("play", LIVE, "--frames", 1, check=False)) if result.returncode == 1}
            self.assertEqual(len(said), 1, said)
            self.assertIn("`ip route add 224.0.0.0/4 dev lo`", said.pop())


class Replay(WithConfiguration):
    """A daemon that reads a log."""

    work = WORK

    def setUp(self):
        self.warmup = ["--warmup-frames", WARMUP]
        self.answers = os.path.join(WORK, f"{self.id()}.jsonl")
        if os.path.exists(self.answers):
            os.unlink(self.answers)

    def log(self, channel="CAMERA", stamp=lambda number: number * 100000):
        pictures = jpegs_in(LIVE)
        return lcm_log(os.path.join(WORK, f"{self.id()}.log"),
                       [(channel, image_message(stamp(number), picture))
                        for number, picture in enumerate(pictures)])

    def replay(self, log, *options, speed=0):
        return selectord("--map", MAP, *self.warmup, "-l", f"file://{log}?speed={speed}", *options)

    def read_answers(self):
        with open(self.answers, "rb") as file:
            return file.read()

    def test_keeps_the_same_answers_at_any_speed_and_ends_with_the_log(self):
        files = []
        for speed in (0, 5, 0):
            result = self.replay(self.log(), "--answers", self.answers, speed=speed)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"the log has ended: {FRAMES} frames answered", result.stderr)
            self.assertNotIn("could not be sent", result.stderr)
            files.append(self.read_answers())
        self.assertEqual(files[1:], files[:1] * 2)

        answers = [json.loads(line) for line in files[0].splitlines()]
        positions = [answer for answer in answers if answer["channel"] == "VDNA_LOCALISATION"]
        rankings = [answer for answer in answers if answer["channel"] == "VDNA_RANKING"]
        self.assertEqual(len(positions) + len(rankings), len(answers))
        self.assertEqual([answer["utime"] for answer in positions],
                         [number * 100000 for number in range(FRAMES)])
        self.assertEqual([ranking["ranking"][0]["experience"] for ranking in rankings], ["winter"])

    def test_without_a_file_it_says_once_that_answers_are_not_kept(self):
        result = self.replay(self.log())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("--answers"), 1, result.stderr)
        self.assertNotIn("could not be sent", result.stderr)

    def test_a_log_without_a_frame_to_use_is_an_error_that_names_the_channel(self):
        result = self.replay(self.log("CAMERA_FRONT"), "--answers", self.answers)
        self.assertEqual(result.returncode, 1)
        self.assertIn("CAMERA_FRONT carries bot_core.image_t: set [lcm] camera", result.stderr)

    def test_a_damaged_log_is_read_on_and_ends_in_an_error(self):
        log = self.log()
        with open(log, "rb") as file:
            whole = file.read()
        second = whole.index(b"\xed\xa1\xda\x01", 4)
        third = whole.index(b"\xed\xa1\xda\x01", second + 4)
        for damage in (b"\0" * 28, whole[second:second + 24] + b"\x7f\xff\xff\xff"):
            with open(log, "wb") as file:
                file.write(whole[:second] + damage + whole[second + 28:])
            result = self.replay(log, "--answers", self.answers)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn(f"{FRAMES - 1} frames answered", result.stderr)
            self.assertIn(f": {third - second} bytes of the log are damaged", result.stderr)
        with open(log, "wb") as file:
            file.write(whole + b"\0" * 1000)
        result = self.replay(log, "--answers", self.answers)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"{FRAMES} frames answered", result.stderr)

    def answers_to(self, stamp, *options):
        """The windows of the rankings, and the stamps of the localised frames."""
        result = self.replay(self.log(stamp=stamp), "--answers", self.answers, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        answers = [json.loads(line) for line in self.read_answers().splitlines()]
        return ([answer["window_frames"] for answer in answers if "window_frames" in answer],
                [answer["utime"] for answer in answers if answer["channel"] == "VDNA_LOCALISATION"])

    def test_late_frames_are_not_answered_and_do_not_keep_the_warmup_from_ending(self):
        # Of each six, the third comes after the fourth.
        swapped = {2: 3, 3: 2}
        windows, stamps = self.answers_to(
            lambda number: (number - number % 6 + swapped.get(number % 6, number % 6)) * 33333,
            "-c", self.configure("[select]\nstop_early = false\n"))
        self.assertEqual(windows, [WARMUP])
        self.assertEqual(len(stamps), FRAMES - FRAMES // 6)
        self.assertEqual(stamps, sorted(stamps))

    def test_stamps_in_another_unit_fill_a_warmup_in_seconds(self):
        begin = 1_700_000_000
        for stamp in (lambda number: begin * 10**9 + number * 10**8,
                      lambda number: begin * 10**3 + number * 10**2,
                      lambda number: begin + number // 10):
            with self.subTest(first=stamp(0)):
                # The other units are known from the ninth frame on, or the first one that differs.
                self.warmup = ["--warmup-seconds", 1]
                windows, _ = self.answers_to(stamp)
                self.assertEqual(windows, [10])

    def test_a_full_disk_is_an_error(self):
        result = self.replay(self.log(), "--answers", "/dev/full")
        self.assertEqual(result.returncode, 1)
        self.assertIn("/dev/full: cannot be written: No space left on device", result.stderr)

    def test_a_file_of_something_else_is_not_overwritten(self):
        log = self.log()
        before = os.path.getsize(log)
        result = self.replay(log, "--answers", log)
        self.assertEqual(result.returncode, 1)
        self.assertIn(f"{log}: exists and holds no answers", result.stderr)
        self.assertEqual(os.path.getsize(log), before)

    def test_a_live_daemon_keeps_what_the_watch_shows(self):
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--warmup-frames", 3, "--answers", self.answers) as daemon:
            for utime in range(5):
                camera.send_jpeg(utime, next(PICTURES))
                watch.wait_for("localisation")
            watch.wait_for("status", has_answered(5))
            daemon.stop()
        kept = [json.loads(line) for line in self.read_answers().splitlines()]
        self.assertEqual(kept[:len(watch.messages)], watch.messages)
        self.assertEqual({message["channel"] for message in kept},
                         {"VDNA_RANKING", "VDNA_LOCALISATION", "VDNA_STATUS"})

    def test_a_live_daemon_survives_a_full_disk(self):
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", MAP, "--answers", "/dev/full") as daemon:
            watch.wait_for("status")
            camera.send_jpeg(1, next(PICTURES))
            watch.wait_for("localisation")
        self.assertTrue(any("No space left" in line and "not kept" in line for line in daemon.log),
                        daemon.log)


class Onlooker(unittest.TestCase):
    """`vdna watch` without a daemon."""

    def test_a_reader_who_takes_his_time_loses_nothing(self):
        sent = 900  # a pipe holds about 200, LCM alone would keep 30
        with Camera("VDNA_LOCALISATION") as daemon, subprocess.Popen(
                [os.path.join(BIN, "vdna"), "watch", "--json", "--until", f"localisation:{sent}",
                 "--for", "20"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                text=True) as watch:
            self.assertIn("listening", watch.stderr.readline())
            for utime in range(sent):
                daemon.send(localisation_message(utime))
                time.sleep(0.0005)
            lines = watch.communicate()[0].splitlines()
        self.assertEqual([json.loads(line)["utime"] for line in lines], list(range(sent)))

    def test_two_datagrams_that_ended_lcm_end_nothing(self):
        with Watch() as watch, Camera("VDNA_LOCALISATION") as daemon:
            for number, offset, data in ((0, 0, b"VDNA_LOCALISATION\0" + b"x" * 100),
                                         (1, 0xffffff00, b"y" * 0x200)):  # the offset wraps
                daemon.send_datagram(struct.pack(">IIIIHH", 0x4C433033, 7, 100000, offset, number, 3)
                                     + data)
            daemon.send(b"no localisation")
            daemon.send(localisation_message(5))
            self.assertEqual(watch.wait_for("localisation")["utime"], 5)

    def test_a_log_is_shown_to_its_end(self):
        log = lcm_log(os.path.join(WORK, "answers.log"),
                      [("VDNA_LOCALISATION", localisation_message(utime)) for utime in range(3)])
        result = vdna("watch", "--json", "-l", f"file://{log}?speed=0")
        self.assertEqual([json.loads(line)["utime"] for line in result.stdout.splitlines()],
                         [0, 1, 2])


class CommandLine(WithConfiguration):
    """Runs that end by themselves."""

    work = WORK

    def assert_refused(self, text, place, *words):
        """The daemon exits with code 2 and a line that names the place in the configuration."""
        path = self.configure(text)
        result = selectord("-c", path)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertTrue(result.stderr.startswith(f"vdna_selectord: {path}:{place}: "),
                        result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1)
        for word in words:
            self.assertIn(word, result.stderr)

    def test_mistakes_in_the_configuration_are_named_with_their_place(self):
        self.assert_refused("[map]\ndirectry = 'x'\n", "2:1", "'directry'", "directory")
        self.assert_refused("[warmup]\nframes = 'many'\n", "2:10", "'many'", "an integer")
        self.assert_refused("[warmup]\nframes = 0\n", "2:10", "is 0", "from 1")
        self.assert_refused("[warmup]\nframes = 5\nseconds = 1.5\n", "3:11", "both")
        self.assert_refused("[kamera]\n", "1:2", "'kamera'", "[camera]")
        self.assert_refused("[camera]\nstale_seconds = -1\n", "2:17", "is -1", "from 0.0")
        self.assert_refused("[lcm]\ncamera = ''\n", "2:10", "1 to 63 bytes")
        self.assert_refused("[lcm\n", "1:5", "TOML")
        self.assert_refused("[memory]\nlock = 1\n", "2:8", "is 1", "true or false")
        self.assert_refused("[memory]\nbudget_mb = -1\n", "2:13", "is -1", "from 0")
        self.assert_refused("[select]\ntop = 0\n", "2:7", "is 0", "from 1")
        self.assert_refused("[select]\nrank = 'fd'\n", "2:8", '"fd"', '"transfer" or "emd"')
        self.assert_refused("[select]\nmin_recall = 1.1\n", "2:14", "is 1.1", "from 0.0 to 1.0")
        self.assert_refused("[select]\nswitch_cost = 0\n", "2:15", "is 0", "from 1.0")
        self.assert_refused("[select]\nreselect = 1\n", "2:12", "is 1", "true or false")
        self.assert_refused("[localise]\nmin_confidence = 1.5\n", "2:18", "is 1.5", "from 0.0 to 1.0")
        self.assert_refused("[localise]\nmin_confidence = nan\n", "2:18", "is nan", "a number")
        self.assert_refused("[localise]\ntolerance = -1\n", "2:13", "is -1", "from 0.0")
        self.assert_refused("[localise]\nfilter = 'no'\n", "2:10", "is 'no'", "true or false")
        self.assert_refused("[cpu]\nnice = 20\n", "2:8", "is 20", "from -20 to 19")
        self.assert_refused("[cpu]\naffinity = 1\n", "2:12", "is 1", "a string")

    def test_a_configuration_that_cannot_be_read_is_named(self):
        result = selectord("-c", os.path.join(WORK, "none.toml"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("none.toml: cannot be read: No such file", result.stderr)
        fifo = os.path.join(WORK, "fifo.toml")
        with contextlib.suppress(FileExistsError):
            os.mkfifo(fifo)
        for path in (fifo, WORK):
            result = selectord("-c", path)
            self.assertEqual(result.returncode, 2)
            self.assertIn(path + ": is no regular file", result.stderr)
        result = selectord("-c", "")
        self.assertEqual(result.returncode, 2)
        self.assertIn(": cannot be read: No such file", result.stderr)

    def test_sources_that_are_no_addresses_are_refused(self):
        for sources in ("10.0.0", "10.0.0.2,robot", "10.0.0.2,,10.0.0.3"):
            result = selectord("--map", MAP, "-c", self.configure(f"[lcm]\nsources = '{sources}'\n"))
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("is no IPv4 address such as", result.stderr)

    def test_two_channels_of_one_name_are_refused(self):
        result = selectord("-c", self.configure("[lcm]\ncamera = 'A'\nstatus = 'A'\n"))
        self.assertEqual(result.returncode, 2)
        self.assertIn('[lcm] camera and status are both "A"', result.stderr)

    def test_the_printed_configuration_is_accepted_and_printed_again(self):
        printed = selectord("--map", "/a 'quoted' \"path\"\\", "--warmup-seconds", 2.5, "-l",
                            "udpm://239.255.76.67:7667?ttl=0", "--print-config")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertIn("seconds = 2.5", printed.stdout)
        self.assertNotIn("\nframes =", printed.stdout)
        again = selectord("-c", self.configure(printed.stdout), "--print-config")
        self.assertEqual(again.stdout, printed.stdout)

    def test_options_override_the_file(self):
        path = self.configure("[map]\ndirectory = '/file'\n[warmup]\nseconds = 5\n")
        printed = selectord("--warmup-frames", 7, "-c", path, "--print-config").stdout
        self.assertIn('directory = "/file"', printed)
        self.assertIn("frames = 7", printed)
        self.assertNotIn("\nseconds", printed)

    def test_check_opens_everything_but_the_network(self):
        result = selectord("--map", MAP, "--check", "-l", "nonsense://")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue(result.stdout.startswith(f"OK: {MAP}: 3 experiences"), result.stdout)

    def test_a_map_of_another_backbone_is_refused(self):
        for option in ([], ["--check"]):
            result = selectord("--map", MAP, "--backbone", "mobilenet_v2", *option)
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            for word in (MAP, "efficientnet_lite0", "mobilenet_v2", "vdna build"):
                self.assertIn(word, result.stderr)

    def test_a_missing_map_is_refused(self):
        result = selectord("--map", os.path.join(WORK, "nowhere"), "--check")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("nowhere", result.stderr)

    def test_a_network_that_cannot_be_joined_is_refused(self):
        result = selectord("--map", MAP, "-l", "nonsense://")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("nonsense://", result.stderr)

    def test_version_and_help_are_answered(self):
        self.assertRegex(selectord("--version").stdout, r"^vdna_selectord \d+\.\d+\.\d+\n$")
        answer = selectord("--help")
        self.assertEqual(answer.returncode, 0)
        self.assertIn("Exit codes", answer.stdout)
        self.assertEqual(selectord("--unknown").returncode, 2)


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
