"""Numbers in and out of the library: arrays that it may read, and arrays over what it holds."""

from __future__ import annotations

import operator
from typing import Any, SupportsIndex, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

UINT32_MAX = 2**32 - 1


def integer(value: SupportsIndex, what: str, lowest: int, highest: int) -> int:
    """An integer that fits its C field; ctypes would cut off the rest without a word."""
    number = operator.index(value)
    if not lowest <= number <= highest:
        raise ValueError(f"{what} is {number}, expected {lowest} to {highest}")
    return number


def array_of(values: ArrayLike, what: str) -> NDArray[Any]:
    """An array of any dtype. One with a mask is refused, because NumPy would drop the mask."""
    parts = values if isinstance(values, (list, tuple)) else [values]
    if any(isinstance(part, np.ma.MaskedArray) for part in parts):
        raise TypeError(
            f"{what} is a masked array, whose mask would be lost; leave masked numbers out, or give"
            " them a value with .filled(value)"
        )
    return np.asarray(values)


def floats(values: ArrayLike, what: str, dtype: Any = np.float32) -> NDArray[Any]:
    """Real numbers in C order; the very same memory if that is what they are."""
    array = array_of(values, what)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{what} holds {array.dtype}, expected real numbers ({np.dtype(dtype)})")
    return np.require(array, dtype, ["C_CONTIGUOUS", "ALIGNED"])


def integers(values: ArrayLike, what: str, dtype: Any) -> NDArray[Any]:
    """Integers in C order; the very same memory if they already have the dtype."""
    array = array_of(values, what)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{what} holds {array.dtype}, expected integers ({np.dtype(dtype)})")
    if array.dtype != dtype and array.size > 0:
        limits = np.iinfo(dtype)
        integer(array.min(), f"the smallest number of {what}", limits.min, limits.max)
        integer(array.max(), f"the largest number of {what}", limits.min, limits.max)
    return np.require(array, dtype, ["C_CONTIGUOUS", "ALIGNED"])


def shaped(array: NDArray[Any], shape: Tuple[Any, ...], what: str) -> NDArray[Any]:
    """The array, if its shape is this one; a text in `shape` names a length that is free."""
    expected = "[" + "][".join(str(length) for length in shape) + "]"
    fits = array.ndim == len(shape) and all(
        isinstance(length, str) or length == found for length, found in zip(shape, array.shape)
    )
    if not fits:
        raise ValueError(f"{what} has the shape {list(array.shape)}, expected {expected}")
    return array


class _Memory:
    """Tells NumPy of memory that the library points at; its owner lives as long as this does."""

    def __init__(self, owner: object, address: int, shape: Tuple[int, ...], dtype: Any) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "version": 3,
            "data": (address, True),
            "shape": shape,
            "typestr": np.dtype(dtype).str,
        }


def view(owner: object, address: int, shape: Tuple[int, ...], dtype: Any) -> NDArray[Any]:
    """A read-only array over the library's memory, which keeps its owner alive."""
    return np.asarray(_Memory(owner, address, shape, dtype))


def block(size: int) -> NDArray[np.int64]:
    """Memory of at least `size` bytes for the library, aligned for all that it keeps."""
    return np.empty((size + 7) // 8, np.int64)
