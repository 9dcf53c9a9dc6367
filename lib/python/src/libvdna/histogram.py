"""Histograms: the "Visual DNA" of a set of pictures."""

from __future__ import annotations

from ctypes import memmove
from typing import Any, Callable, Optional, SupportsIndex, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, block, floats, integer, integers, shaped, view
from ._library import Hist, HistConfig, HistView, lib
from .activations import Tap, Taps

_BINS_MIN, _BINS_MAX = 2, 65536


def _range_table(values: ArrayLike) -> NDArray[np.float32]:
    """A copy of our own: the library must find in it what it checked."""
    table = shaped(floats(values, "range"), ("neurons", 2), "range").copy()
    neurons = integer(len(table), "the number of neurons", 1, UINT32_MAX)
    lib.vdna_range_check(table.ctypes.data, neurons)
    table.flags.writeable = False
    return table


class HistogramView:
    """A histogram to read and to compare: per neuron, how often it was active how much."""

    _range: NDArray[np.float32]
    _counts: NDArray[np.uint32]
    _mass: NDArray[np.uint32]
    _view: HistView

    def __init__(self, range: ArrayLike, counts: ArrayLike) -> None:
        """Counts of your own making; do not change them while the view is in use.

        range: float32 [neurons][2], finite, lo < hi
        counts: uint32 [bins][neurons], 2 to 65536 bins, not copied
        VdnaError: ARG for a bad range
        """
        self._range = _range_table(range)
        self._counts = integers(counts, "counts", np.uint32)
        shaped(self._counts, ("bins", len(self._range)), "counts")
        integer(len(self._counts), "the number of bins", _BINS_MIN, _BINS_MAX)
        mass = self._counts.sum(axis=0, dtype=np.uint64)
        self._mass = integers(mass, "the sums of the counts", np.uint32)
        self._view = HistView(
            range=self._range.ctypes.data,
            counts=self._counts.ctypes.data,
            mass=self._mass.ctypes.data,
            neurons=self.neurons,
            bins=self.bins,
        )

    @classmethod
    def _over(cls, owner: object, pointers: HistView) -> HistogramView:
        """A view of what the library holds; `owner` is kept alive."""
        self = HistogramView.__new__(HistogramView)
        self._point(owner, pointers)
        return self

    def _point(self, owner: object, pointers: HistView) -> None:
        neurons, bins = pointers.neurons, pointers.bins
        self._range = view(owner, pointers.range, (neurons, 2), np.float32)
        self._counts = view(owner, pointers.counts, (bins, neurons), np.uint32)
        self._mass = view(owner, pointers.mass, (neurons,), np.uint32)
        self._view = pointers

    def __reduce__(self) -> Tuple[Callable[..., HistogramView], Tuple[Any, ...]]:
        return HistogramView, (np.array(self._range), np.array(self._counts))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.neurons} neurons in {self.bins} bins>"

    @property
    def neurons(self) -> int:
        """Number of neurons, of all taps together."""
        return len(self._range)

    @property
    def bins(self) -> int:
        """Number of bins of each neuron."""
        return len(self._counts)

    @property
    def range(self) -> NDArray[np.float32]:
        """[neurons][2]: the outer edges of each neuron's bins, in activation units."""
        return self._range

    @property
    def counts(self) -> NDArray[np.uint32]:
        """[bins][neurons]: samples in each bin."""
        return self._counts

    @property
    def mass(self) -> NDArray[np.uint32]:
        """[neurons]: samples of each neuron, the sum of its counts."""
        return self._mass


