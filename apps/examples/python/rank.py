"""rank: which of three drives looks most like now, and where in it are we? Same program as
../rank.c, with the same output.

pip install lib/python; python3 rank.py
"""

import numpy as np

import libvdna

NEURONS, SAMPLES, FRAMES, WARMUP = 8, 4, 50, 40
PERIOD_US = 100_000  # of the camera
# Synthetic drives: a seed and a shift; activations lie in shift..shift + 1.
CANDIDATES = {"spring": (1, 0.0), "summer": (2, 0.25), "winter": (3, 0.75)}
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


def experience(drive, table):
    """A drive for the selector. Here the embedding of a frame is just its first sample."""
    embeddings = np.array([values[0] for values in frames_of(drive)])
    return libvdna.Candidate(count(drive, table), embeddings)


def choose(table):
    """Warm up on the first frames, choose, and find the last frame in the chosen drive."""
    experiences = [experience(drive, table) for drive in CANDIDATES.values()]
    selector = libvdna.Selector(experiences, warmup_frames=WARMUP)
    for index, values in enumerate(frames_of(NOW)):
        answer = selector.feed(index * PERIOD_US, values[0], values)
    chosen = list(CANDIDATES)[selector.chosen]
    frames, margin = selector.window_frames, selector.margin_bins
    print(f"live: {chosen} after {frames} frames, by {margin:.17f} bins")
    print(f"now is nearest to frame {answer.match.frame} of {chosen}")


def main():
    # Ranges come from the map alone; the live drive never changes them.
    ranges = libvdna.Ranges(NEURONS)
    for drive in CANDIDATES.values():
        for values in frames_of(drive):
            ranges.observe(values)
    table = ranges.expand()

    ranking = libvdna.rank(count(NOW, table), [count(d, table) for d in CANDIDATES.values()])
    names = list(CANDIDATES)
    for place, entry in enumerate(ranking, 1):
        print(f"{place}. {names[entry.candidate]} is {entry.distance_bins:.17f} bins away")
    choose(table)


main()
