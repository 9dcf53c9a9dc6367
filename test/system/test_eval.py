"""`vdna eval` against an independent computation in NumPy, on rendered and on real pictures.

Everything is recomputed by definition from the exported embeddings, grey levels, places and
positions: recalls must agree exactly, Earth Mover's Distances within 1e-9, Frechet distances within
1e-6. The activations of the default backbone are its embeddings. Real pictures may not be
published; tests on them are skipped if VDNA_SHARED does not have them.
"""

import hashlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

VDNA = Path(os.environ["VDNA_BIN"]) / "vdna"
DATA = Path(os.environ["VDNA_SHARED"]) / "data"
sys.path.insert(0, str(DATA.parent / "reference"))
try:
    import predict
except ImportError:
    predict = None


def vdna(*arguments, **options):
    return subprocess.run([str(VDNA), *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, check=False, **options)


def write_picture(path, seed, width=48, height=32, backdrop=None):
    """A binary PPM of random rectangles, on this grey level or a random colour."""
    chance = random.Random(seed)
    colour = [chance.randrange(256) for _ in range(3)]
    pixels = np.full((height, width, 3), colour if backdrop is None else backdrop, np.uint8)
    for _ in range(6):
        left, top = chance.randrange(width - 8), chance.randrange(height - 8)
        pixels[top:top + chance.randrange(4, height), left:left + chance.randrange(4, width)] = [
            chance.randrange(256) for _ in range(3)]
    path.write_bytes(b"P6\n%d %d\n255\n" % (width, height) + pixels.tobytes())


# The definitions in NumPy.

def expanded_range(maps):
    """[neurons][2], in the precision of the tables."""
    lo = np.min([m.min(axis=0) for m in maps], axis=0).astype(np.float64)
    hi = np.max([m.max(axis=0) for m in maps], axis=0).astype(np.float64)
    mid, half = (lo + hi) / 2, (hi - lo) / 2 * np.float64(np.float32(1.2))
    half[half == 0] = 1
    return np.stack([mid - half, mid + half], axis=1)


def histogram(activations, table, bins):
    """Counts [neurons][bins]."""
    lo, hi = table[:, 0].astype(np.float64), table[:, 1].astype(np.float64)
    x = np.clip((activations - (lo + hi) / 2) / ((hi - lo) / 2), -1, 1)
    index = np.minimum(bins - 1, np.floor((x + 1) * bins / 2)).astype(int)
    return np.stack([np.bincount(column, minlength=bins) for column in index.T])


def emd(p, q):
    """Per neuron, in bins."""
    p, q = p / p.sum(axis=1, keepdims=True), q / q.sum(axis=1, keepdims=True)
    return np.abs(np.cumsum(p, axis=1) - np.cumsum(q, axis=1)).sum(axis=1)


def frechet(a, b):
    """Eigenvalues of S1^(1/2) S2 S1^(1/2), in the space that the frames of `a` span."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    x, y = a - a.mean(axis=0), b - b.mean(axis=0)
    x, y = x / np.sqrt(len(a) - 1), y / np.sqrt(len(b) - 1)
    # The eigenvalues of S1^(1/2) S2 S1^(1/2) are those of x S2 x^T.
    product = x @ y.T
    roots = np.sqrt(np.clip(np.linalg.eigvalsh(product @ product.T), 0, None)).sum()
    means = ((a.mean(axis=0) - b.mean(axis=0)) ** 2).sum()
    return means + (x ** 2).sum() + (y ** 2).sum() - 2 * roots


def recall(live, truth, others, truths, tolerance):
    """Recall@1, @5, @10 in percent, and the unreachable frames."""
    good = apart(truth, truths) <= tolerance
    squared = np.stack([((others - row) ** 2).sum(axis=1) for row in live.astype(np.float64)])
    order = np.argsort(squared, axis=1, kind="stable")
    hits = np.take_along_axis(good, order[:, :10], axis=1)
    shares = [100 * hits[:, :n].any(axis=1).sum() / len(live) for n in (1, 5, 10)]
    return shares, int((~good.any(axis=1)).sum())


def local_contrast(rows, neighbours=5):
    """Each distance against those up to 5 map frames away, [live][map]."""
    padded = np.pad(rows, ((0, 0), (neighbours, neighbours)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * neighbours + 1, axis=1)
    return (rows - np.nanmean(windows, axis=2)) / np.nanstd(windows, axis=2)


def seqslam(drive, others, asked):
    """The best line of 10 frames through the contrasts; drive: all frames from the warmup on."""
    rows = local_contrast(np.stack([np.linalg.norm(others - row, axis=1) for row in drive]))
    ends = np.arange(len(others))[:, None]
    found = []
    for t in asked:
        back = np.arange(min(10, t + 1))
        sums = [rows[t - back, np.maximum(ends - (v * back + 5) // 10, 0)].sum(axis=1)
                for v in (8, 9, 10, 11, 12)]
        found.append(np.min(sums, axis=0).argmin())
    return np.array(found)


def apart(truth, truths):
    if truth.ndim == 1:
        return np.abs(truth[:, None] - truths[None, :])
    return np.sqrt(((truth[:, None, :] - truths[None, :, :]) ** 2).sum(axis=2))


def fused(maps, truths, tolerance):
    """The mean map: embeddings and ground truth of its places."""
    sums, counts, places = maps[0].astype(np.float64), np.ones(len(maps[0])), truths[0]
    for frames, truth in zip(maps[1:], truths[1:], strict=True):
        between = apart(places, truth)
        nearest = between.argmin(axis=1)
        near = between[np.arange(len(places)), nearest] <= tolerance
        sums[near] += frames[nearest[near]]
        counts[near] += 1
        new = ~(between <= tolerance).any(axis=0)
        sums = np.concatenate([sums, frames[new].astype(np.float64)])
        counts = np.concatenate([counts, np.ones(new.sum())])
        places = np.concatenate([places, truth[new]])
    return (sums / counts[:, None]).astype(np.float32), places


def interval(values):
    """95 % bootstrap interval of the mean."""
    values = np.array(values)
    picks = np.random.RandomState(1).randint(0, 2 ** 32, (2000, len(values)), dtype=np.uint32)
    return np.quantile(values[picks % len(values)].mean(axis=1), [.025, .975])


class Exported:
    """A result and the .npy files of the same run."""

    def __init__(self, folder):
        self.folder = folder / "npy"
        self.json = json.loads((folder / "result.json").read_text())
        index = json.loads((self.folder / "index.json").read_text())
        self.queries, self.references = index["queries"], index["references"]

    def load(self, name):
        return np.load(self.folder / (re.sub("[^A-Za-z0-9_-]", "_", name) + ".npy"))

    def truth(self, name):
        kind = "position_" if self.json["unit"] == "metres" else "place_"
        return self.load(kind + name)


class Evaluation(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-eval-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        self.cache = self.folder / "cache"

    def evaluate(self, *arguments):
        """The result of a run that must succeed."""
        done = vdna("eval", *arguments, "--cache", self.cache, "--json",
                    self.folder / "result.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.folder / "result.json").read_text())

    def refused(self, *arguments, code=1):
        done = vdna("eval", *arguments, "--cache", self.cache)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertRegex(done.stderr, r"\Avdna: .+\n\Z")
        return done.stderr

    def drives(self, *conditions, frames=24):
        """A data set of rendered drives along one route."""
        dataset = self.folder / "drives"
        for i, condition in enumerate(conditions):
            done = vdna("simulate", dataset / condition, "--condition", condition, "--frames",
                        frames, "--size", "96x72", "--drive", i, "--variation", 0.5)
            self.assertEqual(done.returncode, 0, done.stderr)
        return dataset

    def agrees(self, *arguments):
        """Run and compare everything with NumPy."""
        self.evaluate(*arguments, "--npy", self.folder / "npy", "--localisers",
                      "nn,seqslam,fused,all")
        found = Exported(self.folder)
        for query in found.queries:
            self.query_agrees(found, query)
        self.means_agree(found.json)

    def query_agrees(self, found, query):
        result = found.json
        warmup = int(result["warmup"])
        references = [name for name in found.references if name != query]
        embeddings, truth = found.load("embeddings_" + query), found.truth(query)
        # The activations of the tap, which is the last layer as in the paper.
        tapped = {name: found.load("last_layer_" + name) for name in (query, *references)}
        seen = [tapped[name] for name in references]
        live, live_truth = (table[warmup::result["stride"]] for table in (embeddings, truth))
        maps = [found.load("embeddings_" + name) for name in references]
        truths = [found.truth(name) for name in references]

        table = found.load("range_" + query)
        np.testing.assert_allclose(table, expanded_range(seen), rtol=1e-6, atol=1e-6)
        dna = histogram(tapped[query][:warmup], table, result["bins"])
        for i, name in enumerate(references):
            where = f"{query} in {name}"
            distance = {method: rows[query][name] for method, rows in result["distance"].items()}
            emds = emd(dna, histogram(seen[i], table, result["bins"]))
            np.testing.assert_allclose(found.load("emd_" + query)[i], emds, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(distance["vdna"], emds.mean(), rtol=1e-9, err_msg=where)
            np.testing.assert_allclose(distance["fd"], frechet(tapped[query][:warmup], seen[i]),
                                       rtol=1e-6, err_msg=where)
            grey = [found.load("grey_" + n).astype(np.float64) for n in (query, name)]
            self.assertAlmostEqual(distance["pixel"], abs(grey[0][:warmup].mean() - grey[1].mean()),
                                   delta=1e-6, msg=where)
            self.recall_agrees(result, query, name, recall(live, live_truth, maps[i], truths[i],
                                                           result["tolerance"]))
            self.matrices_agree(found, query, name, live, maps[i])
            answers = seqslam(embeddings, maps[i],
                              range(warmup, len(embeddings), result["stride"]))
            good = apart(live_truth, truths[i])[np.arange(len(live)), answers] <= result["tolerance"]
            self.assertEqual(result["localisers"]["seqslam"]["recall"][query][name],
                             100 * good.sum() / len(live), where)
        (expected, _, _), _ = recall(live, live_truth, *fused(maps, truths, result["tolerance"]),
                                     result["tolerance"])
        self.assertEqual(result["localisers"]["fused"]["recall"][query], {"all": expected}, query)
        self.recall_agrees(result, query, "all",
                           recall(live, live_truth, np.concatenate(maps), np.concatenate(truths),
                                  result["tolerance"]))

    def means_agree(self, result):
        """Means over queries with intervals, over references and in the first choice."""
        self.assertEqual(list(result["localisers"]), ["nn", "seqslam", "fused", "all"])
        for name, found in result["localisers"].items():
            means, chosen = [], []
            for query, row in found["recall"].items():
                nearest = result["distance"]["vdna"][query]
                means.append(np.mean(list(row.values())))
                chosen.append(row.get(min(nearest, key=nearest.get), row.get("all")))
            for kind, values in (("mean", means), ("first_choice", chosen)):
                np.testing.assert_allclose(
                    [found[kind][key] for key in ("recall", "low", "high")],
                    [np.mean(values), *interval(values)], rtol=1e-9, err_msg=f"{name} {kind}")
        for name in ("nn", "all"):
            for query, row in result["localisers"][name]["recall"].items():
                expected = {reference: value for reference, value in result["recall"][query].items()
                            if (reference == "all") == (name == "all")}
                self.assertEqual(row, expected)

    def recall_agrees(self, result, query, name, expected):
        (at_1, at_5, at_10), unreachable = expected
        where = f"{query} in {name}"
        self.assertEqual(result["recall"][query][name], at_1, where)
        self.assertEqual(result["recall_at"]["5"][query][name], at_5, where)
        self.assertEqual(result["recall_at"]["10"][query][name], at_10, where)
        self.assertEqual(result["counts"][query][name]["unreachable"], unreachable, where)

    def matrices_agree(self, found, query, name, live, others):
        matrix = found.load(f"difference_{query}_{name}")
        expected = np.sqrt(((live[:, None, :].astype(np.float64) - others[None]) ** 2).sum(axis=2))
        np.testing.assert_allclose(matrix, expected, rtol=1e-6)
        self.assertEqual(found.load(f"ground_truth_{query}_{name}").shape, matrix.shape)


class Agreement(Evaluation):
    def test_rendered_drives_agree_with_numpy(self):
        dataset = self.drives("summer", "winter", "night")
        for bins in (50, 5, 5):  # the last run finds its histograms in the cache
            self.agrees(dataset, "--warmup", 8, "--stride", 3, "--bins", bins, "--tolerance", 4)

    def real_pictures(self, name):
        if not DATA.is_dir():
            self.skipTest(f"no pictures at {DATA}; set VDNA_SHARED")
        return DATA / name

    def test_twelve_months_of_a_park_agree_with_numpy(self):
        self.agrees(self.real_pictures("planetarium_pan"))

    def test_webcams_by_day_and_night_agree_with_numpy(self):
        self.agrees(self.real_pictures("amos_patrol_a"))

    def test_a_robots_route_in_autumn_and_snow_agrees_with_numpy(self):
        self.agrees(self.real_pictures("stromovka"), "--stride", 2)


class Trust(Evaluation):
    """`--trust` against the reference implementation of predictions, in $VDNA_SHARED/reference.

    The recall that a stored run gets in another is that which it gets as a query, if its warmup is
    two fifths of it.
    """

    def placed_drives(self, *conditions):
        """Rendered drives whose frames are numbered places."""
        dataset = self.drives(*conditions, frames=36)
        for labels in dataset.glob("*/labels.csv"):
            files = [line.split(",")[0] for line in labels.read_text().splitlines()[1:]]
            labels.write_text("file,place\n" + "".join(
                f"{file},{place}\n" for place, file in enumerate(files)))
        return dataset

    def tried(self, *arguments):
        result = self.evaluate(*arguments, "--trust", "--localisers", "nn,centred", "--npy",
                               self.folder / "npy", "--csv", self.folder / "result.csv", "--html",
                               self.folder / "report.html")
        return result, result["trust"]

    def reference_agrees(self, found, query):
        result, pairs = found.json, found.json["trust"]["pairs"][query]
        names, warmup = list(pairs), int(result["warmup"])
        runs = [found.load("embeddings_" + name).astype(np.float64) for name in names]
        table = found.load("range_" + query)
        tapped = [found.load("last_layer_" + name) for name in names]
        counts = [histogram(rows, table, result["bins"]) for rows in tapped]
        at = {run[i].tobytes(): (a, i) for a, run in enumerate(runs) for i in range(len(run))}

        def distance(frames, b):
            a, first = at[frames[0].tobytes()]
            window = histogram(tapped[a][first:first + len(frames)], table, result["bins"])
            return emd(window, counts[b]).mean()

        def correct(live, _, run, *__):
            a, b = at[live[0].tobytes()][0], at[run[0].tobytes()][0]
            recalled = result["localisers"]["centred"]["recall"][names[a]][names[b]]
            return np.full(len(live), recalled / 100)

        predict.correct = correct
        known = predict.calibrate(runs, [found.truth(name).astype(float) for name in names],
                                  result["tolerance"], distance)
        live = found.load("embeddings_" + query).astype(np.float64)[:warmup]
        recalls = predict.predict(known, live, runs,
                                  [result["distance"]["vdna"][query][name] for name in names])
        for i, name in enumerate(names):
            if pairs[name]["reason"] == "":
                np.testing.assert_allclose(
                    [pairs[name][key] for key in ("predicted", "low", "high")],
                    [100 * values[i] for values in recalls], atol=1e-5, err_msg=f"{query} {name}")

    def scores_agree(self, result):
        """Those of maps of all references, from what each pair has."""
        trust, errors, coverage = result["trust"], [], []
        for query, row in trust["pairs"].items():
            told = [pair for pair in row.values() if pair["reason"] == ""]
            for name, pair in row.items():
                self.assertEqual(pair["achieved"],
                                 result["localisers"]["centred"]["recall"][query][name])
            if told:
                errors.append([np.mean([abs(pair[by] - pair["achieved"]) for pair in told])
                               for by in ("predicted", "constant", "nearest", "transfer")])
                coverage.append(100 * np.mean([pair["low"] <= pair["achieved"] <= pair["high"]
                                               for pair in told]))
        (score,) = [score for score in trust["predictions"]
                    if (score["references"], score["warmup"]) == ("all", "full")]
        for i, key in enumerate(("error", "error_constant", "error_nearest", "error_transfer")):
            values = [row[i] for row in errors]
            np.testing.assert_allclose([score[key][of] for of in ("mean", "low", "high")],
                                       [np.mean(values), *interval(values)], rtol=1e-9)
        np.testing.assert_allclose(score["coverage_percent"]["mean"], np.mean(coverage))
        told = sum(pair["reason"] == "" for row in trust["pairs"].values() for pair in row.values())
        self.assertEqual(score["predictions"], told)
        self.assertEqual(sum(score["withheld"].values()),
                         sum(len(row) for row in trust["pairs"].values()) - told)

    def test_predictions_are_those_of_the_reference(self):
        if predict is None:
            self.skipTest(f"no reference beside {DATA}; set VDNA_SHARED")
        dataset = self.placed_drives("summer", "autumn", "overcast", "rain", "night")
        result, trust = self.tried(dataset, "--warmup", 14, "--tolerance", 1, "--bins", 50)
        self.assertGreater(trust["predictions"][-2]["predictions"], 10)
        found = Exported(self.folder)
        for query in found.queries:
            self.reference_agrees(found, query)
        self.scores_agree(result)

    def test_disturbed_cameras_are_like_nothing_in_the_map(self):
        dataset = self.placed_drives("summer", "autumn", "overcast", "rain")
        _, trust = self.tried(dataset, "--warmup", 12, "--tolerance", 1)
        unlike = {score["live"]: score["unlike_percent"]["mean"] for score in trust["unlike"]
                  if score["references"] == "all"}
        self.assertEqual([unlike[live] for live in ("black", "white", "noise", "blur")], [100] * 4)

    def test_conditions_are_left_out_by_name(self):
        dataset = self.placed_drives("summer", "autumn", "overcast")
        (dataset / "autumn").rename(dataset / "summer_2")
        _, trust = self.tried(dataset, "--warmup", 12, "--tolerance", 1)
        maps = {score["live"]: score["maps"] for score in trust["unlike"]}
        self.assertEqual(maps["condition left out: summer"], 2)
        self.assertEqual(maps["condition left out: overcast"], 1)
        self.assertEqual(maps["its condition is in the map"], 2)

    def test_every_output_has_the_predictions(self):
        dataset = self.placed_drives("summer", "autumn", "overcast", "rain")
        result, _ = self.tried(dataset, "--warmup", 12, "--tolerance", 1)
        lines = (self.folder / "result.csv").read_text().splitlines()
        head = lines[0].split(",")
        pair = result["trust"]["pairs"]["summer"]["rain"]
        for line in lines[1:]:
            cells = dict(zip(head, line.split(","), strict=True))
            if (cells["query"], cells["reference"]) == ("summer", "rain"):
                self.assertEqual(float(cells["predicted_percent"]), pair["predicted"])
            self.assertEqual(cells["achieved_percent"] == "", cells["reference"] == "all")
        self.assertIn("Trust in the choice", (self.folder / "report.html").read_text())
        printed = vdna("eval", dataset, "--trust", "--warmup", 12, "--tolerance", 1, "--cache",
                       self.cache).stdout
        for title in ("Rankings, judged by Recall@1 of the localiser filter", "Predicted recall",
                      "Reliability of predictions", "unlike all of the map", "Warmups that end"):
            self.assertIn(title, printed)

    def test_two_traversals_are_too_few_to_predict(self):
        dataset = self.placed_drives("summer", "autumn")
        _, trust = self.tried(dataset, "--warmup", 12, "--tolerance", 1)
        (score, _) = trust["predictions"]
        self.assertEqual((score["predictions"], score["error"]["mean"]), (0, None))
        self.assertEqual(list(score["withheld"].values()), [2])


class OwnSet(Evaluation):
    """Three traversals of one route; dusk has the same pictures as dawn."""

    def setUp(self):
        super().setUp()
        self.dataset = self.folder / "set"
        for t, name in enumerate(("dawn", "dusk", "noon")):
            (self.dataset / name).mkdir(parents=True)
            rows = ["file,place"]
            for i in range(12):
                write_picture(self.dataset / name / f"{i:03}.ppm", 10 * i + (t == 2) * i % 3)
                rows.append(f"{i:03}.ppm,{i}")
            (self.dataset / name / "labels.csv").write_text("\n".join(rows) + "\n")


class Results(OwnSet):
    def test_equal_traversals_recall_everything_and_have_the_least_distance(self):
        result = self.evaluate(self.dataset, "--tolerance", 0)
        self.assertEqual(result["recall"]["dawn"]["dusk"], 100)
        self.assertEqual(result["recall"]["dawn"]["all"], 100)
        self.assertLess(result["distance"]["vdna"]["dawn"]["dusk"],
                        result["distance"]["vdna"]["dawn"]["noon"])
        self.assertEqual(result["queries"], ["dawn", "dusk", "noon"])

    def test_metrics_of_the_result_are_those_of_the_evaluation(self):
        result = self.evaluate(self.dataset)
        again = json.loads(vdna("metrics", self.folder / "result.json", "--json").stdout)
        self.assertEqual(again["methods"], result["methods"])

    def test_the_second_run_takes_everything_from_the_cache(self):
        first, second = self.evaluate(self.dataset), self.evaluate(self.dataset)
        # dusk has the same content as dawn, which runs only once.
        self.assertLess(first["computed"], 25)
        self.assertEqual((second["computed"], second["cached"]), (0, 36))
        for result in (first, second):
            del result["computed"], result["cached"]
        self.assertEqual(first, second)

    def test_a_damaged_cache_entry_is_computed_again(self):
        first = self.evaluate(self.dataset)
        entry = next(self.cache.glob("*/*.frame"))
        data = bytearray(entry.read_bytes())
        data[100] ^= 1
        entry.write_bytes(data)
        second = self.evaluate(self.dataset)
        self.assertEqual(second["computed"], 1)
        self.assertEqual(first["distance"], second["distance"])

    def test_with_cached_histograms_no_activation_is_read(self):
        first = self.evaluate(self.dataset, "--bins", 3)  # fewer than the frames, so they are kept
        self.assertTrue(list(self.cache.glob("*/*.counts")))
        for entry in self.cache.glob("*/*.taps"):
            entry.unlink()
        second = self.evaluate(self.dataset, "--bins", 3)
        self.assertEqual(list(self.cache.glob("*/*.taps")), [])
        self.assertEqual(first["distance"], second["distance"])

    def test_a_changed_picture_changes_what_the_cache_gives(self):
        self.evaluate(self.dataset, "--bins", 3)
        for picture in ("000.ppm", "011.ppm"):
            write_picture(self.dataset / "noon" / picture, 77)
        cached = self.evaluate(self.dataset, "--bins", 3)
        shutil.rmtree(self.cache)
        self.assertEqual(self.evaluate(self.dataset, "--bins", 3)["distance"], cached["distance"])

    def test_damaged_histograms_and_lost_activations_are_computed_again(self):
        first = self.evaluate(self.dataset, "--bins", 10)
        entries = [*self.cache.glob("*/*.counts"), *self.cache.glob("*/*.observed")]
        for entry in entries:
            data = bytearray(entry.read_bytes())
            data[len(data) // 2] ^= 1
            entry.write_bytes(data)
        for entry in self.cache.glob("*/*.taps"):
            entry.unlink()
        self.assertGreater(len(entries), 3)
        second = self.evaluate(self.dataset, "--bins", 10)
        self.assertEqual(first["distance"], second["distance"])
        self.assertTrue(list(self.cache.glob("*/*.taps")))

    def test_an_interrupted_run_continues_where_it_stopped(self):
        with open(self.dataset / "dawn/labels.csv", "a") as labels:
            for i in range(12, 400):
                write_picture(self.dataset / f"dawn/{i:03}.ppm", 1000 + i)
                labels.write(f"{i:03}.ppm,{i}\n")
        run = subprocess.Popen([str(VDNA), "eval", self.dataset, "--cache", self.cache, "--json",
                                self.folder / "result.json"], stderr=subprocess.PIPE, text=True)
        while len(list(self.cache.glob("*/*.frame"))) < 20 and run.poll() is None:
            time.sleep(.01)
        run.send_signal(signal.SIGINT)
        _, sentence = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, sentence)
        self.assertFalse((self.folder / "result.json").exists())
        self.assertEqual(list(self.cache.glob("**/*.part")), [])
        resumed = self.evaluate(self.dataset)
        self.assertGreaterEqual(resumed["cached"], 20)

        shutil.rmtree(self.cache)
        whole = self.evaluate(self.dataset)
        for result in (resumed, whole):
            del result["computed"], result["cached"]
        self.assertEqual(resumed, whole)

    def test_csv_has_a_row_for_each_pair_and_for_all(self):
        self.evaluate(self.dataset, "--csv", self.folder / "result.csv")
        lines = (self.folder / "result.csv").read_text().splitlines()
        self.assertEqual(lines[0], "query,reference,recall_percent,good,total,unreachable,"
                                   "distance_vdna,distance_fd,distance_pixel,without_truth,note")
        self.assertEqual(len(lines), 1 + 3 * 3)
        self.assertRegex(lines[3], r"^dawn,all,[\d.]+,\d+,8,0,,,,0,$")

    def test_misplaced_references_are_marked_where_there_is_no_colour(self):
        # The live warmup looks like dusk by its grey level, but its places are those of noon.
        for traversal, grey, seed in (("dawn", 90, 0), ("dusk", 91, 50), ("noon", 200, 0)):
            for i in range(12):
                write_picture(self.dataset / traversal / f"{i:03}.ppm", seed + i, backdrop=grey)
        done = vdna("eval", self.dataset, "--queries", "dawn", "--tolerance", 0, "--cache",
                    self.cache)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("\x1b", done.stdout)
        pixel = done.stdout.split("Pixel intensity, grey levels\n")[1].splitlines()
        self.assertRegex(pixel[1], r"- dusk \*$")
        self.assertRegex(pixel[2], r"- noon \*$")

    def test_the_usual_localisers_are_compared_without_being_named(self):
        result = self.evaluate(self.dataset)
        self.assertEqual(list(result["localisers"]), ["nn", "all"])

    def test_localisers_have_a_column_a_table_and_an_array(self):
        done = vdna("eval", self.dataset, "--cache", self.cache, "--localisers", "fused,seqslam",
                    "--csv", self.folder / "result.csv", "--npy", self.folder / "npy")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"\nseqslam +[\d.]+ \([\d.]+ to [\d.]+\)  ")
        self.assertRegex(done.stdout, r"\nquery  reference  seqslam  fused\ndawn   dusk  ")
        lines = (self.folder / "result.csv").read_text().splitlines()
        self.assertTrue(lines[0].endswith(
            "distance_pixel,recall_percent_seqslam,recall_percent_fused,without_truth,note"))
        self.assertRegex(lines[1], r",[\d.]+,,0,$")
        self.assertRegex(lines[3], r",,,,,[\d.]+,0,$")
        self.assertEqual(np.load(self.folder / "npy/recall_seqslam.npy").shape, (3, 3))
        self.assertEqual(np.load(self.folder / "npy/recall_fused.npy").shape, (3,))

    def test_drives_have_a_row_for_each_localiser(self):
        drives = ["plain", "varied", "replaced", "gap", "off-route"]
        options = ("--localisers", "nn,filter,filter_top2,fused_filter", "--drives",
                   "off-route,gap,replaced,varied,plain", "--tolerance", 1)
        result = self.evaluate(self.dataset, *options)
        self.assertEqual(list(result["drives"]), drives)
        localisers = result["localisers"]
        for name, plain in result["drives"]["plain"].items():
            self.assertEqual(plain, {key: localisers[name][key] for key in plain}, name)
        for drive in drives:
            filtered = result["drives"][drive]["filter"]
            self.assertEqual("off_route" in filtered["mean"], drive in ("gap", "off-route"), drive)
            self.assertIn("confidence", filtered["first_choice"])
        self.assertEqual(self.evaluate(self.dataset, *options)["drives"], result["drives"])
        done = vdna("eval", self.dataset, "--cache", self.cache, "--drives", "gap", "--tolerance", 1)
        self.assertRegex(done.stdout, r"\ngap    nn         first choice  \d")
        self.assertRegex(self.refused(self.dataset, "--drives", "flight", code=2),
                         "plain.*varied.*replaced.*gap.*off-route")

    def test_choosing_again_has_a_row_for_each_drive(self):
        options = ("--reselect", "dawn+dusk,noon", "--tolerance", 1)
        result = self.evaluate(self.dataset, *options)["reselection"]
        self.assertEqual(list(result["drives"]), ["dawn+dusk", "noon"])
        alone = result["drives"]["dawn+dusk"]  # there is one candidate
        self.assertEqual(alone["choices"], ["noon"])
        self.assertEqual(alone["again_percent"], alone["never_percent"])
        self.assertEqual((alone["since"], alone["delays"]), ([0], []))
        self.assertEqual(len(alone["changes"]), 3)
        page = self.folder / "report.html"
        done = vdna("eval", self.dataset, "--cache", self.cache, *options, "--html", page)
        self.assertIn("<h2>Choosing again while driving</h2>", page.read_text("utf-8"))
        self.assertRegex(done.stdout, r"\ndawn\+dusk  +\d+\.\d\d  +\d+\.\d\d  +\d+\.\d\d  +noon")
        self.assertRegex(self.refused(self.dataset, "--reselect", "dawn+night"),
                         "no traversal 'night'")

    def test_an_ablation_has_a_row_for_each_value(self):
        result = self.evaluate(self.dataset, "--ablate", "bins,warmup,tap,leave-one-out", "--bins",
                               "10,1000", "--warmup", "3,4")
        rows = {kind: [row["value"] for row in table]
                for kind, table in result["ablations"].items()}
        self.assertEqual(rows["bins"], ["10", "1000"])
        self.assertEqual(rows["warmup"], ["3", "4"])
        self.assertEqual(rows["leave-one-out"], ["dawn", "dusk", "noon"])
        self.assertEqual(len(rows["tap"]), 1)
        same = result["ablations"]["bins"][1]["methods"]["vdna"]
        self.assertEqual(same, result["methods"]["vdna"])

    def test_only_the_wanted_queries_and_references_are_evaluated(self):
        result = self.evaluate(self.dataset, "--queries", "noon", "--references", "dawn,noon")
        self.assertEqual(set(result["recall"]), {"noon"})
        self.assertEqual(set(result["recall"]["noon"]), {"dawn", "all"})
        self.assertEqual(result["cached"] + result["computed"], 24)

    def test_wrong_options_are_explained(self):
        self.assertIn("expected one of: dawn dusk noon",
                      self.refused(self.dataset, "--exclude", "dwan", code=2))
        self.assertIn("--ablate bins", self.refused(self.dataset, "--bins", "10,20", code=2))
        self.assertIn("set --warmup", self.refused(self.dataset, "--warmup", 12))
        self.assertIn("embedding", self.refused(self.dataset, "--taps", "layer9", code=2))
        self.assertRegex(self.refused(self.dataset, "--localisers", "gps", code=2),
                         "nn.*seqslam.*fused.*all")

    def test_a_picture_that_cannot_be_decoded_is_named_or_left_out(self):
        (self.dataset / "dusk/005.ppm").write_bytes(b"P6\nnot a picture")
        self.assertIn("dusk/005.ppm", self.refused(self.dataset))
        self.assertEqual(self.evaluate(self.dataset, "--skip-bad")["frames"]["dusk"]["bad"], 1)


class Taps(OwnSet):
    """A network whose taps "map" and "tokens" hold the same numbers in two layouts."""

    def setUp(self):
        super().setUp()
        model = Path(__file__).parent.parent / "support" / "tiny_network.onnx"
        taps = "".join(f'[[taps]]\noutput = "{name}"\nlayout = "{layout}"\n' for name, layout in (
            ("mean", "samples_neurons"), ("map", "neurons_samples"),
            ("tokens", "samples_neurons")))
        self.manifest = self.folder / "tiny.toml"
        self.manifest.write_text(
            f'name = "tiny"\nmodel = "{model}"\n'
            f'sha256 = "{hashlib.sha256(model.read_bytes()).hexdigest()}"\n'
            'source = "made"\nlicence = "MIT"\n[input]\nname = "image"\nwidth = 2\nheight = 2\n'
            'colour = "RGB"\nmean = [0, 0, 0]\nstd = [1, 1, 1]\nresize = "stretch"\n'
            f'interpolation = "area"\n{taps}'
            '[embedding]\noutput = "mean"\nl2_normalise = false\n')

    def test_layouts_do_not_matter_and_the_distance_is_the_mean_over_all_neurons(self):
        distance = self.evaluate(self.dataset, "--backbone", self.manifest)["distance"]
        for query, row in distance["vdna"].items():
            for reference, value in row.items():
                per_tap = [distance[f"vdna:{tap}"][query][reference]
                           for tap in ("mean", "map", "tokens")]
                self.assertEqual(per_tap[1], per_tap[2])
                self.assertAlmostEqual(value, sum(per_tap) / 3, delta=1e-9)

    def test_a_tap_has_the_same_distance_alone_and_among_all(self):
        every = self.evaluate(self.dataset, "--backbone", self.manifest, "--ablate", "tap")
        one = self.evaluate(self.dataset, "--backbone", self.manifest, "--taps", "map")
        self.assertEqual(one["distance"]["vdna"], every["distance"]["vdna:map"])
        self.assertEqual(one["taps"], "map:3:4")
        self.assertEqual([row["value"] for row in every["ablations"]["tap"]],
                         ["mean", "map", "tokens", "all of them"])
        self.assertEqual(every["ablations"]["tap"][1]["methods"]["vdna"], one["methods"]["vdna"])


class DataSets(Evaluation):
    def pictures(self, folder, names):
        folder.mkdir(parents=True)
        for i, name in enumerate(names):
            write_picture(folder / name, i)

    def test_positions_in_picture_names_are_the_ground_truth(self):
        names = [f"@{551000 + 20 * i}.50@4182105.25@10@S@@@@@@@@@@@.ppm" for i in range(10)]
        for traversal in ("a", "b"):
            self.pictures(self.folder / "set" / traversal, names)
        result = self.evaluate(self.folder / "set", "--npy", self.folder / "npy")
        self.assertEqual((result["unit"], result["tolerance"]), ("metres", 25))
        self.assertEqual(result["recall"]["a"]["b"], 100)
        np.testing.assert_array_equal(np.load(self.folder / "npy/position_a.npy")[1],
                                      [551020.5, 4182105.25, 0])

    def test_the_tolerance_has_one_unit_although_some_traversals_have_two_labels(self):
        # Only one of three has no positions, so all are judged by places: those of `a` and `b` are
        # a place apart, and 1000 metres.
        for name, columns, shift in (("_", "file,place", 0), ("a", "file,place,x,y", 0),
                                     ("b", "file,place,x,y", 1)):
            folder = self.folder / "set" / name
            self.pictures(folder, [f"{i:02}.ppm" for i in range(8)])
            rows = [f"{i:02}.ppm,{i + shift},{1000 * (i + shift)},0" for i in range(8)]
            (folder / "labels.csv").write_text("\n".join(
                [columns, *(",".join(row.split(",")[:len(columns.split(","))]) for row in rows)]))
        result = self.evaluate(self.folder / "set", "--warmup", 2, "--tolerance", 1,
                               "--localisers", "nn,seqslam,fused,all", "--npy", self.folder / "npy")
        self.assertEqual(result["unit"], "places")
        self.assertEqual(result["recall"]["a"], {"_": 100, "b": 100, "all": 100})
        self.assertEqual(result["localisers"]["seqslam"]["recall"]["a"]["b"], 100)
        truth = np.load(self.folder / "npy/ground_truth_a_b.npy")
        self.assertEqual(truth[0].tolist(), [1, 0, 1, 2, 3, 4, 5, 6])

    def test_utm_zones_do_not_mix(self):
        self.pictures(self.folder / "set/a", ["@1@2@10@S@.ppm"])
        self.pictures(self.folder / "set/b", ["@1@2@11@S@.ppm"])
        self.assertIn("zone 11", self.refused(self.folder / "set"))

    def test_nordland_partitions_are_compared_like_against_like(self):
        for season in ("spring", "summer", "fall_images_test"):
            self.pictures(self.folder / "set" / season,
                          [f"images-{i + 1:05}.ppm" for i in range(20)])
        result = self.evaluate(self.folder / "set", "--partition-frames", 10, "--warmup", 4)
        self.assertEqual(result["queries"], [f"test:{n}/{season}" for n in (1, 2)
                                             for season in ("fall", "spring", "summer")])
        self.assertEqual(set(result["recall"]["test:2/fall"]),
                         {"test:2/spring", "test:2/summer", "all"})
        self.assertEqual((result["stride"], result["tolerance"], result["unit"]),
                         (5, 5, "places"))
        self.assertEqual(result["frames"]["test:1/fall"]["live"], 2)  # frames 4 and 9

    def test_nordland_partitions_may_be_folders(self):
        for season in ("fall", "winter"):
            for part in ("section1", "section2"):
                self.pictures(self.folder / "set" / season / part,
                              [f"{i}.ppm" for i in range(10)])
        result = self.evaluate(self.folder / "set", "--protocol", "nordland", "--warmup", 4)
        self.assertEqual(len(result["queries"]), 4)

    def test_a_season_that_is_not_whole_partitions_is_refused(self):
        self.pictures(self.folder / "set/fall", [f"{i}.ppm" for i in range(7)])
        self.pictures(self.folder / "set/winter", [f"{i}.ppm" for i in range(7)])
        self.assertIn("has 7 pictures, expected partitions of 1150",
                      self.refused(self.folder / "set"))

    def test_parks_warm_up_by_time_and_judge_by_metres(self):
        for traversal in ("a", "b"):
            folder = self.folder / "set" / traversal
            self.pictures(folder, [f"{i:02}.ppm" for i in range(12)])
            rows = [f"{i:02}.ppm,{i * 10_000_000},51.76,{-1.25 + i * 1e-4}" for i in range(12)]
            (folder / "labels.csv").write_text("file,utime,lat,lon\n" + "\n".join(rows) + "\n")
        result = self.evaluate(self.folder / "set", "--protocol", "parks", "--warmup-min", 1)
        self.assertEqual((result["warmup"], result["unit"], result["tolerance"]),
                         ("45s", "metres", 5))
        self.assertEqual(result["frames"]["a"]["warmup"], 5)  # at 0, 10, 20, 30 and 40 s
        self.assertEqual(result["recall"]["a"]["b"], 100)

    def test_a_manifest_gives_order_and_tolerance(self):
        self.pictures(self.folder / "set/x", [f"{i}.ppm" for i in range(6)])
        rows = [f"x/{i}.ppm,{name},{9 - i},{10 * i},3,"
                for name, numbers in (("a", range(3)), ("b", range(3, 6))) for i in numbers]
        (self.folder / "set/manifest.csv").write_text(
            "file,experience,order,place,gt_tol,source\n" + "\n".join(rows) + "\n")
        result = self.evaluate(self.folder / "set", "--warmup", 2, "--npy", self.folder / "npy")
        self.assertEqual(result["tolerance"], 3)
        self.assertEqual(np.load(self.folder / "npy/place_a.npy").tolist(), [20, 10, 0])
        self.assertEqual(result["counts"]["a"]["b"]["unreachable"], 1)

    def test_a_folder_that_is_no_data_set_is_refused(self):
        self.pictures(self.folder / "set/a", ["0.ppm"])
        self.assertIn("set --format", self.refused(self.folder / "set"))
        self.assertIn("not a directory", self.refused(self.folder / "nowhere"))
        (self.folder / "set/manifest.csv").write_text(
            "file,experience,order,place,gt_tol\na/0.ppm,x,0,0,1\na/1.ppm,x,one,0,1\n")
        self.assertIn("manifest.csv:3: order is 'one'", self.refused(self.folder / "set"))


if __name__ == "__main__":
    unittest.main()
