"""What makes two Visual DNAs comparable: the network, its input, its taps, the bins."""

from __future__ import annotations

from ctypes import addressof, c_void_p, create_string_buffer, string_at
from typing import Iterable, List, NamedTuple, Optional, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import UINT32_MAX, floats, integer, shaped, view
from ._library import Error, IdentityFields, Status, TapFields, VdnaError, lib

NAME_SIZE = 64
_SHA256_SIZE = 65
_PREPROCESSING_SIZE = 512
_PRECISION_SIZE = 16
_TAPS_SIZE = 2048
_EMBEDDING_SIZE = 256
_TEXT_SIZE = 2944


def text_field(value: str, what: str, size: int) -> bytes:
    """A text that fits its C field; ctypes would cut off the rest without a word."""
    text = str.encode(value)
    if b"\0" in text or len(text) >= size:
        raise ValueError(f"{what} is {value!r}, expected at most {size - 1} bytes without NUL")
    return text


class TapShape(NamedTuple):
    """One entry of a list of taps."""

    name: str
    neurons: int
    samples: int
    """Per neuron and frame."""


def parse_taps(taps: str) -> List[TapShape]:
    """The entries of "NAME:NEURONS:SAMPLES[,...]"; a NAME may hold a ':'.

    VdnaError: FORMAT
    """
    text = create_string_buffer(text_field(taps, "taps", _TAPS_SIZE))
    rest, tap = c_void_p(addressof(text)), TapFields()
    entries: List[TapShape] = []
    while True:
        status = lib.vdna_taps_next(rest, tap)
        if status == Status.EMPTY:
            return entries
        if status != Status.OK:
            sentence = f"taps is {taps!r}, expected NAME:NEURONS:SAMPLES, comma, ..."
            raise VdnaError(Status(status), sentence)
        name = string_at(tap.name, tap.name_length).decode()
        entries.append(TapShape(name, int(tap.neurons), int(tap.samples)))


def format_taps(taps: Iterable[TapShape]) -> str:
    """The list of taps that an identity has: "NAME:NEURONS:SAMPLES[,...]".

    VdnaError: ARG for a name that is empty or has a ',' or anything but printable ASCII characters;
               NOMEM for a list of more than 2047 bytes
    """
    text = create_string_buffer(_TAPS_SIZE)
    for name, neurons, samples in taps:
        buffer = create_string_buffer(str.encode(name))
        tap = TapFields(
            name=addressof(buffer),
            name_length=len(buffer) - 1,
            neurons=integer(neurons, "the number of neurons", 1, UINT32_MAX),
            samples=integer(samples, "the number of samples", 1, UINT32_MAX),
        )
        lib.vdna_taps_append(text, len(text), tap)
    return text.value.decode()


def clean_name(name: str) -> str:
    """A name for an experience: what it may not have becomes '_'. It is not made shorter."""
    text = create_string_buffer(text_field(name, "name", 1 << 16))
    lib.vdna_name_replace(text)
    return text.value.decode()


def identity_fields(
    *,
    backbone: str,
    model_sha256: str,
    preprocessing: str,
    precision: str,
    taps: str,
    neurons: int,
    dim: int,
    bins: int,
    range: Optional[int],
    embedding: str,
    projection: Optional[NDArray[np.float32]],
) -> IdentityFields:
    """The C struct; 0 and None stand for what is not known yet. Checked for what fits alone."""
    return IdentityFields(
        backbone=text_field(backbone, "backbone", NAME_SIZE),
        model_sha256=text_field(model_sha256, "model_sha256", _SHA256_SIZE),
        preprocessing=text_field(preprocessing, "preprocessing", _PREPROCESSING_SIZE),
        precision=text_field(precision, "precision", _PRECISION_SIZE),
        taps=text_field(taps, "taps", _TAPS_SIZE),
        neurons=neurons,
        dim=dim,
        bins=bins,
        range=range,
        embedding=text_field(embedding, "embedding", _EMBEDDING_SIZE),
        projection=None if projection is None else projection.ctypes.data,
        raw_dim=0
        if projection is None
        else integer(projection.shape[1], "raw_dim", 0, UINT32_MAX),
    )


