"""The Earth Mover's Distance between histograms, exact, and rankings by it."""

from __future__ import annotations

from ctypes import c_double
from typing import Iterable, List, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ._arrays import block
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


def rank(live: HistogramView, candidates: Sequence[HistogramView]) -> List[RankEntry]:
    """Rank candidates by their distance to a live Visual DNA: nearest first, ties in their order.

    candidates: at least one, of the shape and ranges of `live`
    VdnaError: as emd(); ARG if there is no candidate
    """
    view = view_of(live)
    views = (HistView * max(1, len(candidates)))(*[view_of(c) for c in candidates])
    places = (RankPlace * max(1, len(candidates)))()
    scratch = _scratch_for(view)
    lib.vdna_rank(view, views, len(candidates), scratch.ctypes.data, scratch.nbytes, places)
    return entries(places)
