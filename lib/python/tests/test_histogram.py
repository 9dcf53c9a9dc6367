"""Histograms and ranges."""

import gc
import pickle
import threading
import tracemalloc
import weakref

import numpy as np
import pytest
from conftest import histogram_of, small_experience

import libvdna
from libvdna import FeatureMap, Histogram, HistogramView, Ranges, Status, VdnaError
from libvdna.activations import Taps


def bin_of(value, lo, hi, bins):
    """The definition of vdna/hist.h, in Python's doubles."""
    mid, half = (lo + hi) / 2, (hi - lo) / 2
    x = min(1.0, max(-1.0, (value - mid) / half))
    return min(bins - 1, int((x + 1) * bins / 2))


def test_each_sample_falls_into_the_bin_of_the_definition(random):
    range = np.array([[-1, 1], [0, 6], [-2.5, 2.5]], np.float32)
    tokens = random.normal(0, 2, (50, 3)).astype(np.float32)
    expected = np.zeros((7, 3), np.uint32)
    for token in tokens.tolist():
        for neuron, value in enumerate(token):
            lo, hi = range[neuron].tolist()
            expected[bin_of(value, lo, hi, 7), neuron] += 1

    histogram = histogram_of([tokens], range, 7)
    np.testing.assert_array_equal(histogram.counts, expected)
    np.testing.assert_array_equal(histogram.mass, [50, 50, 50])
    beyond = ((tokens < range[:, 0]) | (tokens > range[:, 1])).sum(axis=0)
    np.testing.assert_array_equal(histogram.saturated, beyond)
    assert (histogram.neurons, histogram.bins, histogram.frames) == (3, 7, 1)


def test_a_descriptor_is_one_sample(unit_range):
    histogram = histogram_of([np.zeros(3, np.float32)], unit_range)
    np.testing.assert_array_equal(histogram.mass, [1, 1, 1])


def test_a_feature_map_has_its_neurons_first(random, unit_range):
    channels = random.normal(size=(3, 4, 5)).astype(np.float32)
    by_map = histogram_of([FeatureMap(channels)], unit_range)
    by_tokens = histogram_of([channels.reshape(3, 20).T], unit_range)
    np.testing.assert_array_equal(by_map.counts, by_tokens.counts)
    np.testing.assert_array_equal(by_map.mass, [20, 20, 20])


def test_the_neurons_of_taps_follow_one_another(unit_range):
    histogram = Histogram(unit_range, 2)
    histogram.add(FeatureMap([[-0.5, -0.5, -0.5, -0.5]]), [[0.5, -0.5], [0.5, -0.5]])
    np.testing.assert_array_equal(histogram.counts, [[4, 0, 2], [0, 2, 0]])
    np.testing.assert_array_equal(histogram.mass, [4, 2, 2])


@pytest.mark.parametrize("dtype", ["f4", "f8", ">f4", "f2", "i2"])
def test_other_numbers_are_converted(dtype, unit_range):
    values = np.array([[-1, 0, 1], [1, 1, 1]], dtype)
    expected = histogram_of([values.astype(np.float32)], unit_range)
    np.testing.assert_array_equal(histogram_of([values], unit_range).counts, expected.counts)
    turned = np.asfortranarray(values)
    np.testing.assert_array_equal(histogram_of([turned], unit_range).counts, expected.counts)


def test_merge_is_adding_all_frames_and_subtract_undoes_it(random, unit_range):
    frames = random.normal(size=(6, 5, 3)).astype(np.float32)
    first, last = histogram_of(frames[:2], unit_range), histogram_of(frames[2:], unit_range)
    both = histogram_of(frames, unit_range)
    kept = first.counts.copy()
    first.merge(last)
    np.testing.assert_array_equal(first.counts, both.counts)
    np.testing.assert_array_equal(first.saturated, both.saturated)
    assert first.frames == 6
    first.subtract(last)
    np.testing.assert_array_equal(first.counts, kept)
    assert first.frames == 2
    first.reset()
    assert (first.frames, first.counts.sum(), first.mass.sum()) == (0, 0, 0)


def refused(status, call, *arguments):
    with pytest.raises(VdnaError) as caught:
        call(*arguments)
    assert caught.value.status is status