class Identity:
    """Everything that must agree for two Visual DNAs to be compared.

    What is not known yet (dim, bins, range) is None, and is not compared. The definition of the
    embedding is known if dim is; its projection, or that there is none, if range is.
    """

    def __init__(
        self,
        *,
        backbone: str,
        model_sha256: str,
        preprocessing: str,
        taps: str,
        precision: str = "fp32",
        dim: Optional[SupportsIndex] = None,
        bins: Optional[SupportsIndex] = None,
        range: Optional[ArrayLike] = None,
        embedding: str = "",
        projection: Optional[ArrayLike] = None,
    ) -> None:
        """
        backbone: name of the network, for people: 1 to 63 letters, digits, '.', '_', '-'
        model_sha256: of the ONNX file, 64 lower-case hexadecimal digits
        preprocessing: everything that shapes the network's input, 1 to 511 printable characters
        taps: "NAME:NEURONS:SAMPLES[,...]"; format_taps() writes it
        precision: of the network's arithmetic, "fp32" or "int8"; alphabet of `backbone`, 1 to 15
        dim: numbers in an embedding
        bins: 2 to 65536
        range: float32 [neurons][2]; not copied
        embedding: how embeddings are made of the network's outputs, up to 255 printable characters;
                   "": one whole output
        projection: float32 [dim][raw_dim], directions of which the coordinates of an embedding are
                    kept; not copied; None: all of its numbers are kept
        VdnaError: ARG, FORMAT or MISMATCH for a field that breaks its rule
        """
        neurons = sum(tap.neurons for tap in parse_taps(taps))
        table = None if range is None else shaped(floats(range, "range"), (neurons, 2), "range")
        directions = None
        if projection is not None:
            kept = "dim" if dim is None else integer(dim, "dim", 1, UINT32_MAX)
            directions = shaped(floats(projection, "projection"), (kept, "raw_dim"), "projection")
        self._owner: object = (table, directions)
        self._fields = identity_fields(
            backbone=backbone,
            model_sha256=model_sha256,
            preprocessing=preprocessing,
            precision=precision,
            taps=taps,
            neurons=integer(neurons, "the number of neurons", 0, UINT32_MAX),
            dim=0 if dim is None else integer(dim, "dim", 1, UINT32_MAX),
            bins=0 if bins is None else integer(bins, "bins", 1, UINT32_MAX),
            range=None if table is None else table.ctypes.data,
            embedding=embedding,
            projection=directions,
        )
        lib.vdna_identity_check(self._fields, Error())

    @classmethod
    def _over(cls, owner: object, fields: IdentityFields) -> Identity:
        """Over the fields of `owner`, which also has the range and the projection."""
        self = cls.__new__(cls)
        self._owner, self._fields = owner, fields
        return self

    def __repr__(self) -> str:
        bins = "" if self.bins is None else f", {self.bins} bins"
        dim = "" if self.dim is None else f", embeddings of {self.dim}"
        return f"<Identity of {self.backbone} ({self.precision}): {self.neurons} neurons{bins}{dim}>"

    def check_comparable(self, other: Identity) -> None:
        """Check that Visual DNAs of both may be compared: same model, preprocessing, taps, and what
        both know of embedding, dim, bins, range and projection. A network knows no projection: it
        compares with maps that keep all numbers of its embeddings and with maps that keep fewer.

        VdnaError: MISMATCH, naming the first field that differs and both values
        """
        if not isinstance(other, Identity):
            raise TypeError(f"expected an Identity, got {type(other).__name__}")
        lib.vdna_identity_compare(self._fields, other._fields, Error())

    @property
    def backbone(self) -> str:
        """Name of the network."""
        return str(self._fields.backbone.decode())

    @property
    def model_sha256(self) -> str:
        """SHA-256 of the ONNX file."""
        return str(self._fields.model_sha256.decode())

    @property
    def preprocessing(self) -> str:
        """Everything that shaped the network's input."""
        return str(self._fields.preprocessing.decode())

    @property
    def precision(self) -> str:
        """Of the network's arithmetic: "fp32", "int8"."""
        return str(lib.vdna_identity_precision(self._fields).decode())

    @property
    def taps(self) -> str:
        """NAME:NEURONS:SAMPLES[,...] in the order of the histogram's neurons; see parse_taps()."""
        return str(self._fields.taps.decode())

    @property
    def neurons(self) -> int:
        """Of all taps."""
        return int(self._fields.neurons)

    @property
    def dim(self) -> Optional[int]:
        """Numbers in an embedding; None if not known yet."""
        return int(self._fields.dim) or None

    @property
    def bins(self) -> Optional[int]:
        """Counts per neuron; None if not known yet."""
        return int(self._fields.bins) or None

    @property
    def range(self) -> Optional[NDArray[np.float32]]:
        """[neurons][2], where the bins of each neuron begin and end; None if not known yet."""
        address = self._fields.range
        return address and view((self._owner, self), address, (self.neurons, 2), np.float32)

    @property
    def embedding(self) -> str:
        """How embeddings are made of the network's outputs; "": one whole output."""
        return str(self._fields.embedding.decode())

    @property
    def is_centred(self) -> bool:
        """Whether embeddings are compared about a mean, which a localiser must subtract."""
        return bool(lib.vdna_identity_is_centred(self._fields))

    @property
    def projection(self) -> Optional[NDArray[np.float32]]:
        """[dim][raw_dim]: directions of which the coordinates of an embedding are kept; None: all of
        its numbers are kept."""
        fields = self._fields
        return fields.projection and view(
            (self._owner, self), fields.projection, (fields.dim, fields.raw_dim), np.float32
        )

    def project(self, embedding: ArrayLike) -> NDArray[np.float32]:
        """What is kept of the embedding of a live frame, to compare it with experiences: float32
        [dim] of what the network gives, [raw_dim], or [dim] without a projection."""
        fields = self._fields
        given = (fields.raw_dim if fields.projection else fields.dim,)
        values = shaped(floats(embedding, "embedding"), given, "embedding")
        kept = np.empty(fields.dim, np.float32)
        lib.vdna_identity_project(fields, values.ctypes.data, kept.ctypes.data)
        return kept

    @property
    def text(self) -> str:
        """The canonical text of docs/reference/SPEC-map.md."""
        text = create_string_buffer(_TEXT_SIZE)
        lib.vdna_identity_text(self._fields, text)
        return text.value.decode()

    @property
    def comparable(self) -> Optional[str]:
        """SHA-256 over the text, the range and the projection; None as long as something is not known."""
        if None in (self.dim, self.bins) or self.range is None:
            return None
        text = create_string_buffer(_SHA256_SIZE)
        lib.vdna_identity_hash(self._fields, text)
        return text.value.decode()
