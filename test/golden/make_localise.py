#!/usr/bin/env python3
"""Write localise_golden.h: place filter, live mean and distances by a second implementation, for
test_localise.c.

The definition of vdna/localise.h in IEEE doubles, one number at a time, in plain Python; NumPy only
makes the inputs and their float32. The filter is given distances rounded to float32, as the library
has them, so its results must agree to 1e-9, the difference of sums in another order.

    test/golden/make_localise.py > test/golden/localise_golden.h      (NumPy 1.24, Python 3.11)
"""
import math
import textwrap

import numpy as np

PLACE_NONE = -2**63
GEARS = [(-1, [.02, .2, .4, .25, .1, .03]), (2, [.15, .3, .3, .15, .1, 0]), (-4, [.03, .1, .25, .4, .22, 0])]
OTHER_GEARS = [(-8, [.5, .1, .1, .1, .1, .1]), (3, [.1, .1, .1, .1, .1, .5])]
DEFAULTS = {"gears": GEARS, "jump": 0.01, "gear_change": 0.05, "sharpness": 2.0, "clutter": 0.1,
            "evidence_share": 0.15, "confidence": (3.6, 0.53, 1.1, -12)}
OTHERS = {"gears": OTHER_GEARS, "jump": 0.2, "gear_change": 0.3, "sharpness": 1.5, "clutter": 0.4,
          "evidence_share": 0.5, "confidence": (-1.0, 0.4, 0.7, 0.3)}


def same_place(a, b, tolerance):
    if PLACE_NONE in (a, b):
        return False
    return abs(a - b) <= tolerance


class Filter:
    def __init__(self, frames, tolerance, places=None, **options):
        self.options, self.frames = {**DEFAULTS, **options}, frames
        places = list(range(frames)) if places is None else places
        # Windows in the order of places; their frames too.
        order = sorted(range(frames), key=lambda j: (places[j], j))
        self.windows = [[k for k in order if k == j or same_place(places[j], places[k], tolerance)]
                        for j in order]
        gears = len(self.options["gears"])
        self.p = [[1 / (gears * frames)] * frames for _ in range(gears)]
        self.evidence, self.started = 0.0, False

    def move(self):
        o, n, gears = self.options, self.frames, len(self.p)
        moved = []
        for (first, shares), p in zip(o["gears"], self.p):
            q = [0.0] * n
            for j in range(n):
                source = (1 - o["gear_change"]) * p[j] + o["gear_change"] / gears * sum(g[j] for g in self.p)
                for k, share in enumerate(shares):
                    q[min(max(j + first + k, 0), n - 1)] += share * source
            moved.append([(1 - o["jump"]) * x + o["jump"] / (gears * n) for x in q])
        self.p = moved

    def step(self, d):
        o, n = self.options, self.frames
        mean = sum(d) / n
        deviation = math.sqrt(sum((x - mean) ** 2 for x in d) / n)
        z = [(mean - x) / (deviation + 1e-9) for x in d]
        e = [math.exp(o["sharpness"] * (x - max(z))) for x in z]
        weights = [(1 - o["clutter"]) * x * n / sum(e) + o["clutter"] for x in e]
        if self.started:
            self.move()
        v = [[x * w for x, w in zip(p, weights)] for p in self.p]
        total = sum(map(sum, v))
        self.p = [[x / total for x in p] for p in v]
        if self.started:
            self.evidence += o["evidence_share"] * (math.log(total) - self.evidence)
        self.started = True
        place = self.places()
        masses = [sum(place[k] for k in window) for window in self.windows]
        best = masses.index(max(masses))
        frame = max(self.windows[best], key=lambda k: place[k])
        m = min(max(masses[best], 1e-9), 1 - 1e-9)
        logit = min(max(math.log(m / (1 - m)), -8), 8)
        c = o["confidence"]
        least = min(d[k] for k in self.windows[best])
        logit = c[0] + c[1] * logit + c[2] * self.evidence + c[3] * least
        return frame, 1 / (1 + math.exp(-logit)), m

    def places(self):
        return [sum(column) for column in zip(*self.p)]


def unit(v):
    length = max(math.sqrt(sum(x * x for x in v)), 1e-12)
    return [x / length for x in v]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


