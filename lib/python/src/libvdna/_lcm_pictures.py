"""Camera messages (bot_core.image_t) as Foxglove's pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Optional, Union

import numpy as np
from numpy.typing import NDArray

from ._lcm_types import DamagedMessage


@dataclass(frozen=True)
class CompressedPicture:
    format: str
    data: bytes


@dataclass(frozen=True)
class RawPicture:
    encoding: str
    width: int
    height: int
    step: int
    """Bytes from row to row."""
    data: bytes


Picture = Union[CompressedPicture, RawPicture]


# Foxglove's name and the bytes of a pixel, for formats that both have.
_SAME = {
    b"GREY": ("mono8", 1),
    b"RGB3": ("rgb8", 3),
    b"BGR3": ("bgr8", 3),
    b"YUYV": ("yuyv", 2),
    b"UYVY": ("uyvy", 2),
    **{fourcc: ("mono16", 2) for fourcc in (b"Y10 ", b"Y12 ", b"Y14 ", b"Y16 ", b"LG16")},
}
_FOUR_BYTES = {b"RGB4": "rgb8", b"BGR4": "bgr8"}
_PLANES = (b"I420", b"YU12", b"NV12")


def picture_of(image: Dict[str, Any]) -> Optional[Picture]:
    """None if Foxglove has no such pictures. Raises DamagedMessage where bytes are missing."""
    data = image["data"]
    compressed = _format_of(data)
    fourcc = (image["pixelformat"] & 0xFFFFFFFF).to_bytes(4, "little")
    if fourcc in _SAME:
        encoding, pixel = _SAME[fourcc]
        rows = _rows(image, pixel)
        return RawPicture(encoding, image["width"], len(rows), rows.shape[1], rows.tobytes())
    if fourcc in _FOUR_BYTES:
        # The fourth byte is unused; Foxglove would take it for opacity.
        width = image["width"]
        pixels = _rows(image, 4)[:, : 4 * width].reshape(-1, width, 4)[:, :, :3]
        return _packed(_FOUR_BYTES[fourcc], pixels)
    if fourcc in _PLANES:
        return _packed("rgb8", _rgb_of_planes(image, is_nv12=fourcc == b"NV12"))
    return CompressedPicture(compressed, data) if compressed else None


def _format_of(data: bytes) -> str:
    if data.startswith(b"\xff\xd8\xff"):
        return "jpeg"
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return "png"
    is_webp = data.startswith(b"RIFF") and data[8:12] == b"WEBP"
    return "webp" if is_webp else ""


def _packed(encoding: str, pixels: NDArray[np.uint8]) -> RawPicture:
    height, width, channels = pixels.shape
    return RawPicture(encoding, width, height, channels * width, pixels.tobytes())


def _rows(image: Dict[str, Any], pixel: int, planes: float = 1) -> NDArray[np.uint8]:
    """The bytes of the rows, [height * planes][row stride]."""
    width, height = image["width"], image["height"]
    stride = image["row_stride"] or pixel * width
    if width <= 0 or height <= 0 or stride < pixel * width:
        raise DamagedMessage(f"a picture of {width} x {height} pixels and {stride} bytes a row")
    rows = int(height * planes)
    if len(image["data"]) < rows * stride:
        raise DamagedMessage(
            f"a picture of {width} x {height} pixels has {len(image['data'])} bytes, expected "
            f"{rows * stride}"
        )
    return np.frombuffer(image["data"], np.uint8, rows * stride).reshape(rows, stride)


def _rgb_of_planes(image: Dict[str, Any], is_nv12: bool) -> NDArray[np.uint8]:
    """4:2:0 by BT.601 with 16..235, as the robot reads it; Foxglove has no planes."""
    width, height = image["width"], image["height"]
    stride = image["row_stride"] or width
    if width % 2 or height % 2 or stride % 2:
        raise DamagedMessage(f"a 4:2:0 picture of {width} x {height} pixels, expected even sides")
    rows = _rows(image, 1, planes=1.5)
    luma = rows[:height, :width]
    chroma = rows[height:].reshape(-1)
    if is_nv12:
        pairs = chroma.reshape(height // 2, stride)[:, :width].reshape(height // 2, width // 2, 2)
        blue, red = pairs[:, :, 0], pairs[:, :, 1]
    else:
        blue, red = chroma.reshape(2, height // 2, stride // 2)[:, :, : width // 2]
    y = 1.164 * np.maximum(luma.astype(np.float32) - 16, 0)
    u, v = (one.repeat(2, 0).repeat(2, 1).astype(np.float32) - 128 for one in (blue, red))
    rgb = np.stack([y + 1.596 * v, y - 0.391 * u - 0.813 * v, y + 2.018 * u], 2)
    return np.clip(rgb + 0.5, 0, 255).astype(np.uint8)
