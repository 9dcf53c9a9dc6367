"""Ranges: where each neuron's histogram begins and ends."""

from __future__ import annotations

from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, floats, integer, shaped
from ._library import lib
from .activations import Tap, Taps

_RULES = {"about_midpoint": 0, "about_zero": 1}


class Ranges:
    """The least and the greatest activation of each neuron over all frames observed.

    Calibrate once on the pictures of a map, then give the same table to every histogram:

        ranges = Ranges(768)
        for tokens in frames:
            ranges.observe(tokens)
        histogram = Histogram(ranges.expand())
    """

    def __init__(self, neurons: SupportsIndex) -> None:
        """
        neurons: of all taps together, >= 1
        """
        self._neurons = integer(neurons, "neurons", 1, UINT32_MAX)
        self._table = np.empty((self._neurons, 2), np.float32)
        lib.vdna_range_clear(self._table.ctypes.data, self._neurons)

    @classmethod
    def observed_as(cls, observed: ArrayLike) -> Ranges:
        """Ranges that observed this, as `observed` of others has it.

        observed: float32 [neurons][2], least and greatest of each neuron; copied
        ValueError: a least is above its greatest, or one is not finite
        """
        table = shaped(floats(observed, "observed"), ("neurons", 2), "observed")
        if not (np.isfinite(table).all() and (table[:, 0] <= table[:, 1]).all()):
            raise ValueError("observed has a least above its greatest, or one that is not finite")
        self = cls(len(table))
        self._table[:] = table
        return self

    def __repr__(self) -> str:
        return f"<Ranges of {self._neurons} neurons>"

    def observe(self, *taps: Tap) -> None:
        """Widen the ranges to contain one frame.

        taps: float32, their neurons one tap after the other: [neurons], [samples][neurons] or
              FeatureMap([neurons][...])
        VdnaError: MISMATCH if the neurons do not add up, NONFINITE for a NaN or an infinity
        """
        frame = Taps(taps)
        lib.vdna_range_observe(self._table.ctypes.data, self._neurons, frame.array, frame.count)

    def merge(self, other: Ranges) -> None:
        """Widen the ranges by all that `other` observed: exactly as if it had been observed here.

        ValueError: the numbers of neurons differ
        """
        if not isinstance(other, Ranges):
            raise TypeError(f"expected Ranges, got {type(other).__name__}")
        if other._neurons != self._neurons:
            raise ValueError(f"ranges of {other._neurons} neurons, expected {self._neurons}")
        np.minimum(self._table[:, 0], other._table[:, 0], out=self._table[:, 0])
        np.maximum(self._table[:, 1], other._table[:, 1], out=self._table[:, 1])

    @property
    def observed(self) -> NDArray[np.float32]:
        """[neurons][2], a copy: the least and the greatest activation; infinity and minus infinity
        as long as nothing was observed."""
        return self._table.copy()

    def expand(self, factor: float = 1.2, rule: str = "about_midpoint") -> NDArray[np.float32]:
        """The table to bin with: what was observed, widened to leave a margin.

        factor: >= 1
        rule: "about_midpoint" multiplies the half-width. "about_zero" multiplies both edges, as the
              reference package does, which clamps a neuron whose minimum is positive
        returns: float32 [neurons][2], lo and hi of each neuron in activation units
        VdnaError: EMPTY if nothing was observed, ARG for a bad factor, NONFINITE if an edge leaves
                   the float range
        """
        if rule not in _RULES:
            raise ValueError(f"rule is {rule!r}, expected one of {sorted(_RULES)}")
        table = self._table.copy()
        lib.vdna_range_expand(table.ctypes.data, self._neurons, factor, _RULES[rule])
        return table
