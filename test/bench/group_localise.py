"""A frame of the localiser, the step of its filter included, beside a search for the nearest row alone, which is
all that one fused map costs, and beside SeqSLAM; and a frame of a warmup with trust.

Every function yields (name, unit, units in a second, result of compare(), more numbers)."""
import ctypes
import statistics

import numpy as np

from group_core import scaled, searcher
from measure import LEAST_ROUNDS, compare

NETWORK = "efficientnet_lite0"
LIVE = 8  # frames that take turns, so that the robot always moves


def run(context):
    """All of the group."""
    inference = inference_seconds(context)
    for rows, dim in [(50, 8)] if context.tiny else [(1150, 64), (1150, 1008), (100000, 64),
                                                     (100000, 1008)]:
        if rows * dim < 1e8 or not context.quick:
            yield localise(context, rows, dim, inference if rows <= 1150 else None)
    for count in [2] if context.tiny else [4] if context.quick else [4, 100]:
        yield warm_up(context, count, *((50, 8, 12) if context.tiny else (1150, 1008, 1280)), inference)


def inference_seconds(context):
    """Median of the default network's inferences, or None without networks."""
    if not context.library.has_backbone:
        return None
    jpeg = context.scene.pictures(3)[0].read_bytes()
    backbone = context.library.open_backbone(context.scene.manifest(NETWORK), 2)
    rounds = LEAST_ROUNDS if context.tiny else 60
    took = [backbone.run(jpeg)[2] / 1e6 for _ in range(rounds)]
    backbone.close()
    return statistics.median(took)


def localise(context, rows, dim, inference):
    """Localise frames of a drive among random rows."""
    from libvdna import Localiser
    from libvdna._library import KnnMatch, LocaliseAnswer, lib
    random = np.random.default_rng(1)
    frames = random.normal(size=(rows, dim)).astype(np.float32)
    live = random.normal(size=(LIVE, dim)).astype(np.float32)
    localiser, answer = Localiser(frames, tolerance=5), LocaliseAnswer()
    addresses = [frame.ctypes.data for frame in live]
    handle, out = localiser._localise, ctypes.byref(answer)

    def ours():
        for address in addresses:
            lib.vdna_localise_feed(handle, address, out)

    seqslam = SeqSlam(frames)
    match = np.empty(1, np.dtype(KnnMatch))
    nearest = addresses[0], dim, frames.ctypes.data, rows, 1, match.ctypes.data
    peers = {"vdna_knn, the nearest alone": lambda: [lib.vdna_knn(*nearest) for _ in live],
             "SeqSLAM in NumPy": lambda: [seqslam.step(frame) for frame in live]}
    if context.peers.faiss:
        index = context.peers.faiss.IndexFlatL2(dim)
        index.add(frames)
        search = searcher(context.peers.faiss, index, live[0])
        peers["faiss IndexFlatL2"] = lambda: [search() for _ in live]
    timed = scaled(compare(ours, peers, context.seconds), LIVE)
    more = {"of_an_inference_percent": 100 * timed["median"] / inference} if inference else {}
    return f"localise {rows}x{dim}", "us", 1e6, timed, more


def warm_up(context, count, rows, dim, last_dim, inference):
    """A frame of a warmup of a selector with trust among experiences of random rows; its Visual DNA is of one
    neuron, so nearly all is trust's."""
    from libvdna import Candidate, Histogram, Selector, StoredRun, Trust, TrustTables
    from libvdna._library import Activations, SelectAnswer, SelectFrame, lib
    random = np.random.default_rng(1)
    histogram = Histogram(np.array([[-1, 1]], np.float32), bins=2)
    histogram.add(np.zeros(1, np.float32))
    candidates = [Candidate(histogram, random.standard_normal((rows, dim), np.float32)) for _ in range(count)]
    runs = [StoredRun(candidate.embeddings, last_layer=random.standard_normal((rows, last_dim), np.float32))
            for candidate in candidates]
    tables = TrustTables(np.full(count, rows, np.uint32), np.ones(count), np.ones(count),
                         np.full((count, count, 4, 7), 0.5))
    selector = Selector(candidates, warmup_frames=2 ** 32 - 1, trust=Trust(tables), runs=runs)
    embedding = random.standard_normal(dim, np.float32)
    last_layer = random.standard_normal(last_dim, np.float32)
    activation = np.zeros(1, np.float32)
    tap = Activations(activation.ctypes.data, 1, 1, 0)
    frame = SelectFrame(0, ctypes.pointer(tap), 1, embedding.ctypes.data)
    arguments = selector._select, ctypes.byref(frame), last_layer.ctypes.data, ctypes.byref(SelectAnswer())
    timed = compare(lambda: lib.vdna_select_feed_seen(*arguments), seconds=context.seconds)
    more = {"of_an_inference_percent": 100 * timed["median"] / inference} if inference else {}
    return f"warm up with trust {count}x{rows}x{dim}", "us", 1e6, timed, more


class SeqSlam:
    """The frame at the end of the best line of 10 frames, as `vdna eval` has it; one frame at a time."""

    def __init__(self, frames):
        self.frames, self.norms = frames, (frames ** 2).sum(axis=1)
        index = np.arange(len(frames))
        begin, self.end = np.maximum(index - 5, 0), np.minimum(index + 6, len(frames))
        self.begin, self.count = begin, self.end - begin
        self.lines = [[np.maximum(index - (v * back + 5) // 10, 0) for back in range(10)]
                      for v in (8, 9, 10, 11, 12)]
        self.rows = []

    def step(self, live):
        squared = self.norms - 2 * (self.frames @ live) + live @ live
        distances = np.sqrt(np.maximum(squared, 0))
        sums, squares = (np.concatenate([[0], np.cumsum(x, dtype=np.float64)])
                         for x in (distances, distances ** 2))
        mean, square = ((x[self.end] - x[self.begin]) / self.count for x in (sums, squares))
        contrast = (distances - mean) / np.sqrt(np.maximum(square - mean ** 2, 1e-12))
        self.rows = [contrast, *self.rows[:9]]
        return min((np.sum([row[at] for row, at in zip(self.rows, line)], axis=0)
                    for line in self.lines), key=np.min).argmin()