class Live:
    """The live mean and the distances in an experience."""

    def __init__(self, frames, mean_frames):
        n, steps = len(frames), []
        self.mean = [sum(column) / n for column in zip(*frames)]
        self.rows = [unit(minus(frame, self.mean)) for frame in frames]
        for a, b in zip(frames, frames[1:]):
            steps.append(float(np.float32(math.sqrt(sum(x * x for x in minus(b, a))))))
        steps.sort()
        self.step = (steps[(len(steps) - 1) // 2] + steps[len(steps) // 2]) / 2
        self.n, self.last = mean_frames, None

    def add(self, x):
        if self.last and math.sqrt(sum(y * y for y in minus(x, self.last))) <= 0.15 * self.step:
            return False
        self.n = min(self.n + 1, 1000)
        self.mean = [m + (y - m) / self.n for m, y in zip(self.mean, x)]
        self.last = x
        return True

    def distances(self, x):
        u = unit(minus(x, self.mean))
        return [1 - sum(a * b for a, b in zip(row, u)) for row in self.rows]


# ---- inputs

FRAMES, STEPS, TOLERANCE = 41, 12, 2


def rows(random):
    """Distances of a drive forwards with a kidnapping, some frames of which say nothing."""
    out = []
    for t in range(STEPS):
        truth = 7 + 2 * t if t < 6 else 38 - t
        d = 1 + 0.25 * random.normal(size=FRAMES)
        if t not in (3, 9):
            d -= 0.6 * np.exp(-0.5 * (np.arange(FRAMES) - truth) ** 2)
        out.append(d.astype(np.float32))
    return out


def loop():
    """Places of a route that passes 0..14 twice, backwards the second time, from afar in between."""
    places = [1000 + 3 * j for j in range(15)] + [-50 - j for j in range(10)]
    places += [1000 + 3 * j + 1 for j in reversed(range(15))] + [PLACE_NONE]
    return places


def c_array(kind, name, values, form):
    text = textwrap.fill(", ".join(form(v) for v in values), 96)
    return f"static const {kind} {name}[] = {{\n{text}}};\n"


def print_filter(name, distances, filter_):
    answers = [filter_.step([float(x) for x in d[:filter_.frames]]) for d in distances]
    print(c_array("uint32_t", f"golden_{name}_frame", [a[0] for a in answers], str))
    print(c_array("double", f"golden_{name}_confidence", [a[1] for a in answers], repr))
    print(c_array("double", f"golden_{name}_mass", [a[2] for a in answers], repr))
    print(c_array("double", f"golden_{name}_posterior", filter_.places(), repr))
    print(f"static const double golden_{name}_evidence = {filter_.evidence!r};\n")


def as_float(v):
    text = f"{float(v):.9g}"
    return text + ("f" if "." in text or "e" in text else ".0f")


def print_live(random):
    """A drive with a warmup of 3 frames, and in it a robot that stands for two frames."""
    dim, frames, lives = 19, 17, 9
    scale = 10.0 ** random.integers(-2, 3, dim)
    the_map = (scale * random.normal(size=(frames, dim)) + scale).astype(np.float32)
    live = (0.7 * the_map[3:3 + lives] + 0.2 * scale * random.normal(size=(lives, dim))).astype(np.float32)
    live[5], live[6] = live[4], live[4] * np.float32(1.0001)
    state = Live([[float(x) for x in frame] for frame in the_map], 3)
    step, moving, distances = state.step, [], []
    for t, x in enumerate(live):
        x = [float(y) for y in x]
        moved = state.add(x)
        if t >= 3:
            moving.append(int(moved))
            distances += state.distances(x)
    print(f"#define LIVE_DIM {dim}\n#define LIVE_MAP {frames}\n#define LIVE_FRAMES {lives}\n#define LIVE_WARMUP 3\n")
    print(c_array("float", "golden_live_map", the_map.ravel(), as_float))
    print(c_array("float", "golden_live", live.ravel(), as_float))
    print(f"static const double golden_live_step = {step!r};\n")
    print(c_array("uint32_t", "golden_live_moving", moving, str))
    print(c_array("double", "golden_live_distances", distances, repr))
    print(c_array("double", "golden_live_mean", state.mean, repr))


def main():
    random = np.random.default_rng(20261126)
    distances = rows(random)
    print("/* Made by make_localise.py; do not edit. */\n/* clang-format off */")
    print(f"#define FRAMES {FRAMES}\n#define STEPS {STEPS}\n#define TOLERANCE {TOLERANCE}\n")
    print(c_array("float", "golden_distances", np.ravel(distances), as_float))
    print(c_array("int64_t", "golden_places", loop(), lambda v: "INT64_MIN" if v == PLACE_NONE else str(v)))
    print_filter("plain", distances, Filter(FRAMES, TOLERANCE))
    print_filter("loop", distances, Filter(FRAMES, TOLERANCE, loop()))
    print_filter("others", distances, Filter(FRAMES, TOLERANCE, **OTHERS))
    print_filter("one", distances, Filter(1, TOLERANCE))
    print_filter("two", distances, Filter(2, 0))
    print_filter("six", distances, Filter(6, 0, **OTHERS))
    print_live(random)


if __name__ == "__main__":
    main()
