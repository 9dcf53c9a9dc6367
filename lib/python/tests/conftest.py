"""Things that several tests start from."""

import numpy as np
import pytest

import libvdna

SHA256 = "0123456789abcdef" * 4


@pytest.fixture
def random():
    return np.random.default_rng(7)


@pytest.fixture
def unit_range():
    """Three neurons over -1..1."""
    return np.array([[-1, 1]] * 3, np.float32)


def histogram_of(frames, range, bins=10):
    histogram = libvdna.Histogram(range, bins)
    for frame in frames:
        histogram.add(frame)
    return histogram


def small_experience(name="winter", **changes):
    """Two frames of three neurons in four bins, as in test/support/map_files.h."""
    counts = np.array([[1, 8, 0], [2, 0, 0], [3, 0, 1], [2, 0, 1]], np.uint32)
    range = np.array([[-1, 1], [0, 6], [-2.5, 2.5]], np.float32)
    fields = {
        "name": name,
        "backbone": "tiny-net_1.0",
        "model_sha256": SHA256,
        "preprocessing": 'rgb 8x8 "area" mean=0 std=1 \\',
        "taps": "mid:2:4,top:1:1",
        "histogram": libvdna.HistogramView(range, counts),
        "embeddings": np.array([[1, 0, 0, 0, 0], [0, 0.5, -0.5, 0.5, -0.5]], np.float32),
        "frame_utime": np.array([1000000, 1033333], np.int64),
        "frame_grey": np.array([0, 127.5], np.float32),
        "frame_place": np.array([17, 18], np.int64),
        "frame_position": np.array([[0, 0, 0], [1.5, -2, 0.25]], np.float64),
    }
    return libvdna.Experience(**{**fields, **changes})