def test_a_refused_frame_changes_nothing(unit_range):
    histogram = histogram_of([np.zeros(3, np.float32)], unit_range)
    kept = histogram.counts.copy()
    refused(Status.NONFINITE, histogram.add, [0, np.nan, 0])
    refused(Status.MISMATCH, histogram.add, [0, 0])
    refused(Status.ARG, histogram.add)
    refused(Status.ARG, histogram.add, np.empty((0, 3), np.float32))
    refused(Status.UNDERFLOW, histogram.subtract, histogram_of([[1, 1, 1]], unit_range))
    refused(Status.MISMATCH, histogram.merge, Histogram(unit_range, 11))
    for bad in ("text", [1j, 0, 0], [None] * 3, [True] * 3):
        with pytest.raises(TypeError):
            histogram.add(bad)
    for bad in (1.5, np.zeros((2, 2, 3)), FeatureMap([0, 0, 0])):
        with pytest.raises(ValueError):
            histogram.add(bad)
    for bad in (None, "text", HistogramView(unit_range, np.ones((10, 3), int))):
        with pytest.raises(TypeError):
            histogram.merge(bad)
    np.testing.assert_array_equal(histogram.counts, kept)
    assert histogram.frames == 1


@pytest.mark.parametrize("range", [[], [1, 2], [[1, 2, 3]], np.empty((0, 2))])
def test_a_range_of_another_shape_is_refused(range):
    with pytest.raises(ValueError):
        Histogram(range)


@pytest.mark.parametrize("range", [[[1, 1]], [[0, np.inf]], [[np.nan, 1]]])
def test_a_range_that_is_none_is_refused(range):
    refused(Status.ARG, Histogram, range)


@pytest.mark.parametrize("bins", [-1, 0, 1, 65537, 2**32 + 10])
def test_a_number_of_bins_that_c_would_misread_is_refused(bins, unit_range):
    with pytest.raises(ValueError, match="expected 2 to 65536"):
        Histogram(unit_range, bins)
    with pytest.raises(TypeError):
        Histogram(unit_range, 10.0)


@pytest.mark.parametrize("counts", [[[-1], [1]], [[2**32], [0]], [[2**32 - 1], [1]]])
def test_counts_that_c_would_misread_are_refused(counts):
    with pytest.raises(ValueError):
        HistogramView([[0, 1]], counts)


@pytest.mark.parametrize("counts", [[1, 2], [[1, 2]], [[1]], np.empty((0, 1), int)])
def test_counts_of_another_shape_are_refused(counts):
    with pytest.raises(ValueError):
        HistogramView([[0, 1]], counts)


def test_activations_are_read_where_they_are(unit_range):
    tokens = np.zeros((5, 3), np.float32)
    assert Taps([tokens]).array[0].values == tokens.ctypes.data
    assert Taps([FeatureMap(tokens)]).array[0].values == tokens.ctypes.data

    large = np.zeros((4_000_000, 3), np.float32)
    histogram = Histogram(unit_range)
    tracemalloc.start()
    histogram.add(large)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < large.nbytes / 100


def test_what_comes_out_is_the_memory_of_the_library(unit_range):
    histogram = Histogram(unit_range)
    counts, mass = histogram.counts, histogram.mass
    assert counts.ctypes.data == histogram._hist.counts
    assert mass.ctypes.data == histogram._hist.mass
    assert histogram.saturated.ctypes.data == histogram._hist.saturated
    histogram.add([0, 0, 0])
    assert (counts.sum(), mass.sum()) == (3, 3)


def test_counts_of_ones_own_are_not_copied(unit_range):
    counts = np.ones((4, 3), np.uint32)
    assert np.shares_memory(HistogramView(unit_range, counts).counts, counts)


def test_views_cannot_be_written(unit_range):
    histogram = Histogram(unit_range)
    for view in (histogram.counts, histogram.mass, histogram.saturated, histogram.range):
        with pytest.raises(ValueError):
            view[0] = 1
        with pytest.raises(ValueError):
            view.flags.writeable = True


def test_the_range_is_a_copy(unit_range):
    histogram = Histogram(unit_range)
    unit_range[:] = 0
    np.testing.assert_array_equal(histogram.range, [[-1, 1]] * 3)


def test_a_view_keeps_its_memory_alive(unit_range):
    histogram = Histogram(unit_range)
    histogram.add([1, 1, 1])
    _, memory = histogram.counts.base.owner
    block = weakref.ref(memory)
    top = histogram.counts[-1]
    del histogram, memory
    gc.collect()
    assert block() is not None and top.tolist() == [1, 1, 1]
    del top
    gc.collect()
    assert block() is None


def test_different_histograms_count_in_different_threads(random, unit_range):
    frames = random.normal(size=(50, 200, 3)).astype(np.float32)
    histograms = [Histogram(unit_range) for _ in range(4)]

    def count(histogram):
        for frame in frames:
            histogram.add(frame)

    threads = [threading.Thread(target=count, args=[h]) for h in histograms]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = histogram_of(frames, unit_range, 1000).counts
    for histogram in histograms:
        np.testing.assert_array_equal(histogram.counts, expected)


