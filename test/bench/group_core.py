"""The parts that decide, one thread each: counting, distance, nearest neighbour, Frechet distance.

Every function yields (name, unit, units in a second, result of compare(), more numbers)."""
import numpy as np

from measure import compare
from scene import drive_along

BINS = 1000
CANDIDATE_BYTES = 256 << 20  # of different candidates; further ones repeat, to save memory
LIVE, MAP = 100, 1150  # frames
TOP = 5  # places of a ranking that are exact


def run(context):
    """All of the group."""
    small = context.tiny
    for neurons, samples in [(16, 3)] if small else [(128, 1), (768, 197), (1280, 1)]:
        yield histogram(context, neurons, samples)
        yield window(context, neurons, samples)
    for neurons in [16] if small else [128, 768, 9984]:
        for count in [2] if small else [4, 100, 1000]:
            if neurons * count < 3e6 or not context.quick:
                yield emd(context, neurons, count)
    yield pairs(context, *((16, 8) if small else (768, 64)))
    for neurons, count in [(16, 8)] if small else [(768, 100), (128, 1000)]:
        yield top_of_ranking(context, neurons, count)
    for rows, dim in [(50, 8)] if small else [(1150, 128), (1150, 768), (100000, 768)]:
        yield nearest(context, rows, dim)
    yield nearest_by_codes(context, *((50, 8) if small else (1150, 1008)))
    if context.library.has_baseline:
        for dim, frames in [(8, 20)] if small else [(128, LIVE), (768, LIVE), (768, MAP)]:
            yield frechet(context, dim, frames)


