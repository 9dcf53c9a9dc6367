"""Nearest neighbours of an embedding among all of a map: localisation within one experience."""

from __future__ import annotations

from typing import NamedTuple, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, floats, integer, shaped
from ._library import KnnMatch, lib


class Neighbours(NamedTuple):
    """The nearest rows, nearest first; equal distances by lower index."""

    rows: NDArray[np.uint32]
    """[min(k, rows)]: indices of rows of the map."""
    distance_sq: NDArray[np.float64]
    """[min(k, rows)]: squared Euclidean distances, summed in single precision; vdna/knn.h has the
    error."""


def nearest(query: ArrayLike, map: ArrayLike, k: SupportsIndex = 1) -> Neighbours:
    """Find the `k` rows of `map` that are nearest to `query`.

    query: float32 [dim]
    map: float32 [rows][dim], rows >= 1: the embeddings of an experience; not copied
    VdnaError: NONFINITE if a distance is not finite, ARG if there is no row or no number in one
    """
    one = shaped(floats(query, "query"), ("dim",), "query")
    rows = shaped(floats(map, "map"), ("rows", len(one)), "map")
    wanted = min(integer(k, "k", 1, UINT32_MAX), max(1, len(rows)))
    dim = integer(len(one), "dim", 0, UINT32_MAX)
    count = integer(len(rows), "the number of rows", 0, UINT32_MAX)
    matches = np.empty(wanted, np.dtype(KnnMatch))
    lib.vdna_knn(one.ctypes.data, dim, rows.ctypes.data, count, wanted, matches.ctypes.data)
    return Neighbours(matches["index"], matches["distance_sq"])
