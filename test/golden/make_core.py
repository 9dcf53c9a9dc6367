#!/usr/bin/env python3
"""Write core_golden.h: histograms and distances by a second implementation, for test_core.c.

Binning is the definition in IEEE doubles, one sample at a time; distances are exact fractions.
Only NumPy's generator and float32 are used besides the standard library.

    test/golden/make_core.py > test/golden/core_golden.h      (NumPy 1.24, Python 3.11)
"""
import math
import textwrap
from fractions import Fraction

import numpy as np

NEURONS, BINS, FRAMES_P, FRAMES_Q = 6, 17, 40, 23


def bin_of(value, lo, hi, bins):
    mid, half = (lo + hi) / 2, (hi - lo) / 2
    x = min(1.0, max(-1.0, (value - mid) / half))
    return min(bins - 1, math.floor((x + 1) * bins / 2))


def histogram(activations, ranges):
    counts = [[0] * NEURONS for _ in range(BINS)]
    for frame in activations:
        for n, value in enumerate(frame):
            counts[bin_of(float(value), float(ranges[n][0]), float(ranges[n][1]), BINS)][n] += 1
    return counts


def emd(p, q):
    """The exact distance of one neuron with counts p and q, as a fraction."""
    mass_p, mass_q = sum(p), sum(q)
    below_p = below_q = total = 0
    for count_p, count_q in zip(p, q):
        below_p, below_q = below_p + count_p, below_q + count_q
        total += abs(below_p * mass_q - below_q * mass_p)
    return Fraction(total, mass_p * mass_q)


def c_array(kind, name, values, form):
    text = textwrap.fill(", ".join(form(v) for v in values), 96)
    return f"static const {kind} {name}[] = {{\n{text}}};\n"


def main():
    random = np.random.default_rng(20260401)
    scale = np.array([1, 10, 0.01, 300, 2, 1], np.float32)
    p = (random.normal(0, 1, (FRAMES_P, NEURONS)) * scale).astype(np.float32)
    q = (random.normal(0.4, 1.3, (FRAMES_Q, NEURONS)) * scale).astype(np.float32)
    q[:, 4] = np.abs(q[:, 4])
    p[:, 5] = q[:, 5] = 0.25
    ranges = np.stack([p.min(0), p.max(0)], 1)
    ranges[5] = (-0.75, 1.25)

    counts_p, counts_q = histogram(p, ranges), histogram(q, ranges)
    distances = [emd(p, q) for p, q in zip(zip(*counts_p), zip(*counts_q))]

    def as_float(v):
        text = f"{v:.9g}"
        return text + ("f" if "." in text or "e" in text else ".0f")

    print("/* Made by make_core.py; do not edit. */\n/* clang-format off */")
    print(f"#define NEURONS {NEURONS}\n#define BINS {BINS}")
    print(f"#define FRAMES_P {FRAMES_P}\n#define FRAMES_Q {FRAMES_Q}\n")
    print(c_array("float", "golden_range", ranges.ravel(), as_float))
    print(c_array("float", "golden_p", p.ravel(), as_float))
    print(c_array("float", "golden_q", q.ravel(), as_float))
    print(c_array("uint32_t", "golden_counts_p", [c for row in counts_p for c in row], str))
    print(c_array("uint32_t", "golden_counts_q", [c for row in counts_q for c in row], str))
    print(c_array("double", "golden_emd", [float(d).hex() for d in distances], str))


if __name__ == "__main__":
    main()