class Histogram(HistogramView):
    """A histogram that counts frames. Its size does not depend on how many, nor its counts on
    their order."""

    def __init__(self, range: ArrayLike, bins: SupportsIndex = 1000) -> None:
        """
        range: float32 [neurons][2], finite, lo < hi: what Ranges.expand() returns; copied
        bins: 2 to 65536
        VdnaError: ARG for a bad range
        """
        table = _range_table(range)
        config = HistConfig()
        lib.vdna_hist_config_init(config)
        config.neurons = len(table)
        config.bins = integer(bins, "bins", _BINS_MIN, _BINS_MAX)
        config.range = table.ctypes.data
        memory = block(lib.vdna_hist_mem_size(config))
        self._hist = Hist()
        lib.vdna_hist_init(config, memory.ctypes.data, memory.nbytes, self._hist)

        owner: Any = (table, memory)
        pointers = HistView()
        lib.vdna_hist_view_of(self._hist, pointers)
        self._point(owner, pointers)
        self._saturated = view(owner, self._hist.saturated, (self.neurons,), np.uint32)

    def __reduce__(self) -> Tuple[Callable[..., HistogramView], Tuple[Any, ...]]:
        counted = (np.array(self._counts), np.array(self._mass), np.array(self._saturated))
        return _restored, (np.array(self._range), *counted, self.frames)

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, {self.frames} frames>"

    @property
    def frames(self) -> int:
        """Frames added, less frames subtracted."""
        return int(self._hist.frames)

    @property
    def saturated(self) -> NDArray[np.uint32]:
        """[neurons]: samples beyond the range; they are counted in an edge bin."""
        return self._saturated

    def add(self, *taps: Tap) -> None:
        """Count one frame.

        taps: float32, their neurons one tap after the other: [neurons], [samples][neurons] or
              FeatureMap([neurons][...]); read without a copy if C-contiguous
        VdnaError: MISMATCH if the neurons do not add up, NONFINITE for a NaN or an infinity, FULL
                   if a count would pass 2**32 - 1
        """
        frame = Taps(taps)
        lib.vdna_hist_add(self._hist, frame.array, frame.count)

    def merge(self, other: HistogramView, frames: Optional[SupportsIndex] = None) -> None:
        """Add all that `other` counted: exactly as if its frames had been added here.

        other: a Histogram; or a view, such as that of an experience, which does not know what was
               beyond the range, so that `saturated` stays as it is
        frames: of a view, and only of one: what it was counted from
        VdnaError: MISMATCH if shapes or ranges differ, FULL
        """
        if isinstance(other, Histogram):
            if frames is not None:
                raise TypeError("frames is for a HistogramView; a Histogram knows its own")
            lib.vdna_hist_merge(self._hist, other._hist)
            return
        if frames is None:
            raise TypeError("frames is missing: how many `other` was counted from")
        count = integer(frames, "frames", 0, UINT32_MAX)
        unknown = np.zeros(view_of(other).neurons, np.uint32)
        counted = _restored(other.range, other.counts, other.mass, unknown, count)
        lib.vdna_hist_merge(self._hist, counted._hist)

    def subtract(self, other: Histogram) -> None:
        """Take out again, exactly, what `other` counted.

        VdnaError: MISMATCH if shapes or ranges differ, UNDERFLOW if `other` holds anything that
                   this does not
        """
        lib.vdna_hist_subtract(self._hist, _hist_of(other))

    def reset(self) -> None:
        """Forget all frames; shape and range stay."""
        lib.vdna_hist_reset(self._hist)


def _restored(
    range: NDArray[np.float32],
    counts: NDArray[np.uint32],
    mass: NDArray[np.uint32],
    saturated: NDArray[np.uint32],
    frames: int,
) -> Histogram:
    """A pickled histogram."""
    histogram = Histogram(range, len(counts))
    hist = histogram._hist
    for address, values in ((hist.counts, counts), (hist.mass, mass), (hist.saturated, saturated)):
        memmove(address, values.ctypes.data, values.nbytes)
    hist.frames = frames
    return histogram


def _hist_of(histogram: Histogram) -> Hist:
    if not isinstance(histogram, Histogram):
        raise TypeError(f"expected a Histogram, got {type(histogram).__name__}")
    return histogram._hist


def view_of(histogram: HistogramView) -> HistView:
    """What the library reads; the histogram must stay as long as it does."""
    if not isinstance(histogram, HistogramView):
        raise TypeError(f"expected a Histogram or HistogramView, got {type(histogram).__name__}")
    return histogram._view
