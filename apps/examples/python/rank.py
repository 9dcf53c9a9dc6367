"""rank [FILE.vdna...]: which of three drives looks most like now, and where in it are we? Same program as
../rank.c, with the same output.

pip install lib/python; python3 rank.py
"""

import sys

import numpy as np

import libvdna

NEURONS, SAMPLES, FRAMES, WARMUP = 8, 4, 50, 40
PERIOD_US = 100_000  # of the camera
# Synthetic drives: a seed and a shift; activations lie in shift..shift + 1.
DRIVES = {"spring": (1, 0.0), "summer": (2, 0.25), "winter": (3, 0.75)}
NOW = (4, 0.3125)


def frames_of(drive):
    """The activations of each frame, [samples][neurons]. Each number is the upper half of
    x = 1664525 x + 1013904223 (mod 2**32), divided by 2**16: exact in any language."""
    x, shift = drive
    for _ in range(FRAMES):
        values = np.empty((SAMPLES, NEURONS), np.float32)
        for i in range(values.size):
            x = (x * 1664525 + 1013904223) % 2**32
            values.flat[i] = (x >> 16) / 65536 + shift
        yield values


def count(drive, table):
    histogram = libvdna.Histogram(table)
    for values in frames_of(drive):
        histogram.add(values)
    return histogram


def make_up():
    """The drives by name. Ranges come from the map alone; the live drive never changes them. Here the
    embedding of a frame is just its first sample."""
    ranges = libvdna.Ranges(NEURONS)
    for drive in DRIVES.values():
        for values in frames_of(drive):
            ranges.observe(values)
    table = ranges.expand()
    return {
        name: libvdna.Candidate(
            count(drive, table), np.array([values[0] for values in frames_of(drive)])
        )
        for name, drive in DRIVES.items()
    }


def open_files(paths):
    experiences = [libvdna.Experience.open(path) for path in paths]
    return {e.name: libvdna.Candidate(e.histogram, e.embeddings) for e in experiences}


def choose(candidates):
    """Warm up on the first frames, choose, and find the last frame in the chosen drive."""
    selector = libvdna.Selector(list(candidates.values()), warmup_frames=WARMUP)
    for index, values in enumerate(frames_of(NOW)):
        answer = selector.feed(index * PERIOD_US, values[0], values)
    chosen = list(candidates)[selector.chosen]
    frames, margin = selector.window_frames, selector.margin_bins
    print(f"live: {chosen} after {frames} frames, by {margin:.17f} bins")
    print(f"now is nearest to frame {answer.match.frame} of {chosen}")


def main(paths):
    candidates = open_files(paths) if paths else make_up()
    names, histograms = list(candidates), [c.histogram for c in candidates.values()]
    ranking = libvdna.rank(count(NOW, histograms[0].range), histograms)
    for place, entry in enumerate(ranking, 1):
        print(f"{place}. {names[entry.candidate]} is {entry.distance_bins:.17f} bins away")
    choose(candidates)


main(sys.argv[1:])