def test_ranges_widen_what_they_saw():
    ranges = Ranges(2)
    ranges.observe([[1, -1], [3, 0]])
    ranges.observe(FeatureMap([[2], [1]]))
    np.testing.assert_array_equal(ranges.expand(1), [[1, 3], [-1, 1]])
    np.testing.assert_array_equal(ranges.expand(2), [[0, 4], [-2, 2]])
    np.testing.assert_array_equal(ranges.expand(2, "about_zero"), [[2, 6], [-2, 2]])
    np.testing.assert_allclose(ranges.expand(), [[0.8, 3.2], [-1.2, 1.2]], rtol=1e-6)
    assert ranges.expand().dtype == np.float32


def test_ranges_refuse_what_they_cannot_use():
    ranges = Ranges(2)
    refused(Status.EMPTY, ranges.expand)
    refused(Status.NONFINITE, ranges.observe, [np.inf, 0])
    refused(Status.MISMATCH, ranges.observe, [0, 0, 0])
    ranges.observe([0, 0])
    refused(Status.ARG, ranges.expand, 0.5)
    with pytest.raises(ValueError, match="about_midpoint"):
        ranges.expand(rule="about")
    for neurons in (0, -1, 2**32):
        with pytest.raises(ValueError):
            Ranges(neurons)


def test_the_package_says_what_it_offers():
    for name in libvdna.__all__:
        assert getattr(libvdna, name).__doc__, name


def test_a_mask_is_not_dropped_without_a_word():
    masked = np.ma.masked_array(np.zeros((2, 3), np.float32), mask=[[0, 0, 0], [1, 1, 1]])
    histogram = histogram_of([np.zeros((1, 3))], np.array([[-1, 1]] * 3, np.float32), 7)
    for activations in (masked, [masked[0], masked[1]]):
        with pytest.raises(TypeError, match="masked array.*filled"):
            histogram.add(activations)
    with pytest.raises(TypeError, match="masked array.*filled"):
        Ranges(3).observe(masked)
    assert histogram.frames == 1


def test_a_pickled_histogram_goes_on_counting(unit_range, random):
    frames = random.normal(0, 1, (9, 3)).astype(np.float32)
    histogram = histogram_of(frames[:5], unit_range)
    again = pickle.loads(pickle.dumps(histogram))
    for frame in frames[5:]:
        again.add(frame)
    whole = histogram_of(frames, unit_range)
    assert again.frames == 9 and whole.saturated.sum() > 0
    for field in ("range", "counts", "mass", "saturated"):
        assert np.array_equal(getattr(again, field), getattr(whole, field))
    again.subtract(histogram)
    assert np.array_equal(again.counts, histogram_of(frames[5:], unit_range).counts)


def test_a_pickled_view_has_its_own_counts(unit_range, random):
    view = small_experience().histogram
    again = pickle.loads(pickle.dumps(view))
    assert type(again) is libvdna.HistogramView
    assert np.array_equal(again.counts, view.counts) and np.array_equal(again.range, view.range)


def test_merging_a_view_is_counting_its_frames(unit_range, random):
    frames = random.normal(0, 0.2, (9, 3)).astype(np.float32)
    part = histogram_of(frames[:4], unit_range)
    view = libvdna.HistogramView(part.range, part.counts)
    histogram = histogram_of(frames[4:], unit_range)
    histogram.merge(view, frames=4)
    whole = histogram_of(frames, unit_range)
    assert np.array_equal(histogram.counts, whole.counts) and histogram.frames == 9
    with pytest.raises(TypeError, match="frames is missing"):
        histogram.merge(view)
    with pytest.raises(TypeError, match="a Histogram knows its own"):
        histogram.merge(part, frames=4)
    with pytest.raises(libvdna.VdnaError):
        histogram.merge(small_experience().histogram, frames=2)
    assert histogram.frames == 9


def test_merged_ranges_are_those_of_one_run(random):
    frames = random.normal(0, [1, 2, 3], (20, 3)).astype(np.float32)

    def observed(part):
        ranges = libvdna.Ranges(3)
        for frame in part:
            ranges.observe(frame)
        return ranges

    merged = observed(frames[:8])
    merged.merge(pickle.loads(pickle.dumps(observed(frames[8:]))))
    assert np.array_equal(merged.observed, observed(frames).observed)
    assert np.array_equal(merged.expand(), observed(frames).expand())
    assert np.array_equal(libvdna.Ranges.observed_as(merged.observed).expand(), merged.expand())
    merged.merge(libvdna.Ranges(3))
    assert np.array_equal(merged.observed, observed(frames).observed)
    with pytest.raises(ValueError, match="ranges of 2 neurons, expected 3"):
        merged.merge(libvdna.Ranges(2))
    for bad in ([[1, 0]], [[0, np.inf]], [[np.nan, 1]]):
        with pytest.raises(ValueError, match="a least above its greatest"):
            libvdna.Ranges.observed_as(bad)
