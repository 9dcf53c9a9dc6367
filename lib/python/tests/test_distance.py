"""Distances, rankings and nearest neighbours."""

from fractions import Fraction

import numpy as np
import pytest
from conftest import histogram_of

from libvdna import Histogram, HistogramView, Status, VdnaError, bound_from_sums, bound_sums, emd, emd_bound
from libvdna import emd_block, emd_mean, nearest, rank, rank_top


def exact_emd(p, q):
    """Of one neuron, from its counts, without rounding."""
    total, difference = Fraction(0), Fraction(0)
    for a, b in zip(p.tolist(), q.tolist()):
        difference += Fraction(a, int(p.sum())) - Fraction(b, int(q.sum()))
        total += abs(difference)
    return total


def refused(status, call, *arguments):
    with pytest.raises(VdnaError) as caught:
        call(*arguments)
    assert caught.value.status is status


def test_the_distance_is_the_exact_one_rounded_once(random, unit_range):
    p, q = (HistogramView(unit_range, random.integers(0, 1000, (50, 3))) for _ in range(2))
    expected = [float(exact_emd(p.counts[:, n], q.counts[:, n])) for n in range(3)]
    assert emd(p, q).tolist() == expected
    assert emd_mean(p, q) == (expected[0] + expected[1] + expected[2]) / 3
    assert emd(p, q).dtype == np.float64


def test_many_pairs_have_the_distances_of_each(random, unit_range):
    p, q = (
        [HistogramView(unit_range, random.integers(0, 1000, (50, 3))) for _ in range(count)]
        for count in (4, 5)
    )
    distances = emd_block(p, q)
    assert distances.shape == (4, 5)
    assert distances.tolist() == [[emd_mean(a, b) for b in q] for a in p]
    refused(Status.ARG, emd_block, p, [])


def test_moving_every_sample_by_k_bins_gives_k(unit_range):
    counts = np.zeros((10, 3), np.uint32)
    counts[2] = 5
    p, q = HistogramView(unit_range, counts), HistogramView(unit_range, np.roll(counts, 4, axis=0))
    assert emd(p, q).tolist() == [4, 4, 4]


def test_a_ranking_is_sorted_and_marks_ties(unit_range):
    near, far = [[0.5, 0.5, 0.5]], [[-0.9, -0.9, -0.9]]
    live, a, b, c = (histogram_of([f], unit_range) for f in (near, far, near, near))
    places = rank(live, [a, b, c])
    assert [(p.candidate, p.tied) for p in places] == [(1, True), (2, True), (0, False)]
    assert [p.distance_bins for p in places] == [0, 0, emd_mean(live, a)]


def test_bounds_never_pass_the_distance_and_find_the_top_of_a_ranking(random, unit_range):
    live, *candidates = (
        HistogramView(unit_range, np.roll(random.integers(0, 9, (60, 3)) ** 3, shift, axis=0))
        for shift in (0, 30, 1, 20, 0, 10)
    )
    sums = [bound_sums(candidate) for candidate in candidates]
    assert sums[0].shape == (3, 3)
    cumulative = candidates[0].counts.cumsum(axis=0)
    assert sums[0][0].tolist() == cumulative[:25].sum(axis=0).tolist()
    assert sums[0][2].tolist() == cumulative[50:59].sum(axis=0).tolist()
    whole, (top, is_bound) = rank(live, candidates), rank_top(live, candidates, sums, 2)
    assert top[:2] == whole[:2]
    assert sorted(place.candidate for place in top) == [0, 1, 2, 3, 4]
    for distance, candidate, _ in top:
        bound = emd_bound(live, bound_sums(live), candidates[candidate], sums[candidate])
        exact = emd_mean(live, candidates[candidate])
        rows = bound_sums(live), live.mass, sums[candidate], candidates[candidate].mass
        assert bound == bound_from_sums(*rows, 60)
        assert 0 < bound <= exact
        assert distance == (bound if is_bound[candidate] else exact)
    assert rank_top(live, candidates, sums, 5) == (whole, [False] * 5)


def test_sums_of_another_shape_are_refused(unit_range):
    one = histogram_of([[0, 0, 0]], unit_range)
    other = histogram_of([[0, 0, 0]], unit_range, 60)
    refused(Status.ARG, rank_top, one, [], [], 1)
    for sums in ([], [bound_sums(one)[:, :2]], [bound_sums(other)]):
        with pytest.raises(ValueError, match="sums"):
            rank_top(one, [one], sums, 1)
    rows = bound_sums(one), one.mass
    for other_rows in ((bound_sums(other), other.mass), (bound_sums(one), one.mass[:2])):
        with pytest.raises(ValueError, match="are not those of two histograms with 10 bins"):
            bound_from_sums(*rows, *other_rows, 10)
    refused(Status.EMPTY, bound_from_sums, *rows, rows[0], rows[1] * 0, 10)
    with pytest.raises(ValueError, match="exact is 0"):
        rank_top(one, [one], [bound_sums(one)], 0)
    refused(Status.MISMATCH, rank_top, one, [other], [bound_sums(other)], 1)


def test_what_does_not_compare_is_refused(unit_range):
    one = histogram_of([[0, 0, 0]], unit_range)
    refused(Status.EMPTY, emd, one, Histogram(unit_range, 10))
    refused(Status.MISMATCH, emd_mean, one, histogram_of([[0, 0, 0]], unit_range, 11))
    refused(Status.MISMATCH, emd, one, histogram_of([[0, 0, 0]], unit_range * 2))
    refused(Status.MISMATCH, emd, one, histogram_of([[0, 0]], unit_range[:2]))
    refused(Status.ARG, rank, one, [])
    most = np.full((10, 3), 2**28, np.uint32)
    one_more = most.copy()
    one_more[0] += 1
    refused(Status.OVERFLOW, emd, *(HistogramView(unit_range, p) for p in (most, one_more)))
    for bad in (None, 1, np.ones((10, 3))):
        with pytest.raises(TypeError):
            emd(one, bad)
        with pytest.raises(TypeError):
            rank(one, [one, bad])


def test_neighbours_are_those_of_an_exhaustive_search(random):
    query = random.normal(size=20).astype(np.float32)
    rows = random.normal(size=(100, 20)).astype(np.float32)
    distances = ((rows.astype(np.float64) - query) ** 2).sum(axis=1)
    found = nearest(query, rows, 5)
    assert found.rows.tolist() == np.argsort(distances)[:5].tolist()
    np.testing.assert_allclose(found.distance_sq, np.sort(distances)[:5], rtol=1e-6)


def test_there_are_no_more_neighbours_than_rows():
    assert nearest([0, 0], [[3, 4]], 2**32 - 1).distance_sq.tolist() == [25]
    assert nearest([0], [[1], [-1], [0]], 3).rows.tolist() == [2, 0, 1]


def test_embeddings_that_do_not_fit_are_refused():
    refused(Status.NONFINITE, nearest, [0, np.nan], [[0, 0]])
    refused(Status.ARG, nearest, [0, 0], np.empty((0, 2)))
    refused(Status.ARG, nearest, [], np.empty((3, 0)))
    for query, rows, k in (([0], [[0, 0]], 1), ([[0]], [[0]], 1), ([0], [0], 1), ([0], [[0]], 0)):
        with pytest.raises(ValueError):
            nearest(query, rows, k)
