"""Why one experience and not another: `vdna explain`, recomputed here from the experience files in plain
Python, and the reasons in the daemon's ranking.

Environment: VDNA_BIN (folder of the programs).
"""
import base64
import json
import math
import os
import shutil
import tempfile
import unittest
from pathlib import Path

import own_network
from selectord import WithConfiguration, image_message, jpegs_in, lcm_log, selectord, vdna, vdna_json
from test_cli import PAPERS, Experience

NAMES = "summer", "winter", "night"
FRAMES, WARMUP = 24, 15
EXACT = 1e-9  # bins


def simulate(folder, condition, drive, frames):
    vdna("simulate", folder, "--condition", condition, "--drive", drive, "--frames", frames, "--step", 2,
         "--variation", 0.6, "--size", "128x96")


def emds(live, other):
    """The distance of each neuron, in bins."""
    distances = []
    for neuron in range(live.neurons):
        p, q = live.row(neuron), other.row(neuron)
        mass_p, mass_q = sum(p), sum(q)
        apart = total = 0
        for b in range(live.bins - 1):
            apart += p[b] * mass_q - q[b] * mass_p
            total += abs(apart)
        distances.append(total / (mass_p * mass_q))
    return distances


def mean_bin(experience, neuron):
    row = experience.row(neuron)
    return sum(b * count for b, count in enumerate(row)) / sum(row)


def example_frames(experience, neuron):
    """The frames with most and least of it; of several with least, the farthest from that with most."""
    codes = experience.tensors["frame_last_layer"][neuron::experience.neurons]
    values = [code * scale for code, scale in zip(codes, experience.tensors["frame_last_layer_scale"])]
    most = values.index(max(values))
    least = max((f for f, value in enumerate(values) if value == min(values)), key=lambda f: (abs(f - most), -f))
    return {"most": most, "least": least}


def thumbnail(experience, frame):
    ends = [0] + experience.tensors["frame_thumbnail_end"]
    return bytes(experience.tensors["thumbnails"][ends[frame]:ends[frame + 1]])