def activations(neurons, samples):
    """A frame of one tap, its ranges, and the number of frames in a round."""
    frame = np.random.default_rng(1).normal(size=(samples, neurons)).astype(np.float32)
    return frame, np.tile(np.float32([-4, 4]), (neurons, 1)), max(1, 400_000 // frame.size)


def window(context, neurons, samples):
    """Count frames in a full window, so that each also removes one."""
    from libvdna import Histogram
    from libvdna.activations import Taps
    frame, ranges, frames = activations(neurons, samples)
    table, taps = Histogram(ranges, BINS), Taps([frame])
    add = context.library.window(ranges, taps, 4)
    peers = {"counting alone": lambda: context.library.hist_add(table, taps, frames)}
    timed = scaled(compare(lambda: add(frames), peers, context.seconds), frames)
    return f"window {neurons}x{samples}", "ns/activation", 1e9 / frame.size, timed, {}


def histogram(context, neurons, samples):
    """Count frames of one tap."""
    from libvdna import Histogram
    from libvdna.activations import Taps
    frame, ranges, frames = activations(neurons, samples)
    table, taps = Histogram(ranges, BINS), Taps([frame])
    library = context.library

    def ours():
        library.hist_add(table, taps, frames)

    counts, cells = np.zeros((BINS, neurons), np.uint32), cells_of(frame)
    peers = {"reading the activations": lambda: library.read(frame, times=frames),
             "adding one to cells that are given": lambda: library.increment(counts, cells, frames)}
    timed = scaled(compare(ours, peers, context.seconds), frames)
    if context.peers.package:
        package, one = package_histogram(context, frame, 64), package_histogram(context, frame, 1)
        for name, work, count in (("vdna package, batches of 64", package, 64),
                                  ("vdna package, frame by frame", one, 1)):
            theirs = compare(ours, {name: work}, context.seconds)["peers"][name]
            timed["peers"][name] = {"median": theirs["median"] / count,
                                    "speedup": theirs["speedup"] * frames / count}
    return f"histogram {neurons}x{samples}", "ns/activation", 1e9 / frame.size, timed, {}


def cells_of(frame):
    """Indices into counts [BINS][neurons] of the samples of a frame of activations()."""
    bins = np.clip((frame.astype(np.float64) / 4 + 1) * BINS / 2, 0, BINS - 1).astype(np.uint32)
    return (bins * np.uint32(frame.shape[1]) + np.arange(frame.shape[1], dtype=np.uint32)).ravel()


def scaled(timed, count):
    """The same per item, if each call did `count` items."""
    for numbers in (timed, *timed["peers"].values()):
        for key in ("median", "least", "most"):
            if key in numbers:
                numbers[key] /= count
    return timed


def package_histogram(context, frame, batch):
    """The reference package's work on a batch of activations."""
    torch, stats = context.peers.torch, context.peers.package
    samples, neurons = frame.shape
    values = torch.from_numpy(frame.T.copy()).reshape(1, neurons, samples, 1).repeat(batch, 1, 1, 1)
    mean = torch.zeros(1, neurons, 1, 1, dtype=torch.double)
    std = torch.full((1, neurons, 1, 1), 4, dtype=torch.double)
    total = torch.zeros((neurons, BINS), dtype=torch.long)

    def work():
        total.add_(stats.histogram_per_channel((values - mean) / std, BINS, [-1.0, 1.0]))
    return work


def random_dna(neurons, mass, seed, bins=BINS):
    """Counts [bins][neurons] of samples that cluster in the middle, like those of networks."""
    random = np.random.default_rng(seed)
    places = np.clip(random.normal(bins / 2, bins / 10, (mass, neurons)), 0, bins - 1).astype(int)
    flat = places * neurons + np.arange(neurons)
    counts = np.bincount(flat.ravel(), minlength=bins * neurons)
    return counts.reshape(bins, neurons).astype(np.uint32)


def emd(context, neurons, count):
    """Rank candidates by their distance to one live Visual DNA."""
    from libvdna import HistogramView
    from libvdna._library import HistView, RankPlace, lib
    from libvdna.distance import _scratch_for
    ranges = np.tile(np.float32([0, 1]), (neurons, 1))
    distinct = max(2, min(count, CANDIDATE_BYTES // (neurons * BINS * 4)))
    live = HistogramView(ranges, random_dna(neurons, LIVE, 0))
    tables = [HistogramView(ranges, random_dna(neurons, MAP, 1 + i)) for i in range(distinct)]
    views = (HistView * count)(*[tables[i % distinct]._view for i in range(count)])
    places, scratch = (RankPlace * count)(), _scratch_for(live._view)

    def ours():
        lib.vdna_rank(live._view, views, count, scratch.ctypes.data, scratch.nbytes, places)

    used = [tables[i % distinct] for i in range(min(count, distinct))]
    peers = emd_peers(context, live, used)
    timed = scaled(compare(ours, {}, context.seconds), count)
    few = (HistView * len(used))(*[table._view for table in used])

    def ours_of_used():
        lib.vdna_rank(live._view, few, len(used), scratch.ctypes.data, scratch.nbytes, places)

    for name, (work, done) in peers.items():
        theirs = compare(ours_of_used, {name: work}, context.seconds)["peers"][name]
        timed["peers"][name] = {"median": theirs["median"] / done,
                                "speedup": theirs["speedup"] * len(used) / done}
    return (f"EMD {neurons} neurons, K={count}", "us/candidate", 1e6, timed,
            {"distinct_candidates": distinct})


def pairs(context, neurons, count):
    """Distances of each of `count` live runs to each of as many candidates."""
    from libvdna import HistogramView
    from libvdna._arrays import block
    from libvdna._library import HistView, c_double, lib
    ranges = np.tile(np.float32([0, 1]), (neurons, 1))
    sides = []
    for mass, seed in ((LIVE, 0), (MAP, count)):
        tables = [HistogramView(ranges, random_dna(neurons, mass, seed + i)) for i in range(count)]
        sides.append((tables, (HistView * count)(*[table._view for table in tables])))
    (_, live), (_, candidates) = sides
    scratch = block(lib.vdna_emd_block_scratch_size(neurons))
    distances, one = np.empty((count, count)), c_double()

    def ours():
        lib.vdna_emd_block(live, count, candidates, count, scratch.ctypes.data, scratch.nbytes,
                           distances.ctypes.data)

    def one_by_one():
        for p in live:
            for q in candidates:
                lib.vdna_emd_mean(p, q, scratch.ctypes.data, scratch.nbytes, one)

    timed = scaled(compare(ours, {"vdna_emd_mean": one_by_one}, context.seconds), count * count)
    assert distances[-1][-1] == one.value
    return f"pairs of {count} and {count}, {neurons} neurons", "us/pair", 1e6, timed, {}


def bootstraps(neurons, count):
    """Counts of a warmup, and of candidates as alike as candidates can be: one traversal whose
    frames change slowly, drawn with replacement."""
    random = np.random.default_rng(1)
    steps = random.normal(size=(MAP, neurons))
    for i in range(1, MAP):
        steps[i] = 0.95 * steps[i - 1] + 0.31 * steps[i]
    middle = random.normal(BINS / 2, 60, neurons)
    places = np.clip(middle + 100 * steps, 0, BINS - 1).astype(int) * neurons + np.arange(neurons)

    def counts_of(frames):
        counts = np.bincount(places[frames].ravel(), minlength=BINS * neurons)
        return counts.reshape(BINS, neurons).astype(np.uint32)

    return counts_of(np.arange(MAP // 4, MAP // 4 + LIVE)), [
        counts_of(random.integers(0, MAP, MAP)) for _ in range(count)]


def top_of_ranking(context, neurons, count):
    """Rank candidates that are hard to tell apart, the first TOP by distance, the rest by bounds."""
    from libvdna import HistogramView, bound_sums
    from libvdna._arrays import block
    from libvdna._library import HistView, RankPlace, c_uint8, lib
    live_counts, candidate_counts = bootstraps(neurons, count)
    ranges = np.tile(np.float32([0, 1]), (neurons, 1))
    live = HistogramView(ranges, live_counts)
    tables = [HistogramView(ranges, counts) for counts in candidate_counts]
    sums = np.stack([bound_sums(table) for table in tables])
    views = (HistView * count)(*[table._view for table in tables])
    places, all_places = (RankPlace * count)(), (RankPlace * count)()
    is_bound = (c_uint8 * count)()
    scratch = block(lib.vdna_rank_top_scratch_size(neurons, BINS))

    def ours():
        lib.vdna_rank_top(live._view, views, sums.ctypes.data, count, TOP, scratch.ctypes.data,
                          scratch.nbytes, places, is_bound)

    def whole():
        lib.vdna_rank(live._view, views, count, scratch.ctypes.data, scratch.nbytes, all_places)

    timed = compare(ours, {"vdna_rank": whole}, context.seconds)
    assert all(bytes(a) == bytes(b) for a, b in zip(places[:TOP], all_places[:TOP]))
    distances = {place.candidate: place.distance_bins for place in all_places}
    shares = [place.distance_bins / distances[place.candidate] for place in places
              if is_bound[place.candidate]]
    return (f"top {TOP} of {count}, {neurons} neurons", "ms", 1e3, timed,
            {"exact_percent": 100 * (count - sum(is_bound)) / count,
             "bound_over_distance": float(np.mean(shares)) if shares else 1.0,
             "sums_kib_per_candidate": sums[0].nbytes / 1024})


def emd_peers(context, live, used):
    """{name: (callable, number of candidates per call)}; each peer with its preferred data layout.
    Slow ones do one candidate only."""
    p, peers, library = live.counts, context.peers, context.library
    rows = [np.ascontiguousarray(table.counts.T) for table in used]
    row_p = np.ascontiguousarray(p.T)
    works = {
        "reading both": (lambda: [library.read(p, table.counts) for table in used], len(used)),
        "the same, neuron-major": (lambda: [library.emd_neuron_major(row_p, row, LIVE, MAP)
                                            for row in rows], len(used)),
        "numpy cumsum": (lambda: numpy_emd(row_p, rows[0]), 1),
    }
    if peers.package:
        torch, distance = peers.torch, peers.package.earth_movers_distance
        live_t, one = (torch.from_numpy(row.astype(np.int32)) for row in (row_p, rows[0]))
        works["vdna package"] = (lambda: torch.mean(distance(live_t, one)), 1)
    if peers.faiss:
        works["faiss L1 of float CDFs"] = (faiss_l1(peers.faiss, row_p, rows), len(used))
    if len(p[0]) <= 768 and len(used) <= 4:
        place = np.arange(BINS, dtype=np.float64)
        if peers.scipy_stats:
            wasserstein = peers.scipy_stats.wasserstein_distance
            works["scipy wasserstein_distance"] = (
                lambda: [wasserstein(place, place, a, b) for a, b in zip(row_p, rows[0])], 1)
        if peers.ot:
            a, b = (np.ascontiguousarray((row / row.sum(1, keepdims=True)).T)
                    for row in (row_p, rows[0]))
            places = np.tile(place[:, None], len(p[0]))
            works["POT wasserstein_1d"] = (
                lambda: peers.ot.wasserstein_1d(places, places, a, b, p=1), 1)
    return works


def numpy_emd(p, q):
    difference = p / p.sum(1, keepdims=True) - q / q.sum(1, keepdims=True)
    return np.abs(np.cumsum(difference, axis=1)).sum(1).mean()


def faiss_l1(faiss, live, candidates):
    """A search of an index of cumulative shares, which is the distance times the neurons."""
    def shares(counts):
        return (np.cumsum(counts, 1) / counts.sum(1, keepdims=True)).astype(np.float32).ravel()
    index = faiss.IndexFlat(live.size, faiss.METRIC_L1)
    for counts in candidates:
        index.add(shares(counts)[None])
    return searcher(faiss, index, shares(live))


def searcher(faiss, index, query):
    """A search for the nearest with as little Python overhead as faiss permits."""
    distance, label = np.empty(1, np.float32), np.empty(1, np.int64)
    pointers = [faiss.swig_ptr(array) for array in (query, distance, label)]
    keep = (query, distance, label)

    def work(_keep=keep):
        index.search_c(1, pointers[0], 1, pointers[1], pointers[2])
    return work


def nearest(context, rows, dim):
    """Find the nearest frame of a map."""
    from libvdna._library import KnnMatch, lib
    random = np.random.default_rng(1)
    frames = random.normal(size=(rows, dim)).astype(np.float32)
    query, match = random.normal(size=dim).astype(np.float32), np.empty(1, np.dtype(KnnMatch))
    addresses = query.ctypes.data, frames.ctypes.data, match.ctypes.data

    def ours():
        lib.vdna_knn(addresses[0], dim, addresses[1], rows, 1, addresses[2])

    peers = {"reading the embeddings": lambda: context.library.read(frames),
             "numpy": lambda: ((frames - query) ** 2).sum(1).argmin()}
    if context.peers.faiss:
        index = context.peers.faiss.IndexFlatL2(dim)
        index.add(frames)
        peers["faiss IndexFlatL2"] = searcher(context.peers.faiss, index, query)
    return f"nearest {rows}x{dim}", "us", 1e6, compare(ours, peers, context.seconds), {}


def nearest_by_codes(context, rows, dim):
    """Find the nearest frames of eight drives along one route, of which the query's is a ninth."""
    from libvdna._library import KnnMatch, lib
    random = np.random.default_rng(1)
    route = np.cumsum(random.normal(size=(20, dim)), axis=0)
    drives = [drive_along(route, random, rows) for _ in range(8)]
    query, match = drive_along(route, random, rows)[rows // 2].copy(), np.empty(1, np.dtype(KnnMatch))
    size = lib.vdna_knn_codes_size(dim, rows)
    codes = [np.empty(size // 8 + 1) for _ in drives]
    for drive, of_drive in zip(drives, codes):
        lib.vdna_knn_encode(drive.ctypes.data, dim, rows, of_drive.ctypes.data, size)

    def ours():
        for drive, of_drive in zip(drives, codes):
            lib.vdna_knn_nearest(query.ctypes.data, dim, drive.ctypes.data, rows,
                                 of_drive.ctypes.data, match.ctypes.data)

    def without():
        for drive in drives:
            lib.vdna_knn(query.ctypes.data, dim, drive.ctypes.data, rows, 1, match.ctypes.data)

    timed = compare(ours, {"vdna_knn": without}, context.seconds)
    return f"nearest by codes, 8 x {rows}x{dim}", "us", 1e6, timed, {}


def frechet(context, dim, frames):
    """Frechet distance of the embeddings of a warmup and of a map."""
    random = np.random.default_rng(1)
    mixing = random.normal(size=(dim, dim)).astype(np.float32) / np.sqrt(dim, dtype=np.float32)
    live, theirs = (np.ascontiguousarray(
        (random.normal(size=(count, dim)).astype(np.float32) @ mixing + shift).astype(np.float32))
        for count, shift in ((min(LIVE, frames), 0), (frames, 0.1)))
    peers = {}
    if context.peers.scipy_linalg:
        peers["scipy sqrtm"] = lambda: sqrtm_frechet(context.peers.scipy_linalg, live, theirs)
    timed = compare(lambda: context.library.frechet(live, theirs), peers, context.seconds, 12)
    exact = svd_frechet(live, theirs)
    error = abs(context.library.frechet(live, theirs) - exact) / exact
    return f"Frechet {dim}, {len(live)} and {frames} frames", "ms", 1e3, timed, {"error": error}


def sqrtm_frechet(linalg, a, b):
    """The usual formula."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    s1, s2 = np.cov(a, rowvar=False), np.cov(b, rowvar=False)
    root = linalg.sqrtm(s1 @ s2)
    difference = a.mean(0) - b.mean(0)
    return difference @ difference + np.trace(s1 + s2) - 2 * np.trace(root).real


def svd_frechet(a, b):
    """The sound formula, by NumPy in double precision."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    x, y = ((m - m.mean(0)) / np.sqrt(len(m) - 1) for m in (a, b))
    difference = a.mean(0) - b.mean(0)
    roots = np.linalg.svd(x @ y.T, compute_uv=False).sum()
    return difference @ difference + (x ** 2).sum() + (y ** 2).sum() - 2 * roots
