"""Networks: a picture in, activations and an embedding out, as the robot computes them."""

from __future__ import annotations

import glob
import importlib.util
import os
from ctypes import c_void_p
from typing import Any, List, NamedTuple, Optional, SupportsIndex, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from ._arrays import array_of, integer, view
from ._library import Activations, BackboneConfig, BackboneFields, BackboneOutput, Error, Image
from ._library import Status, VdnaError, backbone_lib
from .identity import Identity, parse_taps

Picture = Union[NDArray[np.uint8], bytes, bytearray, memoryview]
"""uint8 [height][width] (grey) or [height][width][3] (red, green, blue), or the bytes of a JPEG, which
is turned as its EXIF says. An array is taken as it is: turn it and scale it to 8 bits before."""

_ENCODED = 0
_GREY = int.from_bytes(b"GREY", "little")
_RGB3 = int.from_bytes(b"RGB3", "little")
_NEURONS_SAMPLES = 1
_THREADS_MAX = 256
_SIDE_MAX = 16384
_PIXELS_MAX = 67108864


class BackboneInfo(NamedTuple):
    """What a network is."""

    identity: Identity
    """What experiences that are made with it carry; bins and range are not known."""
    input_size: Optional[Tuple[int, int]]
    """Width and height of the network's input; None if a plug-in does not show that."""
    runtime: str
    """What runs it: "onnxruntime 1.28.0"."""


class NamedTap(NamedTuple):
    """The activations of one tap."""

    name: str
    """As in the taps of the identity."""
    values: NDArray[np.float32]
    """float32 [samples][neurons], as Histogram.add() takes them."""


class BackboneFrame(NamedTuple):
    """What a network made of one picture. All arrays are the caller's."""

    taps: List[NamedTap]
    """In the order of the neurons."""
    embedding: NDArray[np.float32]
    """float32 [dim]: what frames are localised by."""
    grey: float
    """Mean grey level of the whole picture, 0 to 255."""
    last_layer: Optional[NDArray[np.float32]]
    """float32 [its own size]: a second embedding, of the last layer; None if there is none."""


class Backbone:
    """An open network. Close it, or use it in a `with` statement.

        with libvdna.Backbone("efficientnet_lite0") as backbone:
            frame = backbone.run(picture)
            histogram.add(*(tap.values for tap in frame.taps))

    ONNX Runtime is that of `runtime`, else of $VDNA_ONNXRUNTIME, else of the package onnxruntime if
    that is installed, else the system's.
    """

    def __init__(
        self,
        network: Union[str, "os.PathLike[str]"],
        *,
        threads: SupportsIndex = 2,
        max_pixels: SupportsIndex = _PIXELS_MAX,
        runtime: Union[None, str, "os.PathLike[str]"] = None,
    ) -> None:
        """
        network: name of a manifest in $VDNA_MODELS or /usr/share/vdna/models, or the path of a .toml
                 (with a '/' or ending so) or of a plug-in (with a '/', ending in ".so")
        threads: compute threads of the network, 1 to 256
        max_pixels: largest width x height of a picture
        runtime: path of a libonnxruntime.so
        VdnaError: UNSUPPORTED if this wheel has no networks; else what vdna_backbone_open() says
        """
        self._handle = c_void_p()
        self._library = backbone_lib()
        config = BackboneConfig()
        self._library.vdna_backbone_config_init(config)
        config.manifest = _text(network, "network")
        config.threads = integer(threads, "threads", 1, _THREADS_MAX)
        config.max_pixels = integer(max_pixels, "max_pixels", 1, _PIXELS_MAX)
        config.runtime = _runtime_of_package() if runtime is None else _text(runtime, "runtime")
        try:
            self._library.vdna_backbone_open(config, Error(), self._handle)
        except VdnaError as error:
            if error.status is Status.RUNTIME and "ONNX Runtime cannot be loaded" in error.text:
                text = error.text + "; `pip install onnxruntime` brings one"
                raise VdnaError(error.status, text) from None
            raise
        fields = BackboneFields()
        self._library.vdna_backbone_describe(self._handle, fields)
        size = (fields.input_width, fields.input_height)
        self._info = BackboneInfo(
            Identity._over(fields, fields.identity),
            size if size[0] > 0 else None,
            fields.runtime.decode("utf-8", "replace"),
        )
        self._tap_names = [tap.name for tap in parse_taps(self._info.identity.taps)]

    def __repr__(self) -> str:
        closed = "" if self._handle else ", closed"
        return f"<Backbone {self._info.identity.backbone}{closed}>"

    @property
    def info(self) -> BackboneInfo:
        """What the network is."""
        return self._info

    def run(self, picture: Picture) -> BackboneFrame:
        """Run one picture; it is decoded and resized as on the robot.

        VdnaError: FORMAT or UNSUPPORTED for a bad picture, NONFINITE if the network gives a NaN,
                   RUNTIME after cancel()
        """
        if not self._handle:
            raise ValueError("the backbone is closed; open another one")
        pixels, image = _image_of(picture)
        output = BackboneOutput()
        self._library.vdna_backbone_run(self._handle, image, Error(), output)
        del pixels  # until here the library read them
        taps = output.taps[: output.tap_count]
        return BackboneFrame(
            [NamedTap(name, _values_of(tap)) for name, tap in zip(self._tap_names, taps)],
            view(self, output.embedding, (output.dim,), np.float32).copy(),
            float(output.grey),
            _copied(output.last_layer, output.last_layer_dim),
        )

    def cancel(self) -> None:
        """End a run() in progress early, from any thread, and refuse all later ones."""
        if self._handle:
            self._library.vdna_backbone_cancel(self._handle)

    def close(self) -> None:
        """Free the network's memory; closing again does nothing."""
        if self._handle:
            self._library.vdna_backbone_close(self._handle)
            self._handle = c_void_p()

    def __enter__(self) -> Backbone:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if hasattr(self, "_library"):
            self.close()


