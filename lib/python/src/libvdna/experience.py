"""Experience files: one recorded traversal each, read by mmap without a copy."""

from __future__ import annotations

import os
import tempfile
from ctypes import addressof, c_size_t, c_uint32, c_void_p, memmove, sizeof, string_at
from typing import Any, Callable, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, floats, integer, integers, shaped, view
from ._library import Error, ExperienceFile, HistView, Status, VdnaError, lib
from .histogram import HistogramView, view_of
from .identity import NAME_SIZE, Identity, identity_fields, text_field

#: Place number of a frame without ground truth.
PLACE_NONE = -(2**63)

#: Bytes of `order`, its NUL included.
ORDER_SIZE = 32

#: Bytes of `source`, its NUL included.
SOURCE_SIZE = 128

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


def _path(path: Path) -> bytes:
    name = os.fsencode(path)
    if b"\0" in name:
        raise ValueError("a path holds a NUL byte")
    return name


class _Mapping:
    """An open file's struct; unmapped when the last array over it is gone."""

    def __init__(self) -> None:
        self.file = ExperienceFile()

    def __del__(self) -> None:
        lib.vdna_experience_close(self.file)


class _InMemory:
    """The struct of an experience in memory, and what it points to."""

    def __init__(self, words: NDArray[np.uint8], file: ExperienceFile) -> None:
        self.words, self.file = words, file
        self.decoded: Optional[NDArray[np.float32]] = None


