"""Growth of time with the experiences, the neurons, the bins and the frames, with a fitted
exponent: 1 = in proportion, 0 = none."""
import numpy as np

from group_core import random_dna
from measure import compare, exponent


def run(context):
    """All of the group."""
    powers = (lambda *values: values[:2]) if context.tiny else lambda *values: values
    for what, sizes, work in (
            ("ranking, by experiences", powers(4, 8, 16, 32, 64, 128), by_experiences),
            ("ranking, by neurons", powers(128, 256, 512, 1024, 2048), by_neurons),
            ("ranking, by bins", powers(250, 500, 1000, 2000, 4000), by_bins),
            ("counting 100 frames, by neurons", powers(512, 1024, 2048, 4096, 8192), by_counted),
            ("counting 100 frames, by frames counted before", powers(1, 10, 100, 1000, 10000),
             by_frames_before),
            ("localising, by frames of the map", powers(1000, 2000, 4000, 8000, 16000),
             by_map_frames)):
        points = [(size, timed(context, work(context, size))) for size in sizes]
        yield grown(f"time of {what}", "us", 1e6, points)


def grown(name, unit, scale, points, more=None):
    """A result of points [(size, value)]; its figure is that of the last."""
    sizes, values = zip(*points)
    last = dict.fromkeys(("median", "least", "most"), values[-1])
    return (name, unit, scale, {**last, "rounds": 1, "waited": 0, "peers": {}},
            {"points": [(size, scale * value) for size, value in zip(sizes, values)],
             "exponent": exponent(sizes, values), **(more or {})})


def timed(context, work):
    return compare(work, {}, context.seconds / 2)["median"]


def ranking(neurons, bins, count):
    """A ranking of `count` experiences, eight of them different."""
    from libvdna import HistogramView
    from libvdna._library import HistView, RankPlace, lib
    from libvdna.distance import _scratch_for
    ranges = np.tile(np.float32([0, 1]), (neurons, 1))

    def view(seed):
        return HistogramView(ranges, random_dna(neurons, 50, seed, bins))

    live, tables = view(0), [view(1 + i) for i in range(min(count, 8))]
    views = (HistView * count)(*[tables[i % len(tables)]._view for i in range(count)])
    places, scratch = (RankPlace * count)(), _scratch_for(live._view)
    keep = (live, tables)

    def work(_keep=keep):
        lib.vdna_rank(live._view, views, count, scratch.ctypes.data, scratch.nbytes, places)
    return work


def by_experiences(_context, count):
    return ranking(128, 1000, count)


def by_neurons(_context, neurons):
    return ranking(neurons, 1000, 4)


def by_bins(_context, bins):
    return ranking(128, bins, 4)


def counting(context, neurons, frames_before):
    from libvdna import Histogram
    from libvdna.activations import Taps
    frame = np.random.default_rng(1).normal(size=(1, neurons)).astype(np.float32)
    table, taps = Histogram(np.tile(np.float32([-4, 4]), (neurons, 1))), Taps([frame])
    context.library.hist_add(table, taps, frames_before)
    repeat = 100  # a call from Python costs as much as counting some hundred activations

    def work(_keep=frame):
        context.library.hist_add(table, taps, repeat)
    return work


def by_counted(context, neurons):
    return counting(context, neurons, 1)


def by_frames_before(context, frames):
    return counting(context, 1024, frames)


def by_map_frames(_context, rows):
    from libvdna._library import KnnMatch, lib
    random = np.random.default_rng(1)
    frames = random.normal(size=(rows, 128)).astype(np.float32)
    query, match = frames[0] + 1, np.empty(1, np.dtype(KnnMatch))

    def work(_keep=frames):
        lib.vdna_knn(query.ctypes.data, 128, frames.ctypes.data, rows, 1, match.ctypes.data)
    return work