class Explain(WithConfiguration):
    @classmethod
    def setUpClass(cls):
        folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vdna-explain-")))
        cls.work, cls.map, cls.live = folder, folder / "map", folder / "live"
        for i, name in enumerate(NAMES):
            simulate(folder / name, name, i, FRAMES)
        simulate(cls.live, "winter", 9, WARMUP)
        vdna("build", cls.map, *(folder / name for name in NAMES))
        # The live run counted with the ranges of the map.
        shutil.copytree(cls.map, folder / "with_live")
        vdna("build", folder / "with_live", cls.live)
        cls.files = {name: Experience(folder / "with_live" / (name + ".vdna")) for name in (*NAMES, "live")}

    def explain(self, *options, live=None, world=None):
        return vdna_json("explain", live or self.live, world or self.map, "--warmup", WARMUP, *options)

    def refuse(self, *arguments):
        """The complaint."""
        done = vdna("explain", *arguments, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stdout, "")
        return done.stderr

    def test_contributions_are_those_of_the_files_and_sum_to_the_margin(self):
        told = self.explain("--top", 10000)
        ranking = vdna_json("rank", self.live, self.map, "--warmup", WARMUP)
        first, second = (entry["experience"] for entry in ranking["ranking"][:2])
        self.assertEqual((told["winner"], told["against"]), (first, second))
        self.assertEqual(told["winner"], "winter")
        self.assertEqual(told["no_example_frames"], "")
        reasons, neurons = told["reasons"], told["neurons"]
        self.assertEqual(sorted(reason["neuron"] for reason in reasons), list(range(neurons)))
        for part, whole in (("margin_bins", ranking["margin_bins"]),
                            ("winner_bins", ranking["ranking"][0]["distance_bins"]),
                            ("against_bins", ranking["ranking"][1]["distance_bins"])):
            self.assertAlmostEqual(math.fsum(reason[part] for reason in reasons), whole, delta=EXACT)
            self.assertAlmostEqual(told[part], whole, delta=EXACT)
            self.assertAlmostEqual(math.fsum(tap[part] for tap in told["taps"]), whole, delta=EXACT)
        magnitudes = [abs(reason["margin_bins"]) for reason in reasons]
        self.assertEqual(magnitudes, sorted(magnitudes, reverse=True))

        live, winner, against = (self.files[name] for name in ("live", first, second))
        nearer, farther = emds(live, winner), emds(live, against)
        for reason in reasons:
            neuron = reason["neuron"]
            self.assertAlmostEqual(reason["winner_bins"], nearer[neuron] / neurons, delta=EXACT)
            self.assertAlmostEqual(reason["margin_bins"], (farther[neuron] - nearer[neuron]) / neurons, delta=EXACT)
        for reason in reasons[:20] + reasons[-20:]:
            for who, experience in (("live", live), ("winner", winner), ("against", against)):
                self.assertAlmostEqual(reason[who + "_mean_bin"], mean_bin(experience, reason["neuron"]), delta=EXACT)
            self.assertEqual(reason["winner_frames"], example_frames(winner, reason["neuron"]))
            self.assertEqual(reason["against_frames"], example_frames(against, reason["neuron"]))

    def test_a_person_reads_the_choice_then_the_margin_then_the_neurons(self):
        told = self.explain()
        lines = vdna("explain", self.live, self.map, "--warmup", WARMUP).stdout.splitlines()
        self.assertEqual(lines[0], told["sentence"])
        self.assertRegex(lines[1], rf"^winter is {told['margin_bins']:.2f} bins nearer than {told['against']}: "
                                   r"5 of 1280 neurons make -?\d+ % of it$")
        self.assertRegex(lines[4], rf"^embedding +{told['reasons'][0]['neuron']} +-?\d\.\d{{4}} ")
        self.assertEqual(len(told["reasons"]), 5)

    def test_any_two_can_be_compared_in_either_order(self):
        told = self.explain("--against", "night")
        back = self.explain("--winner", "night", "--against", "winter")
        self.assertEqual((told["winner"], back["winner"]), ("winter", "night"))
        self.assertAlmostEqual(told["margin_bins"], -back["margin_bins"], delta=EXACT)
        self.assertEqual([r["neuron"] for r in told["reasons"]], [r["neuron"] for r in back["reasons"]])
        text = vdna("explain", self.live, self.map, "--warmup", WARMUP, "--winner", "night").stdout
        self.assertRegex(text, r"\nnight is [0-9.]+ bins farther than winter: ")

    def test_the_page_shows_frames_of_all_three_and_fetches_nothing(self):
        page = self.work / "why.html"
        told = self.explain("--html", page)
        html = page.read_text(encoding="utf-8")
        self.assertIn("Why winter and not " + told["against"], html)
        for whose in ("live", "winter", told["against"]):
            for extreme in ("most", "least"):
                self.assertEqual(html.count(f'alt="{whose}, {extreme}"'), len(told["reasons"]), whose)
        first = told["reasons"][0]["winner_frames"]["most"]
        self.assertIn(base64.b64encode(thumbnail(self.files["winter"], first)).decode(), html)
        self.assertNotIn('src="http', html)

    def test_a_log_has_pictures_of_its_frames_too(self):
        page = self.work / "of_log.html"
        _, log = self.replay(self.map)
        told = self.explain("--html", page, live=log)
        self.assertEqual(page.read_text(encoding="utf-8").count('alt="live, most"'), len(told["reasons"]))

    def test_a_map_without_thumbnails_has_numbers_alone(self):
        page, world = self.work / "numbers.html", self.work / "no_thumbnails"
        vdna("build", "--no-thumbnails", world, self.work / "summer", self.work / "winter")
        self.explain("--html", page, world=world)
        html = page.read_text(encoding="utf-8")
        self.assertIn('alt="live, most"', html)
        self.assertNotIn('alt="winter, most"', html)

    def test_a_network_that_counts_another_layer_gives_no_example_frames_and_says_why(self):
        world = self.work / "papers"
        vdna("build", "--backbone", PAPERS, world, self.work / "summer", self.work / "winter")
        told = self.explain(world=world)
        self.assertIsNone(told["reasons"][0]["winner_frames"])
        self.assertIn("no example frames: ", told["no_example_frames"])
        text = vdna("explain", self.live, world, "--warmup", WARMUP).stdout
        self.assertIn(told["no_example_frames"], text)

    def test_what_cannot_be_explained_is_refused_with_the_reason(self):
        empty = self.work / "empty"
        empty.mkdir()
        self.assertIn(str(empty), self.refuse(empty, self.map))
        self.assertIn("ends after 15 frames of the warmup, expected 16 frames", self.refuse(self.live, self.map, "--warmup", 16))
        alone = self.work / "alone"
        alone.mkdir()
        shutil.copy(self.map / "winter.vdna", alone)
        short = "--warmup", WARMUP
        self.assertIn("there is only one experience to choose, winter", self.refuse(self.live, alone, *short))
        self.assertIn("only one experience", self.refuse(self.live, self.map, "--exclude", "summer", "night", *short))
        self.assertIn("expected one of night, summer, winter", self.refuse(self.live, self.map, "--winner", "dusk", *short))
        self.assertIn("both winter", self.refuse(self.live, self.map, "--winner", "winter", "--against", "winter", *short))
        self.assertIn(PAPERS, self.refuse(self.live, self.map, "--backbone", PAPERS, *short))

    def replay(self, world):
        """The daemon's ranking by a log of the live run, after all of the warmup like `vdna rank`, and the log."""
        log = lcm_log(self.work / f"{world.name}.log", [("CAMERA", image_message(number * 100000, picture))
                                                        for number, picture in enumerate(jpegs_in(self.live))])
        answers = self.work / f"{world.name}.jsonl"
        done = selectord("--map", world, "--warmup-frames", WARMUP, "-l", f"file://{log}?speed=0", "--answers", answers,
                         "-c", self.configure("[camera]\nhealth = false\n[select]\nstop_early = false\n"))
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [json.loads(line) for line in answers.read_text().splitlines()]
        ranking, = (line for line in lines if line["type"] == "ranking")
        return ranking, log

    def test_the_daemon_gives_the_same_reasons_for_the_same_log(self):
        ranking, log = self.replay(self.map)
        told = self.explain(live=log)
        self.assertEqual([entry["experience"] for entry in ranking["ranking"][:2]], [told["winner"], told["against"]])
        self.assertEqual(ranking["neurons"], told["neurons"])
        self.assertEqual(len(ranking["reasons"]), 5)
        for sent, ours in zip(ranking["reasons"], told["reasons"]):
            self.assertEqual((sent["tap"], sent["neuron"]), (ours["tap"], ours["neuron"]))
            for a, b in (("bins", "margin_bins"), ("live_bin", "live_mean_bin"), ("winner_bin", "winner_mean_bin"),
                         ("runner_up_bin", "against_mean_bin")):
                self.assertAlmostEqual(sent[a], ours[b], delta=EXACT)
            self.assertEqual((sent["winner_most"], sent["winner_least"]), tuple(ours["winner_frames"].values()))
            self.assertEqual((sent["runner_up_most"], sent["runner_up_least"]), tuple(ours["against_frames"].values()))

    def test_the_daemon_gives_no_reasons_for_the_only_experience(self):
        world = self.work / "single"
        world.mkdir()
        shutil.copy(self.map / "winter.vdna", world)
        self.assertEqual(self.replay(world)[0]["reasons"], [])


if __name__ == "__main__":
    own_network.enter()
    unittest.main()
