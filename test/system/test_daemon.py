"""System test of vdna_selectord: real daemon, real network, real LCM, simulated pictures.

Environment: VDNA_BIN (folder of the programs), VDNA_MODELS (folder of the backbones).
Works in the current directory; an existing map is reused.
"""
import json
import os
import shutil
import signal
import statistics
import subprocess
import time
import unittest

import own_network
from selectord import (BIN, Camera, Selectord, Watch, WithConfiguration, image_message,
                       localisation_message, selectord, vdna, vdna_json)

WORK = os.path.abspath("daemon")
MAP = os.path.join(WORK, "map")
LIVE = os.path.join(WORK, "live")
CONDITIONS = ["summer", "winter", "night"]
FRAMES = 24   # of the live drive
WARMUP = 12   # of them
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


def first_picture():
    name = sorted(name for name in os.listdir(LIVE) if name.endswith(".jpg"))[0]
    with open(os.path.join(LIVE, name), "rb") as file:
        return file.read()


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

    def test_says_what_rank_and_localise_say(self):
        said = self.drive("--warmup-frames", WARMUP)
        answers = said.of("localisation")
        self.assertEqual([answer["validity"] for answer in answers],
                         ["WARMING_UP"] * WARMUP + ["VALID"] * (FRAMES - WARMUP))

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
        fields = ("utime", "experience", "frame", "frame_utime", "distance")
        self.assertEqual([[answer[field] for field in fields] for answer in answers[WARMUP:]],
                         [[match[field] for field in fields] for match in matches])

    def test_warms_up_for_a_time(self):
        said = self.drive("--warmup-seconds", 0.75)
        # Stamps are 0.0, 0.1, ... 0.7; the frame of 0.8 completes the window and is localised.
        self.assertEqual(said.of("ranking")[0]["window_frames"], 8)
        self.assertEqual([answer["validity"] for answer in said.of("localisation")],
                         ["WARMING_UP"] * 8 + ["VALID"] * (FRAMES - 8))

    def test_a_reset_command_makes_it_choose_again(self):
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 4) as daemon:
            vdna("play", LIVE, "--frames", 12)
            watch.wait_for("ranking")
            vdna("command", "reset")
            watch.wait_for("status", lambda status: status["state"] == "WARMUP")
            vdna("play", LIVE, "--frames", 12)
            watch.wait_for("ranking")
            watch.wait_for("status", lambda status: status["state"] == "SELECTED")
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
            camera.send_jpeg(5, first_picture())
            self.assertEqual(watch.wait_for("localisation")["utime"], 5)
            self.assertTrue(daemon.is_running())
        self.assertEqual(watch.of("status")[-1]["received"], 0)

    def test_a_picture_that_cannot_be_decoded_is_answered_refused(self):
        picture = first_picture()
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
            for utime in (10, 20, 5, 6, 7):
                camera.send_jpeg(utime, first_picture())
                watch.wait_for("localisation")
            status = watch.wait_for("status", has_answered(5))
        self.assertEqual(status["restarts"], 1)
        self.assertEqual([(ranking["window_begin_utime"], ranking["utime"])
                          for ranking in watch.of("ranking")], [(5, 7)])

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
                    camera.send_jpeg(utime, first_picture() if utime % 10 else b"no JPEG")
                time.sleep(0.002)  # faster than any network
            watch.wait_for("status", has_answered(sent))
            camera.send_jpeg(sent, first_picture())
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

    def test_the_status_tells_how_long_the_stages_take(self):
        with Watch() as watch, Camera() as camera, Selectord("--map", MAP, "--warmup-frames", 3):
            for utime in range(8):
                camera.send_jpeg(utime, first_picture())
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

    def test_memory_stays_flat_while_frames_come(self):
        with Watch() as watch, Selectord("--map", MAP, "--warmup-frames", 4):
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

    def test_a_signal_ends_it_while_it_starts(self):
        for delay in (0, 0.02, 0.1):
            process = subprocess.Popen([os.path.join(BIN, "vdna_selectord"), "--map", MAP],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(delay)
            process.terminate()
            self.assertIn(process.wait(20), (0, -signal.SIGTERM))


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
        self.assert_refused("[camera]\n", "1:2", "'camera'", "[lcm]")
        self.assert_refused("[lcm]\ncamera = ''\n", "2:10", "1 to 63 bytes")
        self.assert_refused("[lcm\n", "1:5", "TOML")
        self.assert_refused("[memory]\nlock = 1\n", "2:8", "is 1", "true or false")
        self.assert_refused("[memory]\nbudget_mb = -1\n", "2:13", "is -1", "from 0")
        self.assert_refused("[cpu]\nnice = 20\n", "2:8", "is 20", "from -20 to 19")
        self.assert_refused("[cpu]\naffinity = 1\n", "2:12", "is 1", "a string")

    def test_a_configuration_that_cannot_be_read_is_named(self):
        result = selectord("-c", os.path.join(WORK, "none.toml"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("none.toml: cannot be read: No such file", result.stderr)

    def test_the_printed_configuration_is_accepted_and_printed_again(self):
        printed = selectord("--map", "/a 'quoted' \"path\"\\", "--warmup-seconds", 2.5, "-l",
                            "udpm://239.255.76.67:7667?ttl=0", "--print-config")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        self.assertIn("seconds = 2.5", printed.stdout)
        self.assertNotIn("frames", printed.stdout)
        again = selectord("-c", self.configure(printed.stdout), "--print-config")
        self.assertEqual(again.stdout, printed.stdout)

    def test_options_override_the_file(self):
        path = self.configure("[map]\ndirectory = '/file'\n[warmup]\nseconds = 5\n")
        printed = selectord("--warmup-frames", 7, "-c", path, "--print-config").stdout
        self.assertIn("directory = '/file'", printed)
        self.assertIn("frames = 7", printed)
        self.assertNotIn("seconds", printed)

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
