#!/usr/bin/env python3
"""The same activations give the same bits on every machine: build portable.c with every compiler
and optimisation there is, natively and for other processors (under qemu), run it on one and on two
threads, and compare each output with what is computed here from the definitions in integers.

    portable.py SOURCE_ROOT     exits with 77 if there is no compiler at all
"""
import collections
import concurrent.futures
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "test/golden"))
from make_core import bin_of, emd  # noqa: E402

FLAGS = ["-std=c99", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-pthread"]
Build = collections.namedtuple("Build", "compiler flags emulator")
BUILDS = [Build(compiler, [level], None) for compiler in ("gcc", "clang-19")
          for level in ("-O0", "-O1", "-O2", "-O3")]
BUILDS += [Build(compiler, ["-O3", "-march=native"], None) for compiler in ("gcc", "clang-19")]
BUILDS += [Build(f"{triple}-gcc", [level, "-static"], f"qemu-{processor}")
           for triple, processor in (("aarch64-linux-gnu", "aarch64"),
                                     ("arm-linux-gnueabihf", "arm"),
                                     ("s390x-linux-gnu", "s390x"))
           for level in ("-O0", "-O3")]

OK, OVERFLOW = 0, 7
INT64_MAX, UINT32_MAX, WORD = 2**63 - 1, 2**32 - 1, 2**64 - 1


# ---- portable.c once more, from the definitions ----

class Random:
    def __init__(self, state):
        self.state = state

    def below(self, limit):
        self.state = (self.state + 0x9E3779B97F4A7C15) & WORD
        x = self.state
        x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & WORD
        x = (x ^ x >> 27) * 0x94D049BB133111EB & WORD
        return ((x ^ x >> 31) >> 32) % limit


def float32(value):
    return struct.unpack("f", struct.pack("f", value))[0]


def bits(value):
    return f"{struct.unpack('=Q', struct.pack('=d', value))[0]:016x}"


def float_of(word):
    return struct.unpack("=f", struct.pack("=I", word))[0]


def bits_of_float(value):
    return struct.unpack("=I", struct.pack("=f", value))[0]


def exponent(neuron):
    return neuron * 7 % 60 - 45


Tap = collections.namedtuple("Tap", "neurons samples tokens")
LARGE = [Tap(12, 197, True), Tap(2, 3136, False), Tap(40, 1, True)]
SMALL = [Tap(8, 5, True), Tap(4, 9, False), Tap(6, 1, True)]
CANDIDATES, FRAMES, BINS = 5, 4, 1000


def frame(taps, random, shift):
    """Samples of each neuron, all taps together."""
    neurons = []
    for tap in taps:
        rows = [[] for _ in range(tap.neurons)]
        for i in range(tap.neurons * tap.samples):
            neuron = i % tap.neurons if tap.tokens else i // tap.samples
            coarse, fine = random.below(65536) + 3000 * shift, random.below(65536)
            rows[neuron].append((128 * coarse + fine - 4000000) * 2.0 ** exponent(neuron))
        neurons += rows
    return neurons


class Histogram:
    def __init__(self, ranges, bins):
        self.ranges, self.frames = ranges, 0
        self.counts = [[0] * bins for _ in ranges]
        self.saturated = [0] * len(ranges)

    def add(self, neurons):
        for n, samples in enumerate(neurons):
            lo, hi = self.ranges[n]
            for value in samples:
                self.counts[n][bin_of(value, lo, hi, len(self.counts[n]))] += 1
                self.saturated[n] += abs((value - (lo + hi) / 2) / ((hi - lo) / 2)) > 1
        self.frames += 1

    def line(self, name):
        digest = 0xCBF29CE484222325
        rows = list(zip(*self.counts)) + [[sum(c) for c in self.counts], self.saturated]
        for row in rows:
            for word in row:
                digest = (digest ^ word) * 0x100000001B3 & WORD
        return f"frames {self.frames} {name} {digest:016x}"


def counted(ranges, random, shift):
    hist = Histogram(ranges, BINS)
    for _ in range(FRAMES):
        hist.add(frame(LARGE, random, shift))
    return hist


def distances(p, q):
    return [float(emd(a, b)) for a, b in zip(p.counts, q.counts)]


def mean(values):
    total = 0.0
    for value in values:
        total += value
    return total / len(values)


def ranking(live, candidates):
    """[(distance, candidate)], and the lines that show it."""
    entries = sorted((mean(distances(live, c)), i) for i, c in enumerate(candidates))
    values = [d for d, _ in entries]
    return entries, [f"rank {i} {c} {int(values.count(d) > 1)} {bits(d)}"
                     for i, (d, c) in enumerate(entries)]


def embedding(random, dim):
    return [(random.below(2000) - 1000) / 64 for _ in range(dim)]


def selection(candidates, ranges):
    dim, rows = 11, 6
    random = Random(8)
    maps = [[embedding(random, dim) for _ in range(rows)] for _ in candidates]
    random, live, queries = Random(7), Histogram(ranges, BINS), []
    for f in range(FRAMES + 3):
        neurons = frame(LARGE, random, 3)
        if f < FRAMES:
            live.add(neurons)
        queries.append(embedding(random, dim))
    entries, lines = ranking(live, candidates)

    yield from ["select 0 0"] * (FRAMES - 1) + ["select 1 1"]
    for query in queries[FRAMES:]:
        near = [sum((a - b) ** 2 for a, b in zip(query, row)) for row in maps[entries[0][1]]]
        best = min(range(rows), key=lambda i: near[i])
        yield f"select 1 0 {best} {bits(near[best])}"
    yield f"chosen {entries[0][1]} {bits(entries[1][0] - entries[0][0])}"
    yield from lines


def expected_ranking():
    random = Random(1)
    seen = [frame(LARGE, random, 4 * shift) for shift in range(2)]
    factor, ranges = float32(float32(0.9) + float32(0.2)), []
    for samples in zip(*seen):
        lo, hi = min(map(min, samples)), max(map(max, samples))
        mid, half = (lo + hi) / 2, (hi - lo) / 2
        ranges.append((float32(mid - half * factor), float32(mid + half * factor)))
    for i, edge in enumerate(edge for lo_hi in ranges for edge in lo_hi):
        yield f"range {i} {bits_of_float(edge):08x}"

    candidates = [counted(ranges, Random(100 + c), c) for c in range(CANDIDATES - 1)]
    candidates.append(candidates[0])
    for candidate in candidates:
        yield candidate.line("candidate")
    live = counted(ranges, Random(6), 1)
    yield live.line("live")
    for c, candidate in enumerate(candidates):
        emds = distances(live, candidate)
        for n, distance in enumerate(emds):
            yield f"emd {c} {n} {bits(distance)}"
        yield f"mean {c} {bits(mean(emds))}"
    yield from ranking(live, candidates)[1]
    yield from selection(candidates, ranges)


def expected_window(length_us, capacity):
    ranges = [(-3500001 * 2.0 ** exponent(n), 5000000 * 2.0 ** exponent(n))
              for tap in SMALL for n in range(tap.neurons)]
    random, utime = Random(2), 0
    held, left, left_early, restarts = [], [], 0, 0
    for f in range(80):
        utime += random.below(100) - 10
        if held and utime < held[-1][0]:
            held, left, restarts = [], [], restarts + 1
        held.append((utime, frame(SMALL, random, f % 7)))
        if length_us:
            held = [h for h in held if utime - h[0] < length_us]
            left += [h[0] for h in held[:-capacity]]
            left_early += len(held[:-capacity])
        held = held[-capacity:]
        truncated = any(utime - stamp < length_us for stamp in left)
        hist = Histogram(ranges, 33)
        for _, neurons in held:
            hist.add(neurons)
        yield f"window {int(truncated)} {left_early} {restarts} " + hist.line("slid")


EDGE_RANGES = [(0xBF800000, 0x3F800000), (0x00000000, 0x3F800000), (0x3DCCCCCD, 0x3F333333),
               (0xC0400000, 0x3A83126F), (0x49742400, 0x49742410), (0x4B800000, 0x4B800001),
               (0xFF7FFFFF, 0x7F7FFFFF), (0x806CE3EE, 0x006CE3EE), (0x00000001, 0x00000400),
               (0x00000000, 0x00000001), (0x3F800000, 0x7F7FFFFF), (0xF149F2CA, 0x3F800000)]


def order_of(value):
    word = bits_of_float(value)
    return ~word & UINT32_MAX if word >> 31 else word | 0x80000000


def of_order(order):
    return float_of(order & 0x7FFFFFFF if order >> 31 else ~order & UINT32_MAX)


def expected_edges(bins):
    ranges = [(float_of(lo), float_of(hi)) for lo, hi in EDGE_RANGES]
    neurons = []
    for lo, hi in ranges:
        samples = []
        for b in range(bins + 1):
            order = order_of(float32(lo + (hi - lo) * b / bins))
            for i in range(5):
                value = of_order(order + i - 2)
                samples.append(value if value - value == 0 else of_order(order))
        neurons.append(samples)
    hist = Histogram(ranges, bins)
    hist.add(neurons)
    return hist.line("edges")


def bound_line(p, q):
    bins, mass_p, mass_q = len(p), sum(p), sum(q)
    fits = math.lcm(mass_p, mass_q) * (bins - 1) <= INT64_MAX
    value = float(emd(p, q)) if fits else 0.0
    return f"bound {bins} {mass_p} {mass_q} {OK if fits else OVERFLOW} {bits(value)}"


AT_THE_EDGE = [(2, 4042815511, 2281422937), (3, 2147483649, 2147483647),
               (3, 2147483648, 2147483648), (5, 2147483648, 1073741824),
               (257, 4092335743, 8803969), (257, 2147483648, 16777216),
               (1000, 2889827123, 3194864), (65535, 4261673988, 33025),
               (65535, 155193221, 906881), (65536, 4027576576, 34944),
               (2, 4294967295, 2147483648), (2, 4294967295, 2147483649),
               (65536, 4294967295, 4294967295)]


def expected_bounds():
    for bins, mass_p, mass_q in AT_THE_EDGE:
        yield bound_line([mass_p] + [0] * (bins - 1), [0] * (bins - 1) + [mass_q])
    random = Random(3)
    for _ in range(200):
        bins = 2 + random.below(40)
        room, p, q = 0x7FFFFFFF // bins // 7, [], []
        for _ in range(bins):
            p.append(random.below(room))
            q.append(random.below(room) if random.below(2) else p[-1])
        yield bound_line(p, q)


def expected_checksums():
    random, size = Random(4), 1
    data = [random.below(256) for _ in range(40000)]
    while size < len(data):
        crc = UINT32_MAX
        for byte in data[-size:]:
            crc ^= byte
            for _ in range(8):
                crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
        yield f"crc32c {size} {crc ^ UINT32_MAX:08x}"
        size = 2 * size + 1


def expected():
    yield from expected_ranking()
    yield from expected_window(0, 9)
    yield from expected_window(300, 7)
    for bins in (2, 7, 1000):
        yield expected_edges(bins)
    yield from expected_bounds()
    yield from expected_checksums()


# ---- Building, running, comparing ----

def output_of(build, folder):
    """Output on one thread and on two, or None if a tool is missing."""
    if not shutil.which(build.compiler) or (build.emulator and not shutil.which(build.emulator)):
        return None
    name = "_".join([build.compiler] + build.flags).replace("=", "_")
    sources = [ROOT / "test/contract/portable/portable.c", *sorted(ROOT.glob("lib/core/*.c")),
               *sorted(ROOT.glob("lib/localise/*.c")), *sorted(ROOT.glob("lib/trust/*.c")),
               *sorted(ROOT.glob("lib/select/*.c")),
               *sorted(ROOT.glob("lib/checksum/*.c"))]
    program = os.path.join(folder, name)
    subprocess.run([build.compiler, *FLAGS, *build.flags, f"-I{ROOT}/lib/include",
                    f"-I{ROOT}/lib/core", f"-I{ROOT}/lib/checksum", "-o", program, *map(str, sources)], check=True)
    run = ([build.emulator] if build.emulator else []) + [program]
    return [subprocess.run(run + [threads], check=True, stdout=subprocess.PIPE,
                           text=True).stdout.splitlines() for threads in ("1", "2")]


def first_difference(lines, wanted):
    for i, (line, want) in enumerate(zip(lines, wanted)):
        if line != want:
            return f"line {i + 1} is `{line}`, expected `{want}`"
    return f"{len(lines)} lines, expected {len(wanted)}" if len(lines) != len(wanted) else None


def main():
    with tempfile.TemporaryDirectory() as folder, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        running = [pool.submit(output_of, build, folder) for build in BUILDS]
        wanted = list(expected())
        outputs = [r.result() for r in running]
    ran = [o for o in outputs if o]
    if not ran:
        print("skipped: no gcc, no clang-19; ./dev test --all installs them")
        sys.exit(77)
    # Squared distances and localisation round and have no second implementation here: all must equal
    # the first.
    wanted += [line for line in ran[0][0] if line.startswith("same ")]

    failed = 0
    for build, output in zip(BUILDS, outputs):
        name = " ".join(filter(None, [build.compiler, *build.flags, build.emulator]))
        for threads, lines in enumerate(output or [], 1):
            difference = first_difference(lines, wanted)
            failed += difference is not None
            print(f"{name}, {threads} thread(s): {difference or 'equal'}")
        if not output:
            print(f"{name}: left out")
    if len(ran) < len(BUILDS):
        print("skipped: no cross-compilers, clang-19 or qemu for some; ./dev test --all installs them")
    print(f"{len(wanted)} lines each; {failed} outputs differ")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
