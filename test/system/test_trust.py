"""What the daemon says of its choice: how sure it is, that none fits, that it has settled, and that
it chose another experience on the way. Rendered drives, mostly as replays of logs.

Environment: VDNA_BIN (folder of the programs), VDNA_MODELS (folder of the backbones).
Works in the current directory; existing maps are reused.
"""
import json
import os
import shutil
import signal

import own_network
from selectord import (Camera, Selectord, Watch, WithConfiguration, image_message, jpegs_in, lcm_log,
                       selectord, vdna)

WORK = os.path.abspath("trust")
DAYS = ["summer", "autumn", "overcast"]
DAY, MIXED = os.path.join(WORK, "day_map"), os.path.join(WORK, "mixed_map")
AGAIN, SNOW, NIGHT = (os.path.join(WORK, name) for name in ("again", "in_snow", "at_night"))
FRAMES = 60
WARMUP = 40  # of them


def simulate(path, condition, *options):
    vdna("simulate", path, "--condition", condition, "--frames", FRAMES, *options)


def prepare():
    """Two maps, and drives on another day."""
    if os.path.exists(NIGHT):
        return
    shutil.rmtree(WORK, ignore_errors=True)
    for condition in (*DAYS, "night"):
        simulate(os.path.join(WORK, condition), condition)
    vdna("build", DAY, *[os.path.join(WORK, day) for day in DAYS])
    vdna("build", MIXED, *[os.path.join(WORK, name) for name in ("summer", "autumn", "night")])
    simulate(AGAIN, "summer", "--drive", 7, "--variation", 0.5)
    simulate(SNOW, "winter", "--drive", 7, "--variation", 0.5)
    simulate(NIGHT + ".part", "night", "--drive", 7, "--variation", 0.5)
    os.rename(NIGHT + ".part", NIGHT)


def choices(answers):
    return [answer for answer in answers if answer["type"] == "ranking"]


def places(answers):
    """The answers after the warmup."""
    return [answer for answer in answers
            if answer["type"] == "localisation" and answer["validity"] != "WARMING_UP"]


class Drives(WithConfiguration):

    work = WORK

    def replay(self, route, *drives, settings=""):
        """All answers to these drives, one after the other, and what the daemon said meanwhile."""
        pictures = [picture for drive in drives for picture in jpegs_in(drive)]
        path = os.path.join(WORK, self.id())
        log = lcm_log(path + ".log", [("CAMERA", image_message(number * 100000, picture))
                                      for number, picture in enumerate(pictures)])
        if os.path.exists(path + ".jsonl"):
            os.unlink(path + ".jsonl")
        result = selectord("--map", route, "--warmup-frames", WARMUP, "-l", f"file://{log}?speed=0",
                           "--answers", path + ".jsonl", "-c", self.configure(settings))
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(path + ".jsonl", encoding="utf-8") as file:
            return [json.loads(line) for line in file], result.stderr