class Experience:
    """One recorded traversal: its Visual DNA, and the embedding and labels of each frame.

    Its file stays mapped as long as the experience or an array of it is in use. Until then the file
    may be replaced by a rename or deleted, but not overwritten or cut short in place.
    """

    _file: ExperienceFile
    _owner: object
    _histogram: HistogramView
    _embeddings: NDArray[np.float32]
    _frame_utime: NDArray[np.int64]
    _frame_grey: NDArray[np.float32]
    _frame_place: Optional[NDArray[np.int64]]
    _frame_position: Optional[NDArray[np.float64]]
    _projection: Optional[NDArray[np.float32]]
    _last_layer: Optional[NDArray[np.int8]]
    _last_layer_scale: Optional[NDArray[np.float32]]
    _thumbnails: Optional[NDArray[np.uint8]]
    _thumbnail_end: Optional[NDArray[np.uint32]]

    def __init__(
        self,
        *,
        name: str,
        backbone: str,
        model_sha256: str,
        preprocessing: str,
        taps: str,
        histogram: HistogramView,
        embeddings: ArrayLike,
        frame_utime: ArrayLike,
        frame_grey: ArrayLike,
        frame_place: Optional[ArrayLike] = None,
        frame_position: Optional[ArrayLike] = None,
        precision: str = "fp32",
        position_frame: str = "",
        order: str = "",
        embedding: str = "",
        last_layer: Optional[ArrayLike] = None,
        projection: Optional[ArrayLike] = None,
        source: str = "",
        thumbnails: Optional[Sequence[Optional[bytes]]] = None,
    ) -> None:
        """An experience to write(). Arrays of the stated dtypes are not copied.

        name: of the traversal: 1 to 63 letters, digits, '.', '_', '-'
        backbone: name of the network; same alphabet
        model_sha256: of the ONNX file, 64 lower-case hexadecimal digits
        preprocessing: everything that shapes the network's input, 1 to 511 printable characters
        taps: "NAME:NEURONS:SAMPLES[,...]" in the order of the histogram's neurons
        histogram: of all frames
        embeddings: float32 [frames][dim]
        frame_utime: int64 [frames], camera stamps in microseconds
        frame_grey: float32 [frames], mean grey levels 0..255
        frame_place: int64 [frames], place numbers; PLACE_NONE: this frame has none
        frame_position: float64 [frames][3], metres in `position_frame`; three NaNs: this frame has
                        none
        precision: of the network's arithmetic, "fp32" or "int8"; alphabet as for `name`, 1 to 15
        position_frame: "wgs84" for Earth-centred metres made from GPS, else the name of a local
                        frame; "": wgs84 if all positions lie near the surface of the Earth, seen
                        from its centre, else "local"
        order: what ordered the frames: "utime", "numbers", "names", "log", "video", "manifest"; "":
               not known
        embedding: how `embeddings` are made of the network's outputs, as in Identity
        last_layer: float32 [frames][its own size], a second embedding of each frame, that of the
                    network's last layer; the file has 8-bit codes with a scale for each frame
        projection: float32 [dim][raw_dim], directions of which `embeddings` are the coordinates, as
                    Identity.project() of this experience's identity gives them
        source: what it was made from, for people: at most 127 printable ASCII characters
        thumbnails: [frames], a small JPEG file of each frame, of at most 4096 bytes; None or b"": this
                    frame has none
        """
        self._histogram = histogram
        self._embeddings = shaped(floats(embeddings, "embeddings"), ("frames", "dim"), "embeddings")
        frames, dim = self._embeddings.shape
        utime = integers(frame_utime, "frame_utime", np.int64)
        self._frame_utime = shaped(utime, (frames,), "frame_utime")
        self._frame_grey = shaped(floats(frame_grey, "frame_grey"), (frames,), "frame_grey")
        self._frame_place = self._frame_position = None
        if frame_place is not None:
            place = integers(frame_place, "frame_place", np.int64)
            self._frame_place = shaped(place, (frames,), "frame_place")
        if frame_position is not None:
            position = floats(frame_position, "frame_position", np.float64)
            self._frame_position = shaped(position, (frames, 3), "frame_position")

        self._projection = None
        if projection is not None:
            directions = floats(projection, "projection")
            self._projection = shaped(directions, (dim, "raw_dim"), "projection")
        self._last_layer = self._last_layer_scale = None
        if last_layer is not None:
            values = shaped(floats(last_layer, "last_layer"), (frames, "numbers"), "last_layer")
            self._last_layer, self._last_layer_scale = encoded(values)

        self._thumbnails = self._thumbnail_end = None
        if thumbnails is not None:
            if len(thumbnails) != frames:
                raise ValueError(f"{len(thumbnails)} thumbnails, expected {frames}, one for each frame")
            files = [jpeg or b"" for jpeg in thumbnails]
            if any(files):
                self._thumbnails = np.frombuffer(b"".join(files), np.uint8)
                self._thumbnail_end = np.cumsum([len(jpeg) for jpeg in files]).astype(np.uint32)

        dna = view_of(histogram)
        self._owner = None
        self._file = ExperienceFile(
            name=text_field(name, "name", NAME_SIZE),
            identity=identity_fields(
                backbone=backbone,
                model_sha256=model_sha256,
                preprocessing=preprocessing,
                precision=precision,
                taps=taps,
                neurons=dna.neurons,
                dim=integer(dim, "dim", 0, UINT32_MAX),
                bins=dna.bins,
                range=dna.range,
                embedding=embedding,
                projection=self._projection,
            ),
            frames=integer(frames, "the number of frames", 0, UINT32_MAX),
            counts=dna.counts,
            mass=dna.mass,
            embeddings=self._embeddings.ctypes.data,
            frame_utime=self._frame_utime.ctypes.data,
            frame_place=_address(self._frame_place),
            frame_position=_address(self._frame_position),
            frame_grey=self._frame_grey.ctypes.data,
            position_frame=text_field(position_frame, "position_frame", NAME_SIZE),
            order=text_field(order, "order", ORDER_SIZE),
            last_layer=_address(self._last_layer),
            last_layer_scale=_address(self._last_layer_scale),
            last_layer_dim=0 if self._last_layer is None else self._last_layer.shape[1],
            thumbnails=_address(self._thumbnails),
            thumbnail_end=_address(self._thumbnail_end),
            thumbnail_bytes=0 if self._thumbnails is None else len(self._thumbnails),
            source=text_field(source, "source", SOURCE_SIZE),
        )

    @classmethod
    def open(cls, path: Path) -> Experience:
        """Open an experience file: map it, check every byte of it, point into it.

        VdnaError: IO, FORMAT, CHECKSUM, UNSUPPORTED for a newer format
        """
        mapping = _Mapping()
        lib.vdna_experience_open(_path(path), Error(), mapping.file)
        return cls._over(mapping)

    @classmethod
    def from_bytes(cls, data: Union[bytes, bytearray, memoryview, NDArray[np.uint8]]) -> Experience:
        """Open the bytes of an experience file, which the experience keeps; they must not change.

        They are copied only if they do not begin at a multiple of 8.
        VdnaError: FORMAT, CHECKSUM, UNSUPPORTED for a newer format
        """
        given = np.frombuffer(data, np.uint8)
        words = given
        if given.ctypes.data % 8 != 0:
            words = np.empty((given.size + 7) // 8, np.int64).view(np.uint8)[: given.size]
            words[:] = given
        held = _InMemory(words, ExperienceFile())
        lib.vdna_experience_open_memory(words.ctypes.data, words.size, Error(), held.file)
        file = held.file
        if file.embedding_codes:
            codes = view(held, file.embedding_codes, (file.frames, file.identity.dim), np.int8)
            scales = view(held, file.embedding_scale, (file.frames,), np.float32)
            held.decoded = codes * scales[:, None]
            file.embeddings = held.decoded.ctypes.data
        return cls._over(held)

    @classmethod
    def _over(cls, mapping: Union[_Mapping, _InMemory]) -> Experience:
        self = cls.__new__(cls)
        file = self._file = mapping.file
        self._owner = mapping
        pointers = HistView()
        lib.vdna_experience_view(file, pointers)

        def array(address: Optional[int], dtype: Any, *columns: int) -> Any:
            return address and view(mapping, address, (file.frames, *columns), dtype)

        self._histogram = HistogramView._over(mapping, pointers)
        self._embeddings = array(file.embeddings, np.float32, file.identity.dim)
        self._frame_utime = array(file.frame_utime, np.int64)
        self._frame_grey = array(file.frame_grey, np.float32)
        self._frame_place = array(file.frame_place, np.int64)
        self._frame_position = array(file.frame_position, np.float64, 3)
        self._last_layer = array(file.last_layer, np.int8, file.last_layer_dim)
        self._last_layer_scale = array(file.last_layer_scale, np.float32)
        return self

    def __repr__(self) -> str:
        return (
            f"<Experience {self.name}: {self.frames} frames, {self.histogram.neurons} neurons in"
            f" {self.histogram.bins} bins, by {self.backbone}>"
        )

    def __reduce__(self) -> Tuple[Callable[[bytes], Experience], Tuple[bytes]]:
        """Pickled as the bytes of its file."""
        return type(self).from_bytes, (self.to_bytes(),)

    def to_bytes(self) -> bytes:
        """The bytes of its file: those it was opened from, or those that write() writes.

        VdnaError: as write()
        """
        if self._file.file_bytes:
            return string_at(self._file.file_bytes, self._file.file_size)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "experience.vdna")
            self.write(path)
            with open(path, "rb") as file:
                return file.read()

    def with_histogram(self, histogram: HistogramView) -> Experience:
        """The same traversal counted over other ranges, or in other bins. Arrays are shared."""
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__)
        dna, file = view_of(histogram), ExperienceFile()
        memmove(addressof(file), addressof(self._file), sizeof(file))
        file.identity.neurons, file.identity.bins = dna.neurons, dna.bins
        file.identity.range, file.counts, file.mass = dna.range, dna.counts, dna.mass
        file.comparable, file.file_bytes, file.file_size = b"", None, 0
        other._owner, other._histogram, other._file = (self, histogram), histogram, file
        return other

    def write(self, path: Path) -> None:
        """Write the file crash-safely: an interrupted call leaves `path` as it was.

        VdnaError: ARG, NONFINITE or MISMATCH for an experience that breaks the rules of
                   docs/reference/SPEC-map.md, IO
        """
        lib.vdna_experience_write(self._file, _path(path), Error())

    def check_comparable(self, other: Experience) -> None:
        """Check that two experiences have the same model, precision, preprocessing, taps, dim,
        bins and ranges.

        VdnaError: MISMATCH, naming the first field that differs
        """
        if not isinstance(other, Experience):
            raise TypeError(f"expected an Experience, got {type(other).__name__}")
        lib.vdna_experience_compare(self._file, other._file, Error())

    @property
    def name(self) -> str:
        """Name of the traversal."""
        return str(self._file.name.decode())

    @property
    def identity(self) -> Identity:
        """What it compares with."""
        return Identity._over(self, self._file.identity)

    @property
    def backbone(self) -> str:
        """Name of the network."""
        return self.identity.backbone

    @property
    def model_sha256(self) -> str:
        """SHA-256 of the ONNX file."""
        return self.identity.model_sha256

    @property
    def preprocessing(self) -> str:
        """Everything that shaped the network's input."""
        return self.identity.preprocessing

    @property
    def precision(self) -> str:
        """Of the network's arithmetic: "fp32", "int8"."""
        return self.identity.precision

    @property
    def taps(self) -> str:
        """NAME:NEURONS:SAMPLES[,...] in the order of the histogram's neurons; see parse_taps()."""
        return self.identity.taps

    @property
    def comparable(self) -> Optional[str]:
        """SHA-256 over all that must agree for two experiences to compare; None if this one is not
        from a file."""
        return self._file.comparable.decode() or None

    @property
    def struct(self) -> ExperienceFile:
        """The C struct, as long as this object lives."""
        return self._file

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self._embeddings)

    @property
    def dim(self) -> int:
        """Numbers in an embedding."""
        return int(self._embeddings.shape[1])

    @property
    def histogram(self) -> HistogramView:
        """The Visual DNA of all frames."""
        return self._histogram

    @property
    def embeddings(self) -> NDArray[np.float32]:
        """[frames][dim]: what frames are localised by; a live frame by `identity.project()` of what the
        network gives."""
        return self._embeddings

    @property
    def last_layer(self) -> Optional[NDArray[np.float32]]:
        """[frames][its own size]: a second embedding of each frame, that of the network's last
        layer, decoded at each call; None if there is none."""
        if self._last_layer is None or self._last_layer_scale is None:
            return None
        return self._last_layer * self._last_layer_scale[:, None]

    @property
    def frame_utime(self) -> NDArray[np.int64]:
        """[frames]: camera stamps in microseconds."""
        return self._frame_utime

    @property
    def frame_grey(self) -> NDArray[np.float32]:
        """[frames]: mean grey levels 0..255."""
        return self._frame_grey

    @property
    def frame_place(self) -> Optional[NDArray[np.int64]]:
        """[frames]: place numbers, PLACE_NONE for a frame without one; None if there are none."""
        return self._frame_place

    @property
    def frame_position(self) -> Optional[NDArray[np.float64]]:
        """[frames][3]: metres in `position_frame`, NaN for a frame without one; None if there are
        none."""
        return self._frame_position

    @property
    def position_frame(self) -> str:
        """The frame of the positions: "wgs84" if Earth-centred, else the name of a local one; ""
        without positions."""
        return str(self._file.position_frame.decode())

    @property
    def order(self) -> str:
        """What ordered the frames, such as "utime" or "numbers"; "" if that is not known."""
        return str(self._file.order.decode())

    @property
    def source(self) -> str:
        """What it was made from, for people; "" if that is not known."""
        return str(self._file.source.decode())

    def thumbnail(self, frame: int) -> Optional[bytes]:
        """The small JPEG file of a frame; None if it has none. Nobody has decoded it yet."""
        if not 0 <= frame < self.frames:
            raise IndexError(f"frame {frame}, expected 0 to {self.frames - 1}")
        jpeg, size = c_void_p(), c_size_t()
        try:
            lib.vdna_experience_thumbnail(self._file, frame, jpeg, size)
        except VdnaError as error:
            if error.status != Status.EMPTY:
                raise
            return None
        return string_at(jpeg.value or 0, size.value)


