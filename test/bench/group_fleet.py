"""Collections of a fleet: the nearest without most of the distances, all pairs on two workers.

The experiences are made of rendered runs: 100 frames drawn with replacement, from two conditions of a
route in a mixture of their own; the hard ones all from one run. The live runs are drawn from drives
that are in none of them. All of it runs in a virtual environment with the packages of libvdna[fleet,ray].
"""
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from measure import compare, exponent

ROOT = Path(__file__).resolve().parents[2]
ROUTES, CONDITIONS, FRAMES = 5, ("summer", "autumn", "rain", "night"), 60  # of rendered runs
DRAWN = 100  # frames of an experience
NEAREST = 5
LIVE = 3  # live runs
BINS = 1000
EMBEDDING = 8  # numbers of the 1280 that an experience keeps: they only add bytes to its object


def programs(scene):
    """Where those of the virtual environment are, which needs the registry the first time."""
    sys.path.append(str(ROOT / "test" / "support"))
    import tools
    project = tomllib.loads((ROOT / "lib/python/pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    return tools.virtual_environment(scene.folder / "fleet-environment", *project["dependencies"],
                                     *extras["fleet"], *extras["ray"])


def run(context):
    """All of the group."""
    bin_folder = programs(context.scene)
    folder = context.scene.folder / ("fleet-tiny" if context.tiny else "fleet")
    folder.mkdir(exist_ok=True)
    settings = {"tiny": context.tiny, "quick": context.quick, "folder": str(folder),
                "build": str(context.build), "seconds": context.seconds}
    packages = context.build / "test" / "bench" / "python"  # see ours.py
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(packages), str(ROOT / "test/bench")])}
    program = "import group_fleet, sys; group_fleet.main(sys.argv[1])"
    with subprocess.Popen([bin_folder / "python3", "-B", "-c", program, json.dumps(settings)],
                          env=environment, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            yield json.loads(line)
    if process.returncode != 0:
        raise SystemExit("the group fleet failed")


def main(text):
    """In the virtual environment: a line for each result."""
    settings = json.loads(text)
    folder = Path(settings["folder"])
    runs = synthetic_runs() if settings["tiny"] else rendered_runs(Path(settings["build"]), folder)
    np.save(folder / "runs.npy", runs)
    for measured in all_of(settings, folder):
        print(json.dumps(measured), flush=True)


def all_of(settings, folder):
    sizes = [10, 20] if settings["tiny"] else [200, 2000] if settings["quick"] else [200, 2000, 20000]
    earlier = None
    for size in sizes:
        earlier = yield from searches(settings, folder, size, False, earlier)
    yield from searches(settings, folder, sizes[0] if settings["tiny"] else 500, True)
    yield repeated(folder, sizes[1])
    yield counted_again(folder, 5 if settings["tiny"] else 50)
    yield from engines(settings, folder, sizes[0])


# ---- Runs and experiences ----

def rendered_runs(build, folder):
    """[routes][conditions + 1][frames][neurons]: activations; the last drive of a route is live."""
    kept = folder / "rendered.npy"
    if kept.exists():
        return np.load(kept)
    work = folder / "rendered"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()

    def render(drive):
        route, condition, seed = drive
        source = work / f"{route}-{seed}"
        options = ("--frames", FRAMES, "--step", 1, "--size", "96x72", "--variation", 0.6,
                   "--condition", condition, "--seed", 200 + route, "--drive", seed)
        network = ("--backbone", "efficientnet_lite0_paper", "--threads", 1)
        for command in (("simulate", source, *options), ("build", f"{source}.map", source, *network)):
            subprocess.run([str(word) for word in (build / "bin" / "vdna", *command)], check=True,
                           stdout=subprocess.DEVNULL)
        from libvdna import Experience
        return np.array(Experience.open(f"{source}.map/{source.name}.vdna").embeddings)

    drives = [(route, condition, seed) for route in range(ROUTES)
              for seed, condition in enumerate((*CONDITIONS, CONDITIONS[2]))]
    with ThreadPoolExecutor(2) as threads:
        runs = np.stack(list(threads.map(render, drives)))
    runs = runs.reshape(ROUTES, len(CONDITIONS) + 1, FRAMES, -1)
    np.save(kept, runs)
    shutil.rmtree(work)
    return runs


def synthetic_runs():
    """The same, small and without a network."""
    random = np.random.default_rng(1)
    middle = random.normal(size=(ROUTES, len(CONDITIONS) + 1, 1, 16))
    return (middle + random.normal(size=(*middle.shape[:2], FRAMES, 16))).astype(np.float32)


def ranges_of(runs):
    """[neurons][2], of all that the runs hold."""
    from libvdna import Ranges
    ranges = Ranges(runs.shape[-1])
    for frame in runs.reshape(-1, runs.shape[-1]):
        ranges.observe(frame)
    return ranges.expand(1.2)


def experience_of(name, frames, ranges, embedding=EMBEDDING):
    from libvdna import Experience, Histogram
    histogram = Histogram(ranges, BINS)
    for frame in frames:
        histogram.add(frame)
    return Experience(
        name=name, backbone="bench", model_sha256="0" * 64, preprocessing="none",
        taps=f"bench:{frames.shape[1]}:1", histogram=histogram, embeddings=frames[:, :embedding],
        frame_utime=np.arange(len(frames), dtype=np.int64), frame_grey=np.zeros(len(frames), np.float32))


def add(uri, runs_file, begin, end, hard):
    """Task: experiences `begin` to `end` of a collection."""
    from libvdna.fleet import Collection, Labels
    runs, collection = np.load(runs_file), Collection(uri)
    ranges = ranges_of(runs)
    for number in range(begin, end):
        random = np.random.default_rng(number)
        route = 0 if hard else number % ROUTES
        first, second = random.choice(len(CONDITIONS), 2, replace=False) if not hard else (0, 0)
        side = np.where(random.random(DRAWN) < random.random(), first, second)
        frames = runs[route][side, random.integers(FRAMES, size=DRAWN)]
        one = experience_of(f"run{number:06}", frames, ranges)
        collection.add(one.to_bytes(), Labels(f"route{route}"))


def live_runs(runs, hard):
    ranges, random = ranges_of(runs), np.random.default_rng(2**31)
    drives = [runs[0, 0]] * LIVE if hard else runs[:LIVE, -1]
    return [experience_of("live", drive[random.integers(FRAMES, size=DRAWN)], ranges) for drive in drives]


# ---- Measurements ----

def processor_seconds():
    """Of this process and its children that have ended."""
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def here():
    """An engine without processes."""
    return ThreadPoolExecutor(1)


def timed(seconds):
    return {"median": statistics.median(seconds), "least": min(seconds), "most": max(seconds),
            "rounds": len(seconds), "waited": 0, "peers": {}}


def searches(settings, folder, count, hard, earlier=None):
    """Make a collection and its index, and find the nearest of some live runs in it.

    earlier: what the last call returned, for the exponents"""
    from libvdna import fleet
    uri = folder / ("hard" if hard else f"mixed-{count}")
    shutil.rmtree(uri, ignore_errors=True)
    collection, two = fleet.Collection(str(uri)), fleet.local(2)
    at_once = max(1, count // 20)
    done = fleet.run(two, add, [(str(uri), str(folder / "runs.npy"), begin, min(begin + at_once, count), hard)
                                for begin in range(0, count, at_once)])
    assert not any(one.failure for one in done), done[0].failure
    comparable = collection.only_comparable()
    before = processor_seconds()
    assert fleet.update(collection, comparable, two).rows == count
    indexing = processor_seconds() - before

    runs = np.load(folder / "runs.npy")
    lives = live_runs(runs, hard)
    every, expected, object_bytes = all_distances(collection, comparable, lives)
    found = [fleet.nearest(collection, live.histogram, comparable, NEAREST) for live in lives]
    for one, least in zip(found, expected):
        assert [neighbour.distance_bins for neighbour in one.neighbours] == least, (one, least)

    def ours():
        for live in lives:
            fleet.nearest(collection, live.histogram, comparable, NEAREST)

    times = compare(ours, {}, settings["seconds"], 8)
    for key in ("median", "least", "most"):
        times[key] /= LIVE
    times["peers"] = {"all distances": {"median": every, "speedup": every / times["median"]}}
    exact, read = (statistics.fmean(getattr(one, key) for one in found) for key in ("exact", "bytes_read"))
    index_bytes = sum(path.stat().st_size for path in (uri / "index").iterdir())
    more = {"exact_distances": exact, "exact_percent": 100 * exact / count, "read_mib": read / 2**20,
            "read_percent": 100 * read / object_bytes, "object_kib": object_bytes / count / 1024,
            "index_row_kib": index_bytes / count / 1024, "index_ms_per_experience": 1e3 * indexing / count}
    sums = {"count": count, "time": times["median"], "distances": exact, "bytes": read}
    if earlier:
        counts = earlier["count"], count
        more |= {f"exponent_of_{key}": exponent(counts, (earlier[key], sums[key]))
                 for key in ("time", "distances", "bytes")}
    what = "bootstraps of one run" if hard else "mixed runs"
    yield (f"nearest {NEAREST} of {count} {what}, {runs.shape[-1]} neurons", "ms", 1e3, times, more)
    return sums


def all_distances(collection, comparable, lives):
    """Processor seconds that the nearest of one live run takes without bounds; the least distances of
    each, and the bytes of all objects."""
    from libvdna import emd_mean
    names = list(collection.names(comparable))
    tables, seconds, before = [[] for _ in lives], 0, collection.bytes_read
    for name in names:
        begin = time.process_time()
        stored = collection.load(comparable, name).experience.histogram
        tables[0].append(emd_mean(lives[0].histogram, stored))
        seconds += time.process_time() - begin
        for live, table in zip(lives[1:], tables[1:]):
            table.append(emd_mean(live.histogram, stored))
    return seconds, [sorted(table)[:NEAREST] for table in tables], collection.bytes_read - before


def repeated(folder, count):
    """Find the duplicates of a collection, which has none."""
    from libvdna import fleet
    collection = fleet.Collection(str(folder / f"mixed-{count}"))
    begin = time.process_time()
    found = fleet.duplicates(collection, collection.only_comparable(), 0, here)
    seconds = time.process_time() - begin
    assert not found.duplicates
    return f"duplicates of {count} on {ROUTES} routes", "s", 1, timed([seconds]), {
        "pairs": found.pairs, "exact_distances": found.exact}


def counted_again(folder, count):
    """Count experiences again in other bins, from all of their embeddings."""
    from libvdna import fleet
    runs, uri = np.load(folder / "runs.npy"), folder / "rebin"
    shutil.rmtree(uri, ignore_errors=True)
    collection, ranges = fleet.Collection(str(uri)), ranges_of(runs)
    for number in range(count):
        frames = runs[0, 0][np.random.default_rng(number).integers(FRAMES, size=DRAWN)]
        one = experience_of(f"run{number}", frames, ranges, runs.shape[-1])
        collection.add(one.to_bytes(), fleet.Labels())
    comparable = collection.only_comparable()
    collection.put("ranges.json", json.dumps({"range": (2 * ranges).tolist()}).encode())
    begin = time.process_time()
    assert fleet.rebin(collection, comparable, here) == (count, 0, [])
    seconds = (time.process_time() - begin) / count
    return f"rebin an experience of {DRAWN} frames", "ms", 1e3, timed([seconds]), {}


def engines(settings, folder, count):
    """All pairs on two workers beside one process and Ray; and what a single task takes."""
    from libvdna import fleet
    collection = fleet.Collection(str(folder / f"mixed-{count}"))
    comparable, out = collection.only_comparable(), str(folder / "pairs.parquet")
    two, one, ray = fleet.local(2), here, fleet.on_ray(2)

    def pairs(engine):
        done = fleet.pairs(collection, comparable, out, engine)
        assert done == (count * (count - 1) // 2, []), done

    def task(engine):
        assert fleet.run(engine, os.path.basename, [("a/b",)])[0].result == "b"

    rounds = 1 if settings["tiny"] else 3 if settings["quick"] else 5
    for name, work, peers in (
            (f"pairs of {count} on two workers", pairs, {"one process": one, "Ray, two workers": ray}),
            ("one task on two workers", task, {"Ray, two workers": ray})):
        seconds = {engine: [] for engine in (two, *peers.values())}
        processor = {engine: [] for engine in seconds}
        for _ in range(rounds):
            for engine, taken in seconds.items():
                begin, processor_begin = time.perf_counter(), processor_seconds()
                work(engine)
                taken.append(time.perf_counter() - begin)
                processor[engine].append(processor_seconds() - processor_begin)
        times = timed(seconds[two])
        for peer, engine in peers.items():
            times["peers"][peer] = {
                "median": statistics.median(seconds[engine]),
                "speedup": statistics.median(b / a for a, b in zip(seconds[two], seconds[engine]))}
        # That of Ray's workers, whose parent is not this process, is not known.
        yield name, "s", 1, times, {
            f"processor_s_{what}": statistics.median(processor[engine])
            for what, engine in (("two_workers", two), ("one_process", one)) if processor.get(engine)}