class Choice(Drives):

    def test_a_night_drive_on_a_map_of_days_fits_none(self):
        answers, said = self.replay(DAY, NIGHT)
        for choice in choices(answers):
            self.assertEqual((choice["validity"], choice["verdict"]), ("NONE_FITS", "unlike"))
            self.assertGreater(choice["unlike"], 0.1)
            self.assertEqual([entry["predicted_recall"] for entry in choice["ranking"]], [None] * 3)
        self.assertGreater(len(places(answers)), 0)
        for answer in places(answers):
            self.assertEqual(answer["validity"], "NONE_FITS")
            self.assertIn("none of 3 experiences looks like this run", answer["reason"])
            self.assertIn("record one now with `vdna build`", answer["reason"])
            self.assertIsNotNone(answer["frame"])
            self.assertIsNone(answer["predicted_recall"])
        self.assertIn(places(answers)[0]["reason"], said)

    def test_a_second_day_of_the_same_look_fits_and_has_a_prediction(self):
        answers, said = self.replay(DAY, AGAIN)
        choice, = choices(answers)
        self.assertEqual((choice["validity"], choice["verdict"]), ("VALID", ""))
        self.assertEqual((choice["no_prediction"], choice["previous"]), ("", ""))
        best = choice["ranking"][0]
        self.assertEqual(best["experience"], "summer")
        self.assertTrue(0 <= best["predicted_low"] <= best["predicted_recall"] <=
                        best["predicted_high"] <= 1, best)
        for answer in places(answers):
            self.assertIn(answer["validity"], ("VALID", "UNSURE"))
            self.assertEqual(answer["predicted_recall"], best["predicted_recall"])
        self.assertIn("selected summer of 3 after ", said)
        self.assertIn(f": expects {100 * best['predicted_recall']:.0f} % (", said)

    def test_too_little_predicted_recall_fits_none_if_that_is_wanted(self):
        strict = os.path.join(WORK, f"{self.id()}.map")
        shutil.copytree(DAY, strict, dirs_exist_ok=True)
        vdna("calibrate", "--trust", strict, "--tolerance", 0)
        answers, _ = self.replay(strict, SNOW, settings="[select]\nmin_recall = 1\n")
        self.assertEqual(choices(answers)[0]["verdict"], "poor")
        first = places(answers)[0]
        self.assertEqual(first["validity"], "NONE_FITS")
        self.assertIn("is good enough: the best, ", first["reason"])
        self.assertIsNotNone(first["predicted_recall"])

    def test_a_choice_that_has_settled_does_not_wait_for_the_whole_warmup(self):
        early = choices(self.replay(DAY, AGAIN)[0])[0]
        whole = choices(self.replay(DAY, AGAIN, settings="[select]\nstop_early = false\n")[0])[0]
        self.assertEqual(early["ranked_by"], "transfer")
        self.assertEqual(early["settled_frames"], early["window_frames"])
        self.assertTrue(20 <= early["window_frames"] < WARMUP, early["window_frames"])
        self.assertEqual((whole["settled_frames"], whole["window_frames"]), (0, WARMUP))
        self.assertEqual(whole["ranked_by"], "transfer")
        self.assertEqual(early["ranking"][0]["experience"], whole["ranking"][0]["experience"])

    def test_the_paper_is_one_setting_away(self):
        choice = choices(self.replay(DAY, AGAIN, settings="[select]\nrank = 'emd'\n"
                                     "stop_early = false\nreselect = false\n")[0])[0]
        self.assertEqual(choice["ranked_by"], "emd")
        distances = [entry["distance_bins"] for entry in choice["ranking"]]
        self.assertEqual(distances, sorted(distances))

    def test_another_light_on_the_way_brings_another_choice(self):
        answers, said = self.replay(MIXED, AGAIN, NIGHT)
        first, *switches = choices(answers)
        self.assertEqual((first["ranking"][0]["experience"], first["previous"]), ("summer", ""))
        self.assertEqual([(choice["ranking"][0]["experience"], choice["previous"])
                          for choice in switches], [("night", "summer")])
        self.assertEqual([entry["predicted_recall"] for entry in switches[0]["ranking"]], [None] * 3)
        self.assertEqual(places(answers)[-1]["experience"], "night")
        self.assertIsNone(places(answers)[-1]["predicted_recall"])
        self.assertIn("selected summer of 3 after ", said)
        for settings in ("[select]\nreselect = false\n", "[localise]\nfilter = false\n",
                         "[select]\nswitch_cost = 1000\n"):
            answers, _ = self.replay(MIXED, AGAIN, NIGHT, settings=settings)
            self.assertEqual(len(choices(answers)), 1, settings)
            self.assertEqual(places(answers)[-1]["experience"], "summer", settings)


class OwnFile(Drives):
    """Maps without their own file, with a stale one or a damaged one."""

    def setUp(self):
        self.map = os.path.join(WORK, f"{self.id()}.map")
        shutil.rmtree(self.map, ignore_errors=True)
        shutil.copytree(DAY, self.map)
        self.file = os.path.join(self.map, "trust.safetensors")

    def assert_no_prediction(self, *words):
        answers, said = self.replay(self.map, AGAIN)
        line, = [line for line in said.splitlines() if "no recall is predicted: " in line]
        choice = choices(answers)[0]
        for word in (*words, f"`vdna calibrate --trust {self.map}`"):
            self.assertIn(word, line)
            self.assertIn(word, choice["no_prediction"])
        self.assertEqual((choice["validity"], choice["ranking"][0]["experience"]),
                         ("VALID", "summer"))
        self.assertEqual((choice["window_frames"], choice["ranked_by"]), (WARMUP, "emd"))
        self.assertIsNone(choice["unlike"])
        self.assertIn(places(answers)[-1]["validity"], ("VALID", "UNSURE"))

    def test_none(self):
        os.unlink(self.file)
        self.assert_no_prediction("there is no such file")

    def test_stale(self):
        before = self.file + ".before"
        shutil.copyfile(self.file, before)
        vdna("build", self.map, os.path.join(WORK, "night"))
        os.rename(before, self.file)
        self.assert_no_prediction("night")

    def test_damaged(self):
        os.truncate(self.file, os.path.getsize(self.file) - 1)
        self.assert_no_prediction("cut short")

    def test_a_reload_brings_it(self):
        os.unlink(self.file)
        pictures, numbers = jpegs_in(AGAIN), iter(range(1000))
        with Watch() as watch, Camera() as camera, \
                Selectord("--map", self.map, "--warmup-frames", 12) as daemon:
            def next_choice():
                while True:
                    number = next(numbers)
                    seen = len(watch.of("ranking"))
                    camera.send_jpeg(number * 100000, pictures[number % FRAMES])
                    watch.wait_for("localisation",
                                   lambda answer: answer["utime"] == number * 100000)
                    if len(watch.of("ranking")) > seen:
                        return watch.of("ranking")[-1]
            self.assertIn("--trust", next_choice()["no_prediction"])
            vdna("calibrate", "--trust", self.map)
            os.kill(daemon.pid, signal.SIGHUP)
            watch.wait_for("status", lambda status: status["experience"] == "")  # STALE by then, perhaps
            choice = next_choice()
            self.assertEqual(choice["no_prediction"], "")
            status = watch.wait_for("status", lambda status: status["experience"] != "")
        self.assertEqual(status["predicted_recall"], choice["ranking"][0]["predicted_recall"])
        self.assertEqual(status["settled_frames"], choice["settled_frames"])


if __name__ == "__main__":
    own_network.run_tests_apart(prepare)
