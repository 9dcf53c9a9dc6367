"""Activations: what a network gives for one frame, in the layouts that networks produce."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, floats, integer
from ._library import Activations

_SAMPLES_NEURONS = 0
_NEURONS_SAMPLES = 1


@dataclass(frozen=True)
class FeatureMap:
    """Activations whose first axis is the neurons: a convolution's [channels][height][width].

    All further axes are samples. Arrays that are not wrapped have the neurons last.
    """

    values: ArrayLike


Tap = Union[ArrayLike, FeatureMap]
"""Activations of one tap: [neurons], [samples][neurons], or FeatureMap([neurons][...])."""


class Taps:
    """The taps of one frame as the library reads them. Keep it as long as `array` is in use."""

    def __init__(self, taps: Sequence[Tap]) -> None:
        self._values = [self._values_of(tap) for tap in taps]
        self.count = len(taps)
        self.array = (Activations * max(1, self.count))()
        for tap, values, out in zip(taps, self._values, self.array):
            feature_map = isinstance(tap, FeatureMap)
            neurons = values.shape[0 if feature_map else -1]
            samples = values.size // neurons if neurons > 0 else 0
            out.values = values.ctypes.data
            out.neurons = integer(neurons, "the number of neurons", 0, UINT32_MAX)
            out.samples = integer(samples, "the number of samples", 0, UINT32_MAX)
            out.layout = _NEURONS_SAMPLES if feature_map else _SAMPLES_NEURONS

    @staticmethod
    def _values_of(tap: Tap) -> NDArray[np.float32]:
        values: Any = tap.values if isinstance(tap, FeatureMap) else tap
        array = floats(values, "a tap")
        if isinstance(tap, FeatureMap):
            if array.ndim < 2:
                raise ValueError(
                    f"a FeatureMap has the shape {list(array.shape)}, expected [neurons][...]"
                )
        elif array.ndim not in (1, 2):
            raise ValueError(
                f"a tap has the shape {list(array.shape)}, expected [neurons] or"
                " [samples][neurons]; wrap a convolution's output as FeatureMap(...)"
            )
        return array
