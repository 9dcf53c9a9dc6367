"""The Earth Mover's Distance between histograms, exact, and rankings by it."""

from __future__ import annotations

from ctypes import Array, c_double, c_uint8
from typing import Iterable, List, NamedTuple, Sequence, SupportsIndex, Tuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import UINT32_MAX, block, integer
from ._library import HistView, RankPlace, lib
from .histogram import HistogramView, view_of


class RankEntry(NamedTuple):
    """One place of a ranking."""

    distance_bins: float
    """D(live, candidate): the mean over the neurons, in bins."""
    candidate: int
    """Index into the candidates."""
    tied: bool
    """Whether a neighbour in the ranking has the very same distance."""


def entries(places: Iterable[RankPlace]) -> List[RankEntry]:
    return [RankEntry(p.distance_bins, p.candidate, p.tied != 0) for p in places]


def _scratch_for(view: HistView) -> NDArray[np.int64]:
    return block(lib.vdna_emd_scratch_size(view.neurons))


def _views(histograms: Sequence[HistogramView]) -> Array[HistView]:
    """Never empty: C wants an address."""
    return (HistView * max(1, len(histograms)))(*[view_of(h) for h in histograms])


def emd(p: HistogramView, q: HistogramView) -> NDArray[np.float64]:
    """Distance of each neuron: the sum over the bins of |P[b] - Q[b]|, cumulative shares.

    returns: float64 [neurons], 0 to bins - 1; moving every sample by k bins gives k
    VdnaError: MISMATCH if shapes or ranges differ, EMPTY if a neuron has no samples, OVERFLOW if
               lcm(mass_p, mass_q) * (bins - 1) passes 2**63 - 1
    """
    view = view_of(p)
    scratch = _scratch_for(view)
    distances = np.empty(view.neurons, np.float64)
    lib.vdna_emd(view, view_of(q), scratch.ctypes.data, scratch.nbytes, distances.ctypes.data)
    return distances


def emd_mean(p: HistogramView, q: HistogramView) -> float:
    """Distance D(p, q) of two Visual DNAs: the mean over their neurons, in bins.

    VdnaError: as emd()
    """
    view = view_of(p)
    scratch = _scratch_for(view)
    distance = c_double()
    lib.vdna_emd_mean(view, view_of(q), scratch.ctypes.data, scratch.nbytes, distance)
    return distance.value


def emd_block(
    p: Sequence[HistogramView], q: Sequence[HistogramView]
) -> NDArray[np.float64]:
    """Distances of many pairs: D of each of `p` to each of `q`, with the bits of emd_mean(), faster.

    p, q: at least one each, all of one shape and the same ranges
    returns: float64 [len(p)][len(q)], in bins
    VdnaError: as emd(); ARG if a side is empty
    """
    views_p, views_q = _views(p), _views(q)
    scratch = block(lib.vdna_emd_block_scratch_size(views_p[0].neurons))
    distances = np.empty((len(p), len(q)), np.float64)
    lib.vdna_emd_block(
        views_p,
        len(p),
        views_q,
        len(q),
        scratch.ctypes.data,
        scratch.nbytes,
        distances.ctypes.data,
    )
    return distances


def rank(live: HistogramView, candidates: Sequence[HistogramView]) -> List[RankEntry]:
    """Rank candidates by their distance to a live Visual DNA: nearest first, ties in their order.

    candidates: at least one, of the shape and ranges of `live`
    VdnaError: as emd(); ARG if there is no candidate
    """
    view = view_of(live)
    views = _views(candidates)
    places = (RankPlace * max(1, len(candidates)))()
    scratch = _scratch_for(view)
    lib.vdna_rank(view, views, len(candidates), scratch.ctypes.data, scratch.nbytes, places)
    return entries(places)


