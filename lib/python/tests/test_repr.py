"""What objects say of themselves at a prompt."""

import numpy as np
import pytest
from conftest import histogram_of, small_experience

import libvdna


def made():
    table = np.array([[-1, 1]] * 3, np.float32)
    histogram = histogram_of([np.zeros((2, 3), np.float32)], table)
    embeddings = np.eye(4, 2, dtype=np.float32)
    selector = libvdna.Selector([libvdna.Candidate(histogram, embeddings)] * 2, warmup_frames=2)
    yield libvdna.Ranges(3), "<Ranges of 3 neurons>"
    yield histogram, "<Histogram of 3 neurons in 10 bins, 1 frames>"
    experience = small_experience()
    yield experience.histogram, "<HistogramView of 3 neurons in 4 bins>"
    yield experience, "<Experience winter: 2 frames, 3 neurons in 4 bins, by tiny-net_1.0>"
    yield (
        experience.identity,
        "<Identity of tiny-net_1.0 (fp32): 3 neurons, 4 bins, embeddings of 5>",
    )
    bare = libvdna.Identity(
        backbone="net", model_sha256="0" * 64, preprocessing="none", taps="mid:2:4"
    )
    yield bare, "<Identity of net (fp32): 2 neurons>"
    yield (
        libvdna.Localiser(embeddings, tolerance=2),
        "<Localiser in 4 frames, embeddings of 2>",
    )
    yield libvdna.StoredRun(embeddings), "<StoredRun of 4 frames, embeddings of 2>"
    yield libvdna.Trust(None, runs=3), "<Trust among 3 candidates>"
    selector.feed(1, embeddings[0], np.zeros(3, np.float32))
    yield selector, "<Selector among 2 candidates, 50% of the warmup>"


@pytest.mark.parametrize("thing, text", list(made()), ids=lambda value: str(value))
def test_it_says_what_it_is_and_how_large(thing, text):
    assert repr(thing) == text


def test_a_selector_says_what_it_chose():
    table = np.array([[-1, 1]] * 3, np.float32)
    histogram = histogram_of([np.zeros((2, 3), np.float32)], table)
    candidates = [libvdna.Candidate(histogram, np.eye(4, 2, dtype=np.float32))]
    selector = libvdna.Selector(candidates, warmup_frames=1)
    selector.feed(1, np.zeros(2, np.float32), np.zeros(3, np.float32))
    assert repr(selector) == "<Selector among 1 candidates, chosen 0>"


def test_every_class_of_the_package_says_more_than_its_address():
    for name in libvdna.__all__:
        thing = getattr(libvdna, name)
        if isinstance(thing, type):
            assert thing.__repr__ is not object.__repr__, name