def _copied(address: Optional[int], count: int) -> Optional[NDArray[np.float32]]:
    return None if address is None else view(None, address, (count,), np.float32).copy()


def _text(value: Union[str, "os.PathLike[str]"], what: str) -> bytes:
    text = os.fsencode(value)
    if b"\0" in text:
        raise ValueError(f"{what} holds a NUL byte")
    return text


def _runtime_of_package() -> Optional[bytes]:
    """The library within PyPI's onnxruntime, which is found but not imported."""
    if os.environ.get("VDNA_ONNXRUNTIME"):
        return None
    package = importlib.util.find_spec("onnxruntime")
    for folder in (package and package.submodule_search_locations) or []:
        for path in sorted(glob.glob(os.path.join(glob.escape(folder), "capi/libonnxruntime.so*"))):
            return os.fsencode(path)
    return None


def _image_of(picture: Picture) -> Tuple[NDArray[np.uint8], Image]:
    """The bytes, which must outlive the image, and the image over them."""
    if isinstance(picture, (bytes, bytearray, memoryview)):
        data = np.frombuffer(picture, np.uint8)
        return data, Image(data.ctypes.data, data.size, 0, 0, 0, _ENCODED)
    pixels = array_of(picture, "the picture")
    if pixels.dtype != np.uint8:
        raise TypeError(
            f"the picture holds {pixels.dtype}, expected uint8; scale it by the value of its white:"
            " (picture * (255 / white)).round().astype(numpy.uint8)"
        )
    if pixels.ndim != 2 and pixels.shape[2:] != (3,):
        raise ValueError(
            f"the picture has the shape {list(pixels.shape)}, expected [height][width] or"
            " [height][width][3]"
        )
    height = integer(pixels.shape[0], "the picture's height", 1, _SIDE_MAX)
    width = integer(pixels.shape[1], "the picture's width", 1, _SIDE_MAX)
    pixels = np.ascontiguousarray(pixels)
    pixelformat = _GREY if pixels.ndim == 2 else _RGB3
    return pixels, Image(pixels.ctypes.data, pixels.size, width, height, 0, pixelformat)


def _values_of(tap: Activations) -> NDArray[np.float32]:
    shape = (tap.samples, tap.neurons)
    if tap.layout == _NEURONS_SAMPLES:
        values: NDArray[Any] = view(None, tap.values, shape[::-1], np.float32).T
    else:
        values = view(None, tap.values, shape, np.float32)
    return np.array(values, order="C")
