"""A smoke test of the bench with tiny sizes: its results have the shape that its page needs. Speed
is not checked.

    test_smoke.py BUILD
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
BUILD = Path(sys.argv.pop(1))
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
try:
    import numpy  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)
import figures  # noqa: E402
import gains  # noqa: E402
import page_memory  # noqa: E402
from bench import write_pages  # noqa: E402
from measure import calmest, compare, exponent  # noqa: E402
from plot import bars, lines  # noqa: E402

HAS_DAEMON = (BUILD / "bin" / "vdna_selectord").exists()


def command(*arguments):
    """The bench without its peers, which differ from machine to machine."""
    return ["/usr/bin/python3", HERE / "bench.py", "--tiny", "--no-peers", "--build", BUILD,
            *arguments]


def bench(*arguments):
    """Run it to its end."""
    return subprocess.run(command(*arguments), capture_output=True, text=True)


def processes_of(session):
    """{process: its name} of a session; zombies are left out."""
    found = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, rest = path.read_text().partition("(")[2].rpartition(") ")
        except OSError:  # it has just ended
            continue
        state, _, _, its_session = rest.split()[:4]
        if int(its_session) == session and state != "Z":
            found[int(path.parent.name)] = name
    return found


def programs_of(session):
    return set(processes_of(session).values())


def kill_all_of(session):
    for process in processes_of(session):
        os.kill(process, signal.SIGKILL)


class Bench(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-bench-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        for part in ("reference", "internals"):
            (self.folder / part).mkdir()

    def measured(self, *groups):
        out = self.folder / "measured.json"
        done = bench("--out", out, *groups)
        if done.returncode == 77:
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(out.read_text())

    def check_group(self, group):
        for key in ("date", "commit", "quick", "versions", "load_begin", "load_end"):
            self.assertIn(key, group)
        for result in group["results"]:
            self.assertTrue(0 < result["least"] <= result["median"] <= result["most"], result)
            self.assertGreater(result["rounds"], 0)
            for peer in result["peers"].values():
                self.assertGreater(peer["median"], 0)
                self.assertGreater(peer["speedup"], 0)

    def page(self, name):
        return next(self.folder.glob(f"*/{name}.md")).read_text()

    def check_plots(self, *names):
        for name in names:
            self.assertIn("<svg", next(self.folder.glob(f"*/{name}.svg")).read_text())

    def test_the_core_is_measured_and_kept_with_its_circumstances(self):
        stored = self.measured("core", "localise", "files", "growth", "sizes")
        self.assertEqual(list(stored["groups"]), ["core", "localise", "files", "growth", "sizes"])
        self.assertGreaterEqual(stored["machine"]["cores"], 1)
        for group in stored["groups"].values():
            self.check_group(group)
        names = [result["name"] for result in stored["groups"]["core"]["results"]]
        self.assertIn("histogram 16x3", names)
        self.assertIn("EMD 16 neurons, K=2", names)
        localise, warmup = stored["groups"]["localise"]["results"]
        self.assertEqual(localise["name"], "localise 50x8")
        self.assertEqual(warmup["name"], "warm up with trust 2x50x8")
        write_pages(stored, self.folder)
        performance, memory = self.page("performance"), self.page("memory")
        self.assertIn("| histogram 16x3 |", performance)
        self.assertIn("| time of ranking, by bins | 250 to 500 |", performance)
        self.assertIn("| memory of the map, by frames | 1,000 to 2,000 |", memory)
        self.assertNotIn("| memory", performance)
        self.assertLess(performance.index("## Results"), performance.index("## What was missed"))
        self.assertIn("Not measured: ", performance)
        self.assertNotIn("## Beside", memory)
        self.check_plots("performance-growth", "memory-growth")

    def test_instructions_for_arm_are_counted_beside_those_for_x86(self):
        stored = self.measured("arm")
        if "arm" not in stored["groups"]:
            self.skipTest("no cross-compiler or emulator")
        [emd] = stored["groups"]["arm"]["results"]
        self.assertTrue(0.1 < emd["more"]["of_x86_64"] < 10)

    def test_the_map_has_all_of_its_experiences_and_the_selector_one_table(self):
        results = {result["name"].removeprefix("memory of "): result["more"]
                   for result in self.measured("sizes")["groups"]["sizes"]["results"]}
        usual = results["the map, by experiences"]["usual"]
        table, embeddings = (4 * usual[rows] * usual[columns] / 2**20 for rows, columns in
                             (("neurons", "bins"), ("frames", "dim")))

        (few, small), (many, large) = results["the map, by experiences"]["points"]
        self.assertEqual(large / small, many / few)
        self.assertTrue(table + embeddings < small / few < 1.1 * (table + embeddings))
        (_, small), (_, large) = results["the selector, by experiences"]["points"]
        self.assertTrue(table < small < large < 1.1 * table)
        (_, small), (_, large) = results["the selector, by frames"]["points"]
        self.assertEqual(small, large)

    def test_a_group_that_is_measured_again_replaces_itself_only(self):
        before = self.measured("files")
        before["groups"]["core"] = before["groups"].pop("files")
        (self.folder / "measured.json").write_text(json.dumps(before))
        after = self.measured("files")
        self.assertEqual(after["groups"]["core"], before["groups"]["core"])
        self.assertIn("files", after["groups"])

    @unittest.skipUnless(HAS_DAEMON, "the daemon is not built")
    def test_a_drive_past_the_real_daemon_ends_in_a_ranking(self):
        stored = self.measured("add", "frame", "footprint", "start", "drive", "stages")
        for group in stored["groups"].values():
            self.check_group(group)
        results = {result["name"]: result for result in stored["groups"]["drive"]["results"]}
        [start] = stored["groups"]["start"]["results"]
        self.assertIn("ONNX Runtime alone", start["peers"])
        self.assertGreater(start["more"]["processor_ms"], 0)
        choice = results["decision efficientnet_lite0 fp32"]["more"]
        self.assertEqual(choice["drives"], 1)
        self.assertTrue(0 < choice["frames_percent"] <= 100)
        drive = results["drive efficientnet_lite0 fp32"]
        self.assertIn("ONNX Runtime alone", drive["peers"])
        self.assertGreater(drive["more"]["last_frame_to_ranking_ms"], 0)
        self.assertGreater(drive["more"]["memory_mib"], 1)
        frames = [frame for frame, _ in
                  results["long run efficientnet_lite0"]["more"]["memory_mib_by_frame"]]
        self.assertEqual((frames[0], frames[-1]), (0, 40))
        write_pages(stored, self.folder)
        more = drive["more"]
        beyond = more["memory_mib"] - more["bare_memory_mib"] - more["map_mib"]
        row = [more["memory_mib"], more["bare_memory_mib"], more["map_mib"], beyond]
        memory = self.page("memory")
        self.assertIn(f"| efficientnet_lite0 fp32 | {' | '.join(f'{n:.3g}' for n in row)} |", memory)
        self.assertIn("after 40; the most was", memory)
        self.check_plots("performance-throughput", "memory-long-run")
        stages = stored["groups"]["stages"]["results"][0]["more"]
        self.assertIn(f"| decode | {stages['decode, ms']:.3g} |", self.page("performance"))

    @unittest.skipUnless(HAS_DAEMON, "the daemon is not built")
    def test_what_runs_beside_a_bench_that_is_killed_ends_with_it(self):
        killed = subprocess.Popen(command("drive", "--out", self.folder / "measured.json"),
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  start_new_session=True)
        with killed:
            self.addCleanup(kill_all_of, killed.pid)
            beside = {"vdna_selectord", "bare_onnx"}
            while killed.poll() is None and not beside <= programs_of(killed.pid):
                time.sleep(0.001)
            if killed.poll() == 77:
                self.skipTest(killed.stdout.read())
            self.assertIsNone(killed.poll(), "ended before both ran")
            killed.kill()
        deadline = time.monotonic() + 30
        while programs_of(killed.pid) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertEqual(programs_of(killed.pid), set())

    def test_a_group_that_is_not_there_is_refused(self):
        done = bench("cores")
        self.assertEqual(done.returncode, 2)
        self.assertIn("there is no group cores", done.stderr)


class Measuring(unittest.TestCase):
    def test_a_ratio_says_how_many_times_as_fast_ours_is(self):
        timed = compare(lambda: None, {"slower": lambda: sum(range(2000))}, 0.01)
        self.assertGreater(timed["peers"]["slower"]["speedup"], 1)

    def test_rounds_that_waited_are_left_out(self):
        rounds = [(9, 0.5), (1, 0), (2, 0), (8, 0.9), (3, 0), (4, 0), (7, 0.4), (6, 0.3)]
        self.assertEqual(calmest(rounds, lambda r: r[1]), [(1, 0), (2, 0), (3, 0), (4, 0)])

    def test_the_exponent_of_a_square_is_two(self):
        self.assertAlmostEqual(exponent([1, 10, 100], [5, 500, 50000]), 2)


class Figures(unittest.TestCase):
    def stored(self, median):
        result = {"name": "nearest 1150x128", "median": median, "more": {},
                  "peers": {"faiss IndexFlatL2": {"median": 1, "speedup": median}}}
        return {"groups": {"core": {"results": [result]}}}

    def judged(self, median):
        [row] = [row for row in figures.judged(self.stored(median)) if row[4] is not None]
        return figures.verdict(row[2], row[3], row[4], row[6])

    def test_a_figure_is_reached_at_its_bound_and_a_miss_says_by_how_much(self):
        self.assertEqual(self.judged(1), "reached")
        self.assertEqual(self.judged(0.8), "missed by 25 %")
        self.assertEqual(self.judged(0.25), "missed 4.0 x")


class MemoryPage(unittest.TestCase):
    def drive(self, name, memory):
        more = {"candidates": 8, "memory_mib": memory, "bare_memory_mib": 100, "map_mib": 10}
        return {"name": name, "median": 1, "peers": {}, "more": more}

    def test_memory_is_judged_beside_its_figure_where_there_is_one(self):
        drives = [self.drive("drive cosplace_224 fp32", 175),
                  self.drive("drive mugs_vitb16 int8", 480), self.drive("drive other fp32", 150)]
        text = page_memory.drives_part({"groups": {"drive": {"results": drives}}})
        self.assertIn("| cosplace_224 fp32 | 175 | 100 | 10 | 65 | memory beyond ONNX Runtime and "
                      "the map at most 64 | missed by 2 % |", text)
        self.assertIn("| 370 | memory at most 320 | missed by 50 % |", text)
        self.assertIn("| other fp32 | 150 | 100 | 10 | 40 |  |  |", text)


def result(name, median, more=None, peers=None):
    return {"name": name, "median": median, "more": more or {},
            "peers": {peer: {"median": value} for peer, value in (peers or {}).items()}}


class Gains(unittest.TestCase):
    def test_the_picture_has_ours_and_each_peer_and_needs_all_measurements(self):
        network, alone = "efficientnet_lite0", {"ONNX Runtime alone": 11}
        drive = [result(f"drive {network} fp32", 1, peers=alone),
                 result(f"decision {network} fp32", 2,
                        {"frames": 12, "as_good_percent": 90, "drives": 8}, {"all 100 frames": 3}),
                 result(f"decision {network} int8", 4)]
        sizes = [result(f"memory, {network}", 5, peers=alone),
                 result(f"installed, {network}", 6, peers={"vdna package": 7})]
        stored = {"machine": {"cpu": "a < b", "cores": 2},
                  "groups": {"drive": {"results": drive}, "footprint": {"results": sizes}}}
        with tempfile.TemporaryDirectory() as folder:
            gains.write(stored, Path(folder))
            text = (Path(folder) / "gains.svg").read_text()
        for shown in ("2 s<", "12 frames<", "3 s<", "4 s<", "5 MiB<", "6 MiB<", "7 MiB<", "11 s<",
                      "11 MiB<", "a &lt; b", "90 % of 8 drives"):
            self.assertIn(shown, text)
        sizes.pop()
        with tempfile.TemporaryDirectory() as folder:
            gains.write(stored, Path(folder))
            self.assertEqual(list(Path(folder).iterdir()), [])


class Plots(unittest.TestCase):
    def test_bars_are_as_long_as_their_values(self):
        plot = bars("title", [("group", [("ours", 4, True), ("theirs", 2, False)])], "/s")
        self.assertIn('width="380.0"', plot)
        self.assertIn('width="190.0"', plot)

    def test_names_are_escaped(self):
        self.assertIn("a &lt; b", lines("t", "x", "y", [("a < b", [(1, 1), (2, 2)])], True))


if __name__ == "__main__":
    unittest.main()
