#!/usr/bin/env python3
"""Write seqslam_golden.h: SeqSLAM in NumPy, for test_seqslam.cpp.

A drive through places of a map at changing speeds, from its definition in docs/internals/DESIGN.md.
Every stride-th frame after the warmup is asked for.

    test/golden/make_seqslam.py > test/golden/seqslam_golden.h      (NumPy 2.4.6)
"""
import textwrap

import numpy as np

DIM, MAP_FRAMES, LIVE_FRAMES, BEGIN, FIRST, STRIDE = 4, 40, 36, 2, 6, 3
NEIGHBOURS, FRAMES, VELOCITIES = 5, 10, (0.8, 0.9, 1.0, 1.1, 1.2)


def contrast(rows):
    """[live][map]: each entry against those of its row up to NEIGHBOURS away."""
    padded = np.pad(rows, ((0, 0), (NEIGHBOURS, NEIGHBOURS)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1, axis=1)
    return (rows - np.nanmean(windows, axis=2)) / np.nanstd(windows, axis=2)


def answers(live, frames, asked):
    rows = contrast(np.linalg.norm(live[:, None] - frames[None], axis=2))
    found = []
    for t in asked:
        back = np.arange(min(FRAMES, t - BEGIN + 1))
        ends = np.arange(len(frames))[:, None]
        lines = [rows[t - back, np.maximum(ends - np.floor(v * back + 0.5 + 1e-9).astype(int), 0)]
                 for v in VELOCITIES]
        found.append(np.min([line.sum(axis=1) for line in lines], axis=0).argmin())
    return rows, found


def c_array(kind, name, values, form):
    text = textwrap.fill(", ".join(form(v) for v in np.ravel(values)), 96)
    return f"static const {kind} {name}[] = {{\n{text}}};\n"


def main():
    random = np.random.default_rng(20120514)
    frames = random.normal(0, 1, (MAP_FRAMES, DIM)).astype(np.float32)
    places = np.concatenate([np.arange(18), np.arange(18, 36, 1.2)[:10], np.arange(30, 37.9)])
    places = np.minimum(np.round(places[:LIVE_FRAMES]).astype(int), MAP_FRAMES - 1)
    live = (frames[places] + random.normal(0, 0.8, (LIVE_FRAMES, DIM))).astype(np.float32)
    asked = range(FIRST, LIVE_FRAMES, STRIDE)
    rows, found = answers(live.astype(np.float64), frames.astype(np.float64), asked)

    print("/* Made by make_seqslam.py; do not edit. */\n/* clang-format off */")
    print(f"#define DIM {DIM}\n#define MAP_FRAMES {MAP_FRAMES}\n#define LIVE_FRAMES {LIVE_FRAMES}\n"
          f"#define BEGIN {BEGIN}\n")
    print(c_array("float", "golden_map", frames, lambda v: f"{v:.9g}f"))
    print(c_array("float", "golden_live", live, lambda v: f"{v:.9g}f"))
    print(c_array("uint32_t", "golden_asked", list(asked), str))
    print(c_array("uint32_t", "golden_answers", found, str))
    print(c_array("double", "golden_contrast", rows[BEGIN], lambda v: float(v).hex()), end="")


if __name__ == "__main__":
    main()