def encoded(values: NDArray[np.float32]) -> Tuple[NDArray[np.int8], NDArray[np.float32]]:
    """The codes of vdna/int8.h for each row, and the rows' scales.

    VdnaError: NONFINITE for a NaN or an infinity, ARG for rows of no numbers
    """
    codes, scales = np.empty(values.shape, np.int8), np.empty(len(values), np.float32)
    for row, of_row, scale in zip(values, codes, scales.reshape(-1, 1)):
        lib.vdna_int8_encode(row.ctypes.data, row.size, of_row.ctypes.data, scale.ctypes.data)
    return codes, scales


def _address(array: Optional[NDArray[Any]]) -> Optional[int]:
    return None if array is None else array.ctypes.data


def open_map(directory: Path) -> List[Experience]:
    """Open all experiences of a map, in the byte order of their file names, and check that they
    compare and that their names differ.

    directory: its files that end in ".vdna" are the experiences
    VdnaError: EMPTY if there is none, MISMATCH, and what Experience.open() raises
    """
    path, count = _path(directory), c_uint32()
    lib.vdna_map_count(path, Error(), count)
    files = (ExperienceFile * max(1, count.value))()
    lib.vdna_map_open(path, len(files), Error(), files, count)
    experiences = []
    for file in files[: count.value]:
        mapping = _Mapping()
        mapping.file = file
        experiences.append(Experience._over(mapping))
    return experiences