def bound_sums(histogram: HistogramView) -> NDArray[np.uint32]:
    """Sums of the cumulative counts over blocks of 25 bins, from which bounds of distances follow.

    returns: uint32 [blocks][neurons]
    VdnaError: EMPTY if a neuron has no samples, OVERFLOW if one has more than 171 million
    """
    view = view_of(histogram)
    scratch = _scratch_for(view)
    size = lib.vdna_bounds_size(view.neurons, view.bins)
    sums = np.empty((size // (4 * view.neurons), view.neurons), np.uint32)
    lib.vdna_bounds_sum(view, scratch.ctypes.data, scratch.nbytes, sums.ctypes.data)
    return sums


def _sums_of(histogram: HistogramView, sums: NDArray[np.uint32]) -> NDArray[np.uint32]:
    view = view_of(histogram)
    array = np.ascontiguousarray(sums, np.uint32)
    if array.nbytes != lib.vdna_bounds_size(view.neurons, view.bins):
        raise ValueError(
            f"sums of shape {np.shape(sums)} are not those of {view.neurons} neurons "
            f"with {view.bins} bins: take bound_sums() of the histogram"
        )
    return array


def emd_bound(
    p: HistogramView, sums_p: NDArray[np.uint32], q: HistogramView, sums_q: NDArray[np.uint32]
) -> float:
    """Lower bound of emd_mean(p, q), made of their bound_sums() in about 1/25 of its time.

    VdnaError: as emd()
    """
    view = view_of(p)
    scratch = _scratch_for(view)
    arrays = _sums_of(p, sums_p), _sums_of(q, sums_q)
    bound = c_double()
    lib.vdna_bounds_mean(
        view,
        arrays[0].ctypes.data,
        view_of(q),
        arrays[1].ctypes.data,
        scratch.ctypes.data,
        scratch.nbytes,
        bound,
    )
    return bound.value


def bound_from_sums(
    sums_p: NDArray[np.uint32],
    mass_p: NDArray[np.uint32],
    sums_q: NDArray[np.uint32],
    mass_q: NDArray[np.uint32],
    bins: SupportsIndex,
) -> float:
    """The same as emd_bound(), of histograms of which only the bound_sums() and masses are at hand.

    sums_p, sums_q: uint32 [blocks][neurons]
    mass_p, mass_q: uint32 [neurons]
    bins: of the histograms
    VdnaError: EMPTY, OVERFLOW as emd()
    """
    bin_count = integer(bins, "bins", 0, UINT32_MAX)
    rows = [np.ascontiguousarray(row, np.uint32) for row in (sums_p, mass_p, sums_q, mass_q)]
    neurons = rows[1].size
    size = lib.vdna_bounds_size(neurons, bin_count)
    if rows[3].size != neurons or rows[0].nbytes != size or rows[2].nbytes != size:
        shapes = ", ".join(str(row.shape) for row in rows)
        raise ValueError(
            f"sums and masses of shapes {shapes} are not those of two histograms with {bin_count}"
            " bins: take bound_sums() and mass of both"
        )
    scratch = block(lib.vdna_emd_scratch_size(neurons))
    bound = c_double()
    lib.vdna_bounds_from_sums(
        *(row.ctypes.data for row in rows),
        neurons,
        bin_count,
        scratch.ctypes.data,
        scratch.nbytes,
        bound,
    )
    return bound.value


def rank_top(
    live: HistogramView,
    candidates: Sequence[HistogramView],
    sums: Sequence[NDArray[np.uint32]],
    exact: SupportsIndex,
) -> Tuple[List[RankEntry], List[bool]]:
    """Rank candidates, the nearest by their distance and the rest by a lower bound of it.

    sums: bound_sums() of each candidate
    exact: places to have as rank() has them, at least 1
    returns: the ranking, and by candidate whether its `distance_bins` is a bound
    VdnaError: as rank(); OVERFLOW also as bound_sums()
    """
    if len(sums) != len(candidates):
        raise ValueError(f"{len(sums)} sums for {len(candidates)} candidates: give one for each")
    view = view_of(live)
    count = len(candidates)
    views = _views(candidates)
    places, is_bound = (RankPlace * max(1, count))(), (c_uint8 * max(1, count))()
    each = [_sums_of(c, s).ravel() for c, s in zip(candidates, sums)]
    table = np.concatenate([np.empty(0, np.uint32), *each])
    scratch = block(lib.vdna_rank_top_scratch_size(view.neurons, view.bins))
    lib.vdna_rank_top(
        view,
        views,
        table.ctypes.data,
        count,
        integer(exact, "exact", 1, UINT32_MAX),
        scratch.ctypes.data,
        scratch.nbytes,
        places,
        is_bound,
    )
    return entries(places), [bound != 0 for bound in is_bound]
